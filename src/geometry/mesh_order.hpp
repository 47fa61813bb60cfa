#pragma once
// Numbers triangles and vertices along a Hilbert curve, so that neighbours are near in memory.
#include "geometry/mesh.hpp"

namespace knap {

/// Reorders vertices, triangles and regions (edges are to be found afterwards). Vertices that no triangle uses are dropped.
/// Returns the new number of every old vertex, -1 for a dropped one.
std::vector<Index> order_along_curve(Mesh& mesh);

}  // namespace knap
