#pragma once
// A triangle mesh with its edges.
#include "base/grouped.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

namespace knap {

/// Edge k of a triangle joins its corners k and (k+1)%3.
struct InteriorEdge {
    std::array<Index, 2> triangle;  // the two neighbours
    std::array<Index, 2> side;      // the number of the edge (0..2) in each of them
    bool cracked = false;           // no cohesion from the start
    Index joint = -1;               // number of the joint set whose law acts here, -1 = none

    void serialize(auto& archive) { archive(triangle, side, cracked, joint); }
};

struct BoundaryEdge {
    Index triangle;
    Index side;      // 0..2
    Index boundary;  // index into boundary_names

    void serialize(auto& archive) { archive(triangle, side, boundary); }
};

/// Consecutive triangles with a name: a body of a scenario, or several bodies.
struct MeshPart {
    std::string name;
    Index first_triangle, n_triangles;
};

/// The next and the previous corner of a triangle of first order, counterclockwise. A corner also numbers the edge that
/// starts there, which ends at the next one.
constexpr Index next_in_triangle(Index corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }
constexpr Index previous_in_triangle(Index corner) { return corner % 3 == 0 ? corner + 2 : corner - 1; }

/// A triangle owns its corners (element nodes): of order 1 its three vertices 0, 1, 2; of order 2 also 3 + k, the
/// middle of edge k, and 6, its centre. Corner k of triangle t has the number corners_per_triangle() t + k. Bodies have
/// no vertices in common, also where they touch.
struct Mesh {
    Index order = 1;                              // of the displacement on a triangle: 1 or 2
    std::vector<Vec2> vertices;                   // [m]
    std::vector<std::array<Index, 3>> triangles;  // counterclockwise
    std::vector<Index> region;                    // material index, one per triangle
    std::vector<Index> grain;                     // one per triangle, -1 = in none; empty = there are none
    std::vector<double> layer_angle;              // [rad] of layers, one per triangle; empty: that of its material
    std::vector<InteriorEdge> interior_edges;
    std::vector<BoundaryEdge> boundary_edges;
    std::vector<std::string> boundary_names;
    std::vector<MeshPart> parts;  // bodies first, then groups of them; empty: one body without a name

    /// Only for a mesh of first order without grains and parts.
    void serialize(auto& archive) {
        archive(vertices, triangles, region, interior_edges, boundary_edges, boundary_names);
    }

    Index n_triangles() const { return static_cast<Index>(triangles.size()); }
    Index n_vertices() const { return static_cast<Index>(vertices.size()); }
    Index corners_per_triangle() const { return order == 1 ? 3 : 7; }
    Index n_corners() const { return corners_per_triangle() * n_triangles(); }
    Index triangle_of(Index corner) const { return corner / corners_per_triangle(); }
    Index place_in_triangle(Index corner) const { return corner % corners_per_triangle(); }

    Vec2 corner(Index triangle, Index k) const {  // [m] k < 3: a vertex
        if (k < 3) return vertices[triangles[triangle][k]];
        if (k < 6) return 0.5 * (corner(triangle, k - 3) + corner(triangle, (k - 2) % 3));
        return centroid(triangle);
    }
    Vec2 corner(Index number) const { return corner(triangle_of(number), place_in_triangle(number)); }  // [m]
    Vec2 centroid(Index triangle) const {                                                               // [m]
        return (corner(triangle, 0) + corner(triangle, 1) + corner(triangle, 2)) / 3;
    }
    double area(Index triangle) const {  // [m2]
        return 0.5 * cross(corner(triangle, 1) - corner(triangle, 0), corner(triangle, 2) - corner(triangle, 0));
    }
    Vec2 side_vector(Index triangle, Index k) const {  // [m] along edge k
        return corner(triangle, (k + 1) % 3) - corner(triangle, k);
    }
    std::array<Index, 2> side_vertices(Index triangle, Index k) const {  // the ends of edge k
        return {triangles[triangle][k], triangles[triangle][(k + 1) % 3]};
    }
    /// Both sides of an edge lie in one grain.
    bool within_grain(const InteriorEdge& edge) const {
        return !grain.empty() && grain[edge.triangle[0]] >= 0 && grain[edge.triangle[0]] == grain[edge.triangle[1]];
    }
};

/// Finds the interior and boundary edges of `mesh.triangles` (and clears those it had); every boundary edge gets
/// boundary 0. Throws ShapeError when two triangles lie on the same side of an edge.
void find_edges(Mesh& mesh);

/// Renumbers triangles and vertices along a Hilbert curve, so that neighbours are near in memory; edges must be found
/// afterwards. Vertices without a triangle are dropped.
struct CurveOrder {
    std::vector<Index> vertex;    // the new number of every old one, -1 for a dropped one
    std::vector<Index> triangle;  // the old number of every new one
};
CurveOrder order_along_curve(Mesh& mesh);

/// Adds the triangles, edges and boundaries of another body behind those of `mesh`. Neither has grains.
void append(Mesh& mesh, const Mesh& body);

/// One key for an edge in one direction.
inline std::uint64_t directed_key(Index from, Index to) {
    return (static_cast<std::uint64_t>(from) << 32) | static_cast<std::uint32_t>(to);
}

/// One key for the edge between two vertices, in either direction.
inline std::uint64_t edge_key(std::array<Index, 2> ends) {
    const auto [low, high] = std::minmax(ends[0], ends[1]);
    return directed_key(low, high);
}

/// The triangles whose centroids lie in a polygon [m], ascending.
std::vector<Index> triangles_in(const Mesh& mesh, const std::vector<Vec2>& polygon);

/// The edges between these triangles and others.
std::vector<InteriorEdge> edges_around(const Mesh& mesh, const std::vector<Index>& triangles);

/// [m] Mean length of the interior edges.
double mean_edge(const Mesh& mesh);
double largest_edge(const Mesh& mesh);  // [m]

/// The triangles around every vertex. Reads vertices and triangles only.
Grouped<Index> vertex_stars(const Mesh& mesh);

}  // namespace knap
