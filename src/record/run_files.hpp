#pragma once
// The files of a run directory, read back.
#include "figures/figure_options.hpp"
#include "output/history_csv.hpp"

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

}  // namespace knap
