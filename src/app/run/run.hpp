#pragma once
// One run of a scenario, from its text to its figures.
#include "app/run/dump_lcp.hpp"
#include "scenario/read_scenario.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace knap {

/// Exit codes of every command.
enum ExitCode {
    exit_done = 0,
    exit_internal = 1,
    exit_bad_input = 2,
    exit_failed = 3,
    exit_expectation = 4,
    exit_interrupted = 130
};

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
