#include "mesh/mesh.hpp"

#include "mesh/shape.hpp"

#include <algorithm>

namespace knap {
namespace {

/// Position of the cell (x, y) of a 2^16 x 2^16 grid on the Hilbert curve.
std::uint32_t hilbert_index(std::uint32_t x, std::uint32_t y) {
    std::uint32_t index = 0;
    for (std::uint32_t s = 1u << 15; s > 0; s >>= 1) {
        const bool right = x & s, up = y & s;
        index += s * s * ((3 * right) ^ up);
        if (up) continue;
        // turn the quadrant so that the curve inside it has the standard orientation
        if (right) x = ~x, y = ~y;
        std::swap(x, y);
    }
    return index;
}

}  // namespace

void find_edges(Mesh& mesh) {
    mesh.interior_edges.clear();
    mesh.boundary_edges.clear();
    const auto ends = [&](Index side) { return mesh.side_vertices(side / 3, side % 3); };  // side = 3 triangle + k
    const Index n_sides = 3 * mesh.n_triangles();
    const Grouped<Index> at_lower_end(mesh.vertices.size(), [&](const auto& visit) {
        for (Index side = 0; side < n_sides; ++side) visit(std::ranges::min(ends(side)), side);
    });
    std::vector<Index> other(n_sides, -1);       // the side of the neighbour
    std::vector<std::pair<Index, Index>> sides;  // by their upper ends: a vertex may have very many
    for (Index v = 0; v < mesh.n_vertices(); ++v) {
        sides.clear();
        for (const Index side : at_lower_end[v]) sides.emplace_back(std::ranges::max(ends(side)), side);
        std::ranges::sort(sides);
        for (std::size_t i = 1; i < sides.size(); ++i) {
            const auto [upper_a, a] = sides[i - 1];
            const auto [upper_b, b] = sides[i];
            if (upper_a != upper_b) continue;
            if (other[a] >= 0 || ends(a) == ends(b))
                throw ShapeError("mesh", "two triangles lie on the same side of one edge");
            other[a] = b, other[b] = a;
        }
    }
    mesh.interior_edges.reserve((n_sides - std::ranges::count(other, -1)) / 2);
    for (Index side = 0; side < std::ssize(other); ++side) {
        const Index t = side / 3, neighbour = other[side] / 3;
        if (other[side] < 0) mesh.boundary_edges.push_back({t, side % 3, 0});
        if (neighbour > t) mesh.interior_edges.push_back({{t, neighbour}, {side % 3, other[side] % 3}});
    }
}

CurveOrder order_along_curve(Mesh& mesh) {
    const Box box = bounding_box(mesh.vertices);
    const double scale = 65535.0 / box.extent().maxCoeff();
    std::vector<std::pair<std::uint32_t, Index>> keys;
    keys.reserve(mesh.triangles.size());
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        const Vec2 cell = (mesh.centroid(t) - box.low) * scale;
        keys.emplace_back(hilbert_index(static_cast<std::uint32_t>(cell.x()), static_cast<std::uint32_t>(cell.y())), t);
    }
    std::ranges::sort(keys);

    Mesh ordered;
    CurveOrder order{std::vector<Index>(mesh.vertices.size(), -1), {}};
    ordered.vertices.reserve(mesh.vertices.size());
    ordered.triangles.reserve(keys.size()), ordered.region.reserve(mesh.region.size());
    order.triangle.reserve(keys.size());
    for (const auto& [key, t] : keys) {
        order.triangle.push_back(t);
        std::array<Index, 3> corners = mesh.triangles[t];
        for (Index& v : corners) {
            Index& number = order.vertex[v];
            if (number < 0) number = ordered.n_vertices(), ordered.vertices.push_back(mesh.vertices[v]);
            v = number;
        }
        ordered.triangles.push_back(corners);
        if (!mesh.region.empty()) ordered.region.push_back(mesh.region[t]);
    }
    mesh.vertices = std::move(ordered.vertices);
    mesh.triangles = std::move(ordered.triangles);
    mesh.region = std::move(ordered.region);
    return order;
}

void append(Mesh& mesh, const Mesh& body) {
    const Index n_triangles = mesh.n_triangles(), n_vertices = mesh.n_vertices(),
                n_boundaries = static_cast<Index>(mesh.boundary_names.size());
    const auto add = [](auto& all, const auto& more) { all.insert(all.end(), more.begin(), more.end()); };
    add(mesh.vertices, body.vertices), add(mesh.triangles, body.triangles), add(mesh.region, body.region);
    add(mesh.interior_edges, body.interior_edges), add(mesh.boundary_edges, body.boundary_edges);
    add(mesh.boundary_names, body.boundary_names);
    for (auto t = mesh.triangles.begin() + n_triangles; t != mesh.triangles.end(); ++t)
        for (Index& vertex : *t) vertex += n_vertices;
    for (auto e = mesh.interior_edges.end() - std::ssize(body.interior_edges); e != mesh.interior_edges.end(); ++e)
        for (Index& triangle : e->triangle) triangle += n_triangles;
    for (auto e = mesh.boundary_edges.end() - std::ssize(body.boundary_edges); e != mesh.boundary_edges.end(); ++e)
        e->triangle += n_triangles, e->boundary += n_boundaries;
}

std::vector<Index> triangles_in(const Mesh& mesh, const std::vector<Vec2>& polygon) {
    const Box box = bounding_box(polygon);
    std::vector<Index> found;
    for (Index t = 0; t < mesh.n_triangles(); ++t)
        if (const Vec2 centroid = mesh.centroid(t); box.contains(centroid) && contains(polygon, centroid))
            found.push_back(t);
    return found;
}

std::vector<InteriorEdge> edges_around(const Mesh& mesh, const std::vector<Index>& triangles) {
    std::vector<std::uint8_t> inside(mesh.n_triangles(), 0);
    for (const Index t : triangles) inside[t] = 1;
    std::vector<InteriorEdge> found;
    std::ranges::copy_if(mesh.interior_edges, std::back_inserter(found), [&](const InteriorEdge& edge) {
        return inside[edge.triangle[0]] != inside[edge.triangle[1]];
    });
    return found;
}

double largest_edge(const Mesh& mesh) {
    double largest = 0;
    for (Index t = 0; t < mesh.n_triangles(); ++t)
        for (Index k = 0; k < 3; ++k) largest = std::max(largest, mesh.side_vector(t, k).norm());
    return largest;
}

double mean_edge(const Mesh& mesh) {
    double sum = 0;
    for (const InteriorEdge& edge : mesh.interior_edges)
        sum += (mesh.corner(edge.triangle[0], edge.side[0]) - mesh.corner(edge.triangle[0], (edge.side[0] + 1) % 3))
                   .norm();
    return mesh.interior_edges.empty() ? 0 : sum / static_cast<double>(mesh.interior_edges.size());
}

Grouped<Index> vertex_stars(const Mesh& mesh) {
    return {mesh.vertices.size(), [&](const auto& visit) {
                for (Index t = 0; t < mesh.n_triangles(); ++t)
                    for (const Index v : mesh.triangles[t]) visit(v, t);
            }};
}

}  // namespace knap
