#pragma once
// The steps of a run, one after the other, until it ends or is stopped.
#include "app/run/checkpoint.hpp"
#include "app/run/run.hpp"
#include "app/run/run_json.hpp"
#include "app/run/run_log.hpp"
#include "record/progress.hpp"
#include "stepper/moreau_jean.hpp"

#include <functional>

namespace knap {

/// What steps a run and who watches it.
struct Stepping {
    const Scenario& scenario;
    const Model& model;
    const RunOptions& options;
    const std::filesystem::path& directory;
    MoreauJean& stepper;
    StepControl& control;
    Recorder& recorder;
    Progress& progress;
    RunLog& log;
    double smallest_step;  // [s]
};

/// Of gates that warn: each is said once in a run.
void say_new_warnings(const Stepping& run, const State& now);

/// Steps until the end, or until the run fails or is interrupted, which the record then says.
void step_to_end(const Stepping& run, double until, const Checkpoints& checkpoints, const std::function<void()>& save, State& now, RunRecord& record);

}  // namespace knap
