#pragma once
// What a run will take, before it runs: processor time, memory, disk.
//
//     mesh and model   measured: they have just been made
//     step             measured: a few are made, on this machine, of this body
//     mean step        times what steps took on the mean over the first ones in the scenarios of the gallery: cracks and rubbing faces come later
//     output           frames and figures by their number and the triangles, constants of the gallery times the speed of this machine
//
// Within a factor of 2 for the scenarios of the gallery; what breaks into rubble early, or never breaks, may be beyond that.
#include "app/run/step_plan.hpp"
#include "model/model.hpp"
#include "scenario/scenario.hpp"

namespace knap {

struct Cost {
    double model = 0, steps = 0, frames = 0, figures = 0, lines = 0;  // [s] of processor time
    double first_step = 0;  // [s] of processor time a step takes at the begin
    double mean_over_first = 1;
    double n_steps = 0;
    double n_frames = 0;
    double memory = 0, disk = 0;  // [MB]
    double total() const { return model + steps + frames + figures + lines; }
};

/// `model_seconds`: processor time that mesh and model took; `measure_for` [s] of processor time for the first steps.
Cost estimate_cost(const Scenario& scenario, const Model& model, const StepPlan& plan, double model_seconds, double measure_for);

/// How much slower than the machine of the gallery this one is: by a fixed piece of arithmetic that takes some milliseconds.
double machine_slowness();

}  // namespace knap
