#pragma once
// What the figures of a finished or interrupted run are drawn from.
#include "figures/figures.hpp"

#include <filesystem>
#include <vector>

namespace knap {

struct FinishedRun {
    std::filesystem::path directory;
    Histories histories;
    FigureContext context;
    std::vector<double> frame_times;  // [s] empty: it has no field frames
};

/// Throws UserError where there is no run, or its tables are damaged.
FinishedRun read_finished_run(const std::filesystem::path& run);

}  // namespace knap
