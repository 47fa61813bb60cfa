#pragma once
// The elastic energy of a state, from the forces of all triangles.
#include "model/state.hpp"

namespace knap {

/// [J] 1/2 u' K u, with large rotations U; `force` [N]: of the triangles on their corners.
double elastic_energy(const Model& model, const State& state, std::vector<Vec2>& force);

}  // namespace knap
