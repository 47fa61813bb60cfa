#pragma once
// A start in static equilibrium: what a slope, a preloaded specimen or a heated body has before anything moves.
#include "element/mass_matrix.hpp"
#include "model/state.hpp"

#include <functional>

namespace knap {

/// Before each step of a search, numbered from 1; `part` [-]: of the loads, that inertia carries so far; 1: not known.
using TellSearch = std::function<void(int step, double part)>;

/// Static equilibrium under the loads and prescribed displacements at start.time (prescribed velocities: zero), with
/// all interfaces bonded. Velocities stay those of `start`. Throws SimulationError where cohesion would fall, where the
/// supports do not hold a body, where contact and friction find no equilibrium, and (large rotations) where the body
/// turns too far for a search that begins with small rotations. State::face_contacts get forces [N]: there was no step.
void start_in_equilibrium(const Model& model, MassMatrix mass, State& start, const TellSearch& tell = {});

}  // namespace knap
