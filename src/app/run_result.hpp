#pragma once
// The numbers of one finished run, read from its directory.
#include "app/run.hpp"
#include "observe/ticks.hpp"
#include "scenario/study_options.hpp"

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

namespace knap {

struct RunResult {
    std::string status;  // done, failed, refused (before it began)
    std::string reason;
    std::string bulk, cohesion;
    bool gates_hold = true;
    double triangles = 0, steps = 0, n_cuts = 0, linear_solves = 0, factorisations = 0;
    double step = NAN;            // [s] the largest, as planned
    double cpu = NAN;             // [s] processor time without output
    std::vector<double> values;   // per quantity

    /// What stands in the place of its numbers where there are none, or where a gate was lost; empty for a good run.
    std::string trouble() const;
};
RunResult read_result(const std::filesystem::path& run, const std::vector<StudyQuantity>& quantities);

/// Whether a record says that its run is at work, as it does for ever where the last one could not be written.
bool is_under_way(const std::string& status);

/// The first error in the log of a run of a batch.
std::string said_in(const std::filesystem::path& log);

/// done where all runs are good.
ExitCode exit_code_of(const std::vector<RunResult>& results);

/// For the column of a quantity: with the prefix of its largest value.
DisplayUnit unit_of_column(const std::vector<RunResult>& results, std::size_t quantity, const std::string& unit);

}  // namespace knap
