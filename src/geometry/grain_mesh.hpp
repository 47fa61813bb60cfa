#pragma once
// Grains on a mesh: every triangle belongs to the grain that its centroid lies in, then single teeth are smoothed away and vertices on
// borders move onto the true borders (line between two grains, point where three meet) as far as their triangles stay good. So grains
// never make a mesh finer, nor its time step smaller; borders are straight down to a fraction of an edge.
#include "geometry/grains.hpp"
#include "geometry/mesh.hpp"

namespace knap {

/// Sets mesh.grain on the triangles of material `region` that have no grain yet, and moves vertices; boundaries, cracks and borders of
/// materials stay. `mesh` needs its edges. Grains that got no triangle are left out of the numbers; returns the first of these, which is
/// the number of grains before.
Index put_grains(Mesh& mesh, const Grains& grains, Index region);

}  // namespace knap
