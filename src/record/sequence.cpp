#include "record/sequence.hpp"

#include "figures/canvas.hpp"
#include "output/vtk_series.hpp"

namespace knap {

FigureScale scale_of(const FigureOptions& options, const FrameList& list, const Histories& histories, const FigureContext& context) {
    FigureScale all;
    for (const std::size_t k : list.frames) all = joined(all, scale_of(options, read_frame(list.run, k), histories, context));
    return all;
}

std::vector<std::filesystem::path> draw_frames(const FigureOptions& options, const FrameList& list, const Histories& histories, const FigureContext& context,
                                               const std::filesystem::path& directory, const FigureScale& common) {
    std::vector<std::filesystem::path> drawn;
    for (const std::size_t k : list.frames) drawn.push_back(draw_figure(options, read_frame(list.run, k), histories, context, directory, &common).file);
    return drawn;
}

}  // namespace knap
