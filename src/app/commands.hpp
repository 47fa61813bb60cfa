#pragma once
// The commands of the program, one function each; cli.cpp turns arguments into these calls.
#include "app/ensemble/ensemble.hpp"
#include "app/run/run.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace knap {

/// Mesh, wave speeds, resolution, methods, steps, and estimated cost of a scenario.
ExitCode check_scenario(ReadResult read, bool full, bool strict, bool time);

/// Reports on the mesh; writes it to `output` (.vtu, .msh or .svg) where one is given.
ExitCode mesh_scenario(ReadResult read, const std::filesystem::path& output, bool force);

/// Writes <name>.toml, a scenario to start from.
ExitCode write_new_scenario(const std::string& name, const std::string& from, bool force);

/// Draws a figure of a finished or interrupted run; without a subject (`show`) all figures of its scenario.
ExitCode render_run(const std::filesystem::path& run, const FigureOptions& figure, const std::filesystem::path& output);

struct CalibrateOptions {
    enum class Of { toughness, strength };
    Of of = Of::toughness;
    std::filesystem::path table;                  // empty: <name>_toughness.csv or <name>_strength.csv
    std::vector<double> loads{1.4, 1.6, 2, 2.5};  // energy release rates of the strips over G_c
    int seeds = 5;                                // strips under each load, or specimens
    BatchOptions batch;                           // output: directory of the sweeps; empty: calibrations
};
/// Cracks in strips, or specimens, with each law of the scenario that acts within a material, on its mesh: a table of
/// their surplus (scenario/toughness.hpp, scenario/specimen_strength.hpp).
ExitCode calibrate(const std::string& scenario, std::vector<std::string> overrides, const CalibrateOptions& options);

enum class RunFormat { text, json, csv };
/// Settings and results of runs: for reading, all of run.json, or a table with a line per run.
ExitCode show_runs(const std::vector<std::filesystem::path>& runs, RunFormat format);

/// Solves stored complementarity problems with one solver, or `all`, and prints residuals and times.
ExitCode solve_stored_lcp(const std::vector<std::filesystem::path>& files, const std::string& solver, bool json);

struct BenchOptions {
    double until = 20e-6;       // [s] of the edge-cracked block
    bool full = false;          // 80 us, and 151 000 and a million triangles too
    std::filesystem::path csv;  // table of the measurements; empty: only printed
};
/// Fixed work: triangle-steps per core-second, ratios over mesh sizes and threads, hashes of the end states, and the
/// kernels of a step compared with the machine; what contact between free faces costs.
ExitCode bench(const BenchOptions& options);

/// For a file that the user named on the command line. Throws UserError where it exists.
void refuse_existing(const std::filesystem::path& file,
                     const std::string& cure = "choose another name, or replace it with --force");
/// Writes it as a whole. Throws UserError with the reason where it cannot be written.
void write_new_file(const std::filesystem::path& file, const std::string& text);

}  // namespace knap
