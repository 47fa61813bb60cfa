#pragma once
// run.json: what a run was, how it ended, and what it found. Its keys are promised to other programs; new ones may come, none goes.
#include "analysis/gates.hpp"
#include "app/run/expectations.hpp"
#include "record/summary.hpp"
#include "stepper/common/step_scheme.hpp"
#include "stepper/step_control.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace knap {

struct RunRecord {
    std::string status;          // starting, running, done, failed, interrupted
    std::string reason;          // of a failure
    bool output_failed = false;  // it was the disk's, not the simulation's: the same command goes on
    std::string name, title;
    std::vector<std::string> command;
    std::uint64_t seed = 0;
    int threads = 1;
    double wall = 0, cpu = 0;                                                   // [s] the whole command
    double cpu_model = 0, cpu_preload = 0, cpu_steps = 0, cpu_output = 0;  // [s] parts of it: mesh and model, start in equilibrium, steps, output
    double cpu_frames = 0, cpu_figures = 0;               // [s] parts of the output
    double cpu_other() const { return cpu - cpu_model - cpu_preload - cpu_steps - cpu_output; }  // [s] reading, checkpoints read, the end
    double frame_wait = 0;                                // [s] of wall time that the steps waited for frames, which are written beside them
    Index triangles = 0, interfaces = 0;
    double thickness = 0;  // [m]
    std::int64_t steps = 0;
    double step = 0, time = 0;       // [s] h as planned, and the time reached
    double smallest_step = 0, largest_step = 0;                 // [s] that were taken
    std::array<std::int64_t, cutback_reasons.size()> n_cutbacks{};      // steps that were not, in the order of cutback_reasons
    SchemeOptions scheme;
    double mean_edge = 0;            // [m]
    double rayleigh_speed = 0;       // [m/s]
    std::vector<std::string> materials;  // names, by region
    StepReport counts;               // of the local problems and the linear solves
    FactorSize factor;               // at the end, of the implicit bulk
    Summary summary;
    Gates gates;
    std::vector<ExpectResult> expect;
    std::vector<std::filesystem::path> figures;
    std::vector<std::string> warnings;
};

std::string run_json(const RunRecord& record);

/// What the run.json in a directory says; nothing where there is none.
struct EarlierRecord {
    bool is_of_a_run = false;    // or so damaged that nobody can tell
    std::string status;          // empty where it cannot be read
    bool output_failed = false;  // the run ended because something could not be written
};
EarlierRecord earlier_record(const std::filesystem::path& directory);

/// Largest resident memory of this process so far [byte].
std::int64_t peak_memory();

}  // namespace knap
