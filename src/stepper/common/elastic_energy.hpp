#pragma once
// The elastic energy of a state, from the forces of all triangles.
#include "model/state.hpp"

namespace knap {

/// [J] 1/2 int sigma : (eps - e), which is 1/2 u' K u without thermal strains e; with large rotations U. `force` [N]:
/// of the triangles on their corners.
double elastic_energy(const Model& model, const State& state, std::vector<Vec2>& force);

/// [J] Of the leapfrog, of a state that was changed between two steps: with Delta = h v of the last step and
/// u_n-1 = u_n - Delta,
///
///     1/2 v' M v + U(u_n-1) - 1/2 f(u_n-1) . Delta,    f = -grad U        (small rotations: 1/2 u_n-1' K u_n)
///
/// and with thermal strains, whose change in the step is de, -1/2 int sigma(u_n-1) : de.
struct LeapfrogEnergies {
    double kinetic = 0, strain = 0;
    double elastic = 0, work = 0;  // U(u_n-1), and f(u_n-1) . Delta + int sigma(u_n-1) : de
};
LeapfrogEnergies leapfrog_energies(const Model& model, const State& state);

}  // namespace knap
