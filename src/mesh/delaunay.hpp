#pragma once
// Constrained Delaunay triangulation of lines and points, refined where a triangle is too large or too flat.
#include "mesh/mesh.hpp"
#include "mesh/size_field.hpp"

namespace knap {

/// A piece of a straight line between two points.
struct Piece {
    Index from, to;
    Index segment;  // of the planar graph
    bool on_ring;   // separates the body from its outside
};

struct Lines {
    std::vector<Vec2> points;  // [m]
    std::vector<Piece> pieces;
};

/// An edge of the mesh on a line.
struct LineEdge {
    Index from, to;  // vertices
    Index segment;
};

struct RefinedMesh {
    Mesh mesh;  // vertices and triangles only
    std::vector<LineEdge> on_lines;
};

/// Circumradii end below `radius` and angles above `min_angle` [degree], except in sharp corners of the lines.
/// Throws ShapeError when more than `max_vertices` would be needed.
RefinedMesh refined_delaunay(const Lines& lines, const std::vector<Vec2>& points, const SizeField& radius,
                             double min_angle, std::size_t max_vertices);

}  // namespace knap
