#pragma once
// The numbers of one run of an ensemble, read from its directory.
#include "scenario/ensemble_options.hpp"

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

namespace knap {

struct RunResult {
    std::string status;  // of run.json; "refused" without one: the run did not begin
    std::string reason;  // of a failure
    std::string bulk, cohesion;
    bool gates_hold = true;
    double triangles = 0, steps = 0, cutbacks = 0, linear_solves = 0, factorisations = 0;
    double step = NAN;           // [s] the largest, as planned
    double cpu = NAN;            // [s] processor time without output
    std::vector<double> values;  // per quantity; NaN where there is none

    /// Whether its process was at work when it wrote its record for the last time.
    bool is_under_way() const { return status == "running" || status == "starting"; }
    /// Why the run does not count as good; empty for a good one.
    std::string trouble() const;
};

/// `run`: its directory, with <run>.log beside it, where its process wrote messages. Throws UserError for a damaged
/// record.
RunResult read_result(const std::filesystem::path& run, const std::vector<StudyQuantity>& quantities);

}  // namespace knap
