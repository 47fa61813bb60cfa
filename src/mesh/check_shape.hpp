#pragma once
// Can a shape be meshed with the requested sizes? Every mistake is named before anything is meshed.
#include "mesh/planar_graph.hpp"
#include "mesh/size_field.hpp"

namespace knap {

constexpr double max_triangles = 5e7;

/// Throws ShapeError unless rings are simple polygons that do not touch each other, holes lie inside the outer ring,
/// regions are simple polygons, and every part has a length or an area. Cracks may begin on a border, cross each other,
/// and reach out of the body: the part outside is cut off, and a crack with no part inside is an error. Mesh sizes are
/// not considered.
void check_shape(const Shape& shape);

/// Throws ShapeError, part "size", for sizes that make no sense for this body.
void check_sizes(const Shape& shape, const MeshOptions& options);

/// Throws ShapeError for lines that come nearer to each other than a twentieth of the mesh size without touching, that
/// are shorter than that, or that meet at less than 1 degree: the triangles between them would reduce the time step too
/// far.
void check_details(const PlanarGraph& graph, const MeshOptions& options);

}  // namespace knap
