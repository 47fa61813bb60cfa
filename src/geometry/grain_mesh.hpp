#pragma once
// Grains on a mesh: every triangle belongs to the grain that its centroid lies in, then single teeth are smoothed away and vertices on
// borders move onto the true borders (line between two grains, point where three meet) as far as their triangles stay good. The
// number of triangles stays; the stable step may shrink a little, and borders stray a fraction of an edge (theory manual, Rock).
#include "geometry/grains.hpp"
#include "geometry/mesh.hpp"

namespace knap {

/// Sets mesh.grain on the triangles of material `region` that have no grain yet, and moves vertices; boundaries, cracks and borders of
/// materials stay. `mesh` needs its edges. Grains that got no triangle are left out of the numbers; returns the first of these, which is
/// the number of grains before.
Index put_grains(Mesh& mesh, const Grains& grains, Index region);

}  // namespace knap
