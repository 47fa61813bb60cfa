#pragma once
// Pictures that belong together: one figure at several times, or of several runs. They share the part of the plane that is seen and the colour range, so they are
// drawn when all frames are there; one frame is in memory at a time.
#include "figures/figures.hpp"

namespace knap {

/// Of a run directory, by the numbers of their frames.
struct FrameList {
    std::filesystem::path run;
    std::vector<std::size_t> frames;
};

/// What the pictures of these frames have in common.
FigureScale scale_of(const FigureOptions& options, const FrameList& list, const Histories& histories, const FigureContext& context);

/// Draws the figure from each frame and returns the files.
std::vector<std::filesystem::path> draw_frames(const FigureOptions& options, const FrameList& list, const Histories& histories, const FigureContext& context,
                                               const std::filesystem::path& directory, const FigureScale& common);

}  // namespace knap
