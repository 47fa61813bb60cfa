#pragma once
// The numbers of one finished run, read from its directory.
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
};
RunResult read_result(const std::filesystem::path& run, const std::vector<StudyQuantity>& quantities);

}  // namespace knap
