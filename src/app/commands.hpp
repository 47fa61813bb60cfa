#pragma once
// The commands of the program, one function each; cli.cpp turns arguments into these calls.
#include "app/run/run.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace knap {

ExitCode check_scenario(const ReadResult& read, bool full, bool strict, bool time);

/// Meshes only: prints a report, writes `output` (.vtu, .msh or .svg by its ending) where one is given.
ExitCode mesh_scenario(const ReadResult& read, const std::filesystem::path& output, bool force);

/// Draws the figures of a finished or interrupted run again, or one that is described by `figure` where it names something to show.
ExitCode render_run(const std::filesystem::path& run, const FigureOptions& figure, const std::filesystem::path& output);

enum class RunFormat { text, json, csv };
/// What runs were and found: for reading, all of run.json, or a table with a line a run.
ExitCode show_runs(const std::vector<std::filesystem::path>& runs, RunFormat format);

/// Writes a scenario to start from to <name>.toml.
ExitCode write_new_scenario(const std::string& name, bool force);

/// Solves a stored complementarity problem with one solver, or `all`, and prints how well and how fast.
ExitCode solve_stored_lcp(const std::vector<std::filesystem::path>& files, const std::string& solver, bool json);

struct BenchOptions {
    double until = 20e-6;  // [s] of the edge-cracked block
    bool full = false;     // all 80 us, and 151 000 and a million triangles too
    std::filesystem::path csv;  // what was measured, as a table; empty: only printed
};
/// Fixed work: triangle-steps per core-second, its ratio over mesh sizes and threads, end-state hashes; the kernels of a step against the machine.
ExitCode bench(const BenchOptions& options);

}  // namespace knap
