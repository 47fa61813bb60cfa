#pragma once
// The elastic energy of a state, from the forces of all triangles.
#include "model/state.hpp"

namespace knap {

/// [J] 1/2 int sigma : (eps - e), which is 1/2 u' K u without thermal strains e; with large rotations U. `force` [N]:
/// of the triangles on their corners.
double elastic_energy(const Model& model, const State& state, std::vector<Vec2>& force);

}  // namespace knap
