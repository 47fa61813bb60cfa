#pragma once
// One run of a scenario, from its text to its figures: the whole program on one screen.
#include "app/run/dump_lcp.hpp"
#include "app/run/setup.hpp"
#include "scenario/read_scenario.hpp"

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

namespace knap {

/// How the program ends; interface of every command.
enum ExitCode { exit_done = 0, exit_internal = 1, exit_bad_input = 2, exit_failed = 3, exit_expectation = 4, exit_interrupted = 130 };

struct RunOptions {
    std::filesystem::path output;  // empty: runs/<name>
    bool force = false;            // replace an earlier run
    bool quiet = false;            // no progress
    int threads = 0;               // 0 = all
    double until = std::numeric_limits<double>::infinity();  // [s] end earlier
    StepSelection dump_lcp;                                  // steps whose complementarity problems are stored
    std::vector<std::string> command;                        // as typed, for the record
};

ExitCode run_scenario(const ReadResult& read, const RunOptions& options);

/// The mesh and model of a scenario; what geometry refuses, or selects nothing, becomes a UserError at the right line of the scenario.
Model model_of(const ReadResult& read);

/// The resolved scenario as it stands in a run directory, where files that were read have names of their own (`mesh.msh`).
std::string resolved_for_run(const ReadResult& read);

/// Warnings about the resolution of the process zone.
std::vector<Diagnostic> resolution_warnings(const ReadResult& read, double mean_edge);

}  // namespace knap
