#pragma once
// The files of a run directory, read back: tables and frames, and the figures drawn from them.
#include "figures/figures.hpp"

#include <filesystem>
#include <vector>

namespace knap {

/// The data from which the figures of a finished or interrupted run are drawn.
struct FinishedRun {
    std::filesystem::path directory;
    Histories histories;
    FigureContext context;
    std::vector<double> frame_times;  // [s] empty: no field frames
};
/// Throws UserError where there is no run, or its tables are damaged.
FinishedRun read_finished_run(const std::filesystem::path& run);

/// The common scale of one figure at several frames, by number. One frame is in memory at a time.
FigureScale scale_of(const FigureOptions& options, const std::filesystem::path& run,
                     const std::vector<std::size_t>& frames, const Histories& histories, const FigureContext& context);

/// Draws a figure at several frames with their common scale into `directory` and returns the files: of an animation
/// one, with the frames as its pictures; none without frames.
std::vector<std::filesystem::path> draw_sequence(const FigureOptions& options, const std::filesystem::path& run,
                                                 const std::vector<std::size_t>& frames, const Histories& histories,
                                                 const FigureContext& context, const std::filesystem::path& directory);

}  // namespace knap
