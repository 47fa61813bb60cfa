#pragma once
// Structured meshes of bars and plates: tests want exact waves and ties (scenarios use random meshes).
#include "base/rotation.hpp"
#include "mesh/mesh.hpp"

#include <functional>

namespace knap::tests {

inline Vec2 turned(const Vec2& x, double angle) { return Rotation::by(angle).turned(x); }

/// Finds the edges of a rectangle's mesh and names its boundaries.
inline void name_sides(Mesh& mesh, double length, double height) {
    mesh.boundary_names = {"left", "right", "bottom", "top"};
    find_edges(mesh);
    for (BoundaryEdge& edge : mesh.boundary_edges) {
        const Vec2 middle =
            0.5 * (mesh.corner(edge.triangle, edge.side) + mesh.corner(edge.triangle, (edge.side + 1) % 3));
        const double near = 1e-9 * (length + height);
        edge.boundary = middle.x() < near ? 0 : middle.x() > length - near ? 1 : middle.y() < near ? 2 : 3;
    }
}

/// n_x by n_y cells of two triangles each, from the origin, boundaries left, right, bottom, top; the region is the column's: region_of(i).
inline Mesh bar_mesh(int n_x, int n_y, double length, double height, const std::function<Index(int)>& region_of = {}) {
    Mesh mesh;
    for (int j = 0; j <= n_y; ++j)
        for (int i = 0; i <= n_x; ++i) mesh.vertices.push_back({length * i / n_x, height * j / n_y});
    const auto at = [&](int i, int j) { return static_cast<Index>(j * (n_x + 1) + i); };
    for (int j = 0; j < n_y; ++j)
        for (int i = 0; i < n_x; ++i) {
            mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
            const Index region = region_of ? region_of(i) : 0;
            mesh.region.push_back(region);
            mesh.region.push_back(region);
        }
    name_sides(mesh, length, height);
    return mesh;
}

/// A bar of n cells of four triangles each (both diagonals), mirror-symmetric about its axis, so that waves along it stay one-dimensional:
/// the nodes of a column move alike. Triangles 4 i .. 4 i + 3 of cell i lie below, right, above, left; boundaries as in bar_mesh.
inline Mesh symmetric_bar_mesh(int n, double length, double height, const std::function<Index(int)>& region_of = {}) {
    Mesh mesh;
    for (int i = 0; i <= n; ++i) {
        mesh.vertices.push_back({length * i / n, 0});
        mesh.vertices.push_back({length * i / n, height});
        if (i < n) mesh.vertices.push_back({length * (i + 0.5) / n, 0.5 * height});
    }
    for (int i = 0; i < n; ++i) {
        const Index a = 3 * i, d = a + 1, middle = a + 2, b = a + 3, c = a + 4;
        for (const auto& [from, to] : {std::pair{a, b}, std::pair{b, c}, std::pair{c, d}, std::pair{d, a}}) {
            mesh.triangles.push_back({from, to, middle});
            mesh.region.push_back(region_of ? region_of(i) : 0);
        }
    }
    name_sides(mesh, length, height);
    return mesh;
}

}  // namespace knap::tests
