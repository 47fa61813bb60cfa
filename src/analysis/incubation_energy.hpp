#pragma once
// What incubated strengths cost.
#include "model/state.hpp"

namespace knap {

/// [J] Part of the dissipated energy beyond the fracture energy of the laws: sum of (phi - 1) S G_c f(beta), at the
/// temperatures of the state.
double incubation_energy(const Model& model, const State& state);

}  // namespace knap
