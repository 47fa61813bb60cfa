#pragma once
// The planar graph of a shape, and the checks that the shape can be meshed with the requested sizes: every mistake is
// named before anything is meshed.
#include "mesh/planar_graph.hpp"

namespace knap {

/// For a shape whose rings were checked. The end of a crack within the shape tolerance of a ring or of an earlier crack
/// is moved onto it; with Shape::snap cracks, ends and crossings that are nearer than that to each other or to a border
/// are joined, and `counts` says how many. Region borders yield more: within `region_tolerance` [m] they are moved onto
/// rings, each other and (without snap) cracks, and their shorter sides collapse, so that a border cannot force
/// triangles far below the mesh size.
PlanarGraph planar_graph(const Shape& shape, double region_tolerance = 0, SnapCounts* counts = nullptr);

/// Throws ShapeError, with all faults, unless rings are simple polygons that do not touch each other, holes lie inside
/// the outer ring, regions are simple polygons, and every part has a length or an area. Cracks may start on a border,
/// cross each other, and reach out of the body: the part outside is cut off, and a crack with no part inside is an
/// error, unless Shape::snap left it out. Mesh sizes are not considered.
void check_shape(const Shape& shape);

constexpr double max_triangles = 5e7;

/// Throws ShapeError, part "size", for sizes that make no sense for this body.
void check_sizes(const Shape& shape, const MeshOptions& options);

/// Faults: lines that come nearer to each other than a twentieth of the mesh size without touching, that are shorter
/// than that, or that meet at less than 1 degree: the triangles between them would reduce the time step too far.
/// `snap`: that of the shape, for the messages.
std::vector<ShapeFault> faults_of_details(const PlanarGraph& graph, const MeshOptions& options, double snap = 0);

/// The checks above, with the faults of both in one ShapeError; the graph where there is none.
PlanarGraph checked_graph(const Shape& shape, const MeshOptions& options, double region_tolerance);

}  // namespace knap
