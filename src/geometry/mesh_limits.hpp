#pragma once
// Can a shape be meshed with these sizes? What is too fine, too coarse or too nearly touching is said before anything is meshed.
#include "geometry/planar_graph.hpp"
#include "geometry/triangulate.hpp"

namespace knap {

constexpr double most_triangles = 5e7;

/// About how many triangles would come.
double expected_triangles(double area, const MeshOptions& options);

/// Throws ShapeError, part "size", for sizes that make no sense for this body; `area` [m2].
void check_sizes(const Shape& shape, double area, const MeshOptions& options);

/// Throws ShapeError for lines that come nearer to each other than a twentieth of the mesh size without touching, that are shorter than
/// that, or that meet under less than 1 degree: the triangles between them would ruin the time step.
void check_details(const PlanarGraph& graph, const MeshOptions& options);

}  // namespace knap
