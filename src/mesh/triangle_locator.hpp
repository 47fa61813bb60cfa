#pragma once
// Finds the triangle of a mesh in which a point lies, among some of them.
#include "mesh/constrained_delaunay.hpp"

namespace knap {

/// A place in a triangle of a mesh.
struct Place {
    Index triangle = -1;             // -1: in none
    std::array<double, 3> weight{};  // barycentric coordinates
};

class TriangleLocator {
public:
    /// `mesh` must outlive it.
    TriangleLocator(const Mesh& mesh, const std::vector<Index>& triangles);

    Place place_of(const Vec2& p) const;

private:
    const Mesh& mesh_;
    delaunay::Triangulation triangulation_;  // all sides of the triangles are constraints
    mutable delaunay::Face last_;            // where the last point was: the next one is often near
    Grouped<Index> stars_;                   // these triangles around every vertex of the mesh
};

}  // namespace knap
