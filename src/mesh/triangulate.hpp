#pragma once
// Random Delaunay meshes of a Shape (CGAL), conforming to its rings, cracks and region borders.
#include "mesh/mesh.hpp"
#include "mesh/shape.hpp"
#include "mesh/size_field.hpp"

namespace knap {

/// Throws ShapeError for a shape that cannot be meshed (self-crossing, needle, too fine, empty). Cracks are cut off at
/// the border of the body; an end within 1e-6 of the body's diagonal from a border or another crack is moved onto it.
/// The same seed gives the same bits.
Mesh triangulate(const Shape& shape, const MeshOptions& options);

}  // namespace knap
