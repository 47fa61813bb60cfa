#pragma once
// Estimate of the processor time, memory and disk space of a run.
//
//     mesh and model   measured
//     step             measured: a few steps of this body on this machine
//     mean step        that, times the ratio of mean to first steps in the gallery: cracks and rubbing faces come later
//     output           numbers of frames, figures and triangles, times constants of the gallery and the machine's speed
//
// Within a factor of 2 for explicit scenarios of the gallery; beyond that for bodies that fragment early or never
// break. Implicit steps and bulk = "auto" have a range: `least_steps` while nothing breaks and no contact changes,
// `steps` where much does.
#include "app/setup/step_plan.hpp"
#include "model/model.hpp"
#include "scenario/scenario.hpp"

namespace knap {

struct Cost {
    double model = 0, steps = 0, frames = 0, figures = 0, lines = 0;  // [s] processor time
    double first_step = 0;      // [s] processor time of a step at the start; NaN: given up, and so are steps and total
    double given_up_after = 0;  // [s] processor time
    double least_steps = 0;     // [s] of `steps`; equal where there is no range
    double search = 0, least_search = 0;  // [s] of the equilibrium at the start
    double stage = 0;                     // [s] with bulk = "auto": the shortest stage of explicit steps
    double mean_over_first = 1;
    double rigid_steps = 0;       // [s] with [rigid]: of steps if all is rigid
    double deformable_steps = 0;  // [s] of steps if nothing is rigid that may break
    double n_steps = 0;
    double n_frames = 0;
    double memory = 0, disk = 0;  // [MB] at most
    double least_memory = 0;      // [MB] with [adapt], where no crack branches
    double total() const { return model + search + steps + frames + figures + lines; }
    double least() const { return total() - steps + least_steps - search + least_search; }
};

/// `model_seconds`: processor time of mesh and model; `measure_for` [s]: minimum processor time of the measured steps.
Cost estimate_cost(const Scenario& scenario, const Model& model, const StepPlan& plan, double model_seconds,
                   double measure_for);

/// Why the time of steps of `step` [s] is not known, where it was given up.
std::string unknown_text(const Cost& cost, double step);

}  // namespace knap
