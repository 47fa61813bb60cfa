#include "record/figure_sequence.hpp"

#include "figures/animation.hpp"
#include "output/vtk_series.hpp"

namespace knap {
namespace {

/// Pictures stay as long as the time to the next one takes, the last one a second.
std::vector<std::filesystem::path> animate(const FigureOptions& options, FrameReader& reader,
                                           const std::vector<std::size_t>& frames, const Histories& histories,
                                           const FigureContext& context, const std::filesystem::path& directory,
                                           const FigureScale& common) {
    constexpr double duration = 8, rest = 1;  // [s]
    if (frames.empty()) return {};
    const std::vector<double> times = frame_times(reader.run());
    const double span = times.at(frames.back()) - times.at(frames.front()),
                 speed = options.speed > 0 ? options.speed : span / duration;
    const std::filesystem::path file = directory / options.file;
    const auto picture = [&](std::size_t i) -> Still {
        const double shown = i + 1 < frames.size() ? (times.at(frames[i + 1]) - times.at(frames[i])) / speed : rest;
        return {draw_picture(options, reader.frame(frames[i]), histories, context, common).image, shown};
    };
    write_animation(file, frames.size(), picture, has_few_colours(options.show));
    return {file};
}

}  // namespace

const Frame& FrameReader::frame(std::size_t number) {
    if (const auto found = kept_.find(number); found != kept_.end()) return found->second;
    other_ = read_frame(run_, number);
    if (n_kept_ + other_.position.size() > most) return other_;
    n_kept_ += other_.position.size();
    return kept_[number] = std::move(other_);
}

std::vector<std::filesystem::path> draw_sequence(const FigureOptions& options, FrameReader& reader,
                                                 const std::vector<std::size_t>& frames, const Histories& histories,
                                                 const FigureContext& context, const std::filesystem::path& directory) {
    FigureScale common;
    for (const std::size_t k : frames) common = joined(common, scale_of(options, reader.frame(k), histories, context));
    if (options.is_animation()) return animate(options, reader, frames, histories, context, directory, common);
    std::vector<std::filesystem::path> drawn;
    for (const std::size_t k : frames)
        drawn.push_back(draw_figure(options, reader.frame(k), histories, context, directory, &common).file);
    return drawn;
}

}  // namespace knap
