#pragma once
// Static equilibrium under the loads of one moment, all interfaces holding: where a run with time.start = "equilibrium"
// begins.
//
// The implicit scheme itself finds it, with contact and friction: steps of theta = 1 from rest, large enough for
// inertia to be nothing, each from the displacement of the one before. Such a step is
//
//     (M/h^2 + K) (u_new - u_old) = F - K u_old + reactions
//
// so each divides what inertia still carries by 1 + (omega h)^2; what it carries is the error of the equilibrium, M
// (u_new - u_old)/h^2. A body that nothing holds leaves it as it is, and is told apart by that.
#include "model/state.hpp"
#include "stepper/common/scheme_options.hpp"

namespace knap {

/// Moves `start` to equilibrium under the loads and prescribed displacements at start.time (prescribed velocities: 0).
/// Velocities stay those of `start`. Throws SimulationError where cohesion would fall, where a body is not held, and
/// where contact and friction find no equilibrium.
void load_statically(const Model& model, const SchemeOptions& options, State& start);

}  // namespace knap
