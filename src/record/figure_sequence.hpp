#pragma once
// A figure at several frames of a run directory.
#include "figures/figures.hpp"

#include <filesystem>
#include <vector>

namespace knap {

/// The common scale of one figure at several frames, by number. One frame is in memory at a time.
FigureScale scale_of(const FigureOptions& options, const std::filesystem::path& run,
                     const std::vector<std::size_t>& frames, const Histories& histories, const FigureContext& context);

/// Draws a figure at several frames with their common scale into `directory` and returns the files: of an animation
/// one, with the frames as its pictures; none without frames.
std::vector<std::filesystem::path> draw_sequence(const FigureOptions& options, const std::filesystem::path& run,
                                                 const std::vector<std::size_t>& frames, const Histories& histories,
                                                 const FigureContext& context, const std::filesystem::path& directory);

}  // namespace knap
