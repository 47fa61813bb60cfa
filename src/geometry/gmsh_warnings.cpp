#include "geometry/gmsh_warnings.hpp"

#include "geometry/polygon.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace knap {
namespace {

constexpr double same_point = 1e-9;  // relative to the extent of the mesh

/// Parts of which no edge of one is an edge of another.
Index n_pieces(const Mesh& mesh) {
    std::vector<Index> parent(mesh.triangles.size());
    std::iota(parent.begin(), parent.end(), 0);
    const auto root = [&](Index t) {
        while (parent[t] != t) t = parent[t] = parent[parent[t]];
        return t;
    };
    Index n = mesh.n_triangles();
    for (const InteriorEdge& edge : mesh.interior_edges) {
        const Index a = root(edge.triangle[0]), b = root(edge.triangle[1]);
        if (a == b) continue;
        parent[std::max(a, b)] = std::min(a, b);
        --n;
    }
    return n;
}

/// Vertices of the boundary that share a place with another one (in a grid of the tolerance, so a few may be missed).
Index n_doubled_vertices(const Mesh& mesh) {
    const Box box = bounding_box(mesh.vertices);
    const double scale = 1 / (same_point * box.diagonal());
    std::vector<Index> on_boundary;
    for (const BoundaryEdge& edge : mesh.boundary_edges)
        for (const Index k : {edge.side, (edge.side + 1) % 3}) on_boundary.push_back(mesh.triangles[edge.triangle][k]);
    std::sort(on_boundary.begin(), on_boundary.end());
    on_boundary.erase(std::unique(on_boundary.begin(), on_boundary.end()), on_boundary.end());
    std::vector<std::pair<double, double>> cells;
    for (const Index v : on_boundary) {
        const Vec2 x = (mesh.vertices[v] - box.low) * scale;
        cells.emplace_back(std::round(x.x()), std::round(x.y()));
    }
    std::sort(cells.begin(), cells.end());
    Index n = 0;
    for (std::size_t i = 1; i < cells.size(); ++i) n += cells[i] == cells[i - 1];
    return n;
}

}  // namespace

std::vector<std::string> mesh_warnings(const Mesh& mesh) {
    std::vector<std::string> warnings;
    if (const Index n = n_pieces(mesh); n > 1)
        warnings.push_back("the mesh falls into " + std::to_string(n) +
                           " pieces that share no edge: they never feel each other, there is no contact between them");
    if (const Index n = n_doubled_vertices(mesh); n > 0)
        warnings.push_back(std::to_string(n) +
                           " nodes of the boundary lie on top of others: the body is open there, without cohesion and contact "
                           "(`Coherence` in Gmsh joins surfaces; a crack is a group of lines inside the body)");
    return warnings;
}

}  // namespace knap
