#pragma once
// One run of a scenario, from its text to its figures.
#include "app/run/dump_lcp.hpp"
#include "app/setup/process.hpp"
#include "scenario/read_scenario.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace knap {

struct RunOptions {
    std::filesystem::path output;      // empty: runs/<name>
    bool force = false;                // replace an earlier run
    bool quiet = false;                // no progress line
    int threads = 0;                   // 0 = all
    double until = infinity;           // [s] end earlier
    StepSelection dump_lcp;            // steps whose complementarity problems are stored
    std::vector<std::string> command;  // as typed, for the record
};

ExitCode run_scenario(ReadResult read, const RunOptions& options);

}  // namespace knap
