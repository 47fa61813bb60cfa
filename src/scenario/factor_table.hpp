#pragma once
// A load's history from a CSV file: lines `time, factor` in seconds and without unit; a first line of names and # comments are skipped.
#include "scenario/findings.hpp"

#include "model/loads.hpp"

#include <filesystem>

namespace knap {

/// `at` is where the scenario names the file. Empty when something is wrong.
TimeFunction read_factor_table(const std::filesystem::path& file, const Node& at, Findings& findings);

}  // namespace knap
