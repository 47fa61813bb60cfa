#pragma once
// What a refinement gives back to the patches of triangles that it replaced, after new vertices took u and v linearly
// from the old triangles:
//
//     momentum    one velocity for all vertices of a patch
//     energy      a w for the vertices within a patch. w: the short waves of the velocity, on the mesh before v less
//                 the linear field of mean value and mean gradient of the triangles at a vertex, then linear, less its
//                 mean over the patch. a: such that the leapfrog energy of the patch,
//                 1/2 v' M v + 1/2 (u - h v)' K u, is that before the refinement, -1/2 <= a <= 1
//
// With lumped masses a wave as short as the edges has more kinetic energy than its linear interpolation (white noise
// twice as much), and flipped diagonals change the strain energy, too. Short waves, which a running crack sends out all
// the time, take this energy; linear fields have none, so that uniform strain and rigid motions are kept. Angular
// momentum is not kept.
#include "mesh/refine.hpp"
#include "model/state.hpp"

namespace knap {

/// Changes `state` of the model `after`, which was carried over from `old` of the model `before`.
void restore_momentum_and_energy(const Model& before, const State& old, const Model& after, const RefinedMesh& refined,
                                 State& state);

}  // namespace knap
