#pragma once
// A triangle mesh with its edges. Immutable once made.
#include "base/vec.hpp"

#include <array>
#include <string>
#include <vector>

namespace knap {

/// Edge k of a triangle joins its corners k and (k+1)%3.
struct InteriorEdge {
    std::array<Index, 2> triangle;  // the two neighbours
    std::array<Index, 2> side;      // the edge's number (0..2) in each of them
    bool cracked = false;           // no cohesion from the start
};

struct BoundaryEdge {
    Index triangle;
    Index side;      // 0..2
    Index boundary;  // index into boundary_names
};

struct Mesh {
    std::vector<Vec2> vertices;                   // [m]
    std::vector<std::array<Index, 3>> triangles;  // counterclockwise
    std::vector<Index> region;                    // material index, one per triangle
    std::vector<InteriorEdge> interior_edges;
    std::vector<BoundaryEdge> boundary_edges;
    std::vector<std::string> boundary_names;

    Index n_triangles() const { return static_cast<Index>(triangles.size()); }
    Index n_vertices() const { return static_cast<Index>(vertices.size()); }
    Index n_corners() const { return 3 * n_triangles(); }

    Vec2 corner(Index triangle, Index k) const { return vertices[triangles[triangle][k]]; }
    double area(Index triangle) const {  // [m2]
        return 0.5 * cross(corner(triangle, 1) - corner(triangle, 0), corner(triangle, 2) - corner(triangle, 0));
    }
};

/// Finds the interior and boundary edges of `mesh.triangles` (and clears those it had); every boundary edge gets boundary 0.
/// Throws ShapeError when more than two triangles share an edge, or two with the same orientation.
void find_edges(Mesh& mesh);

}  // namespace knap
