#include "mesh/triangle_locator.hpp"

#include <algorithm>

namespace knap {

TriangleLocator::TriangleLocator(const Mesh& mesh, const std::vector<Index>& triangles) : mesh_(mesh) {
    std::vector<delaunay::Vertex> vertex(mesh.vertices.size());
    delaunay::Face near;
    for (const Index t : triangles)
        for (const Index v : mesh.triangles[t]) {
            if (vertex[v] != delaunay::Vertex()) continue;
            vertex[v] = triangulation_.insert(delaunay::point(mesh.vertices[v]), near);
            vertex[v]->info().value = v;
            near = vertex[v]->face();
        }
    for (const Index t : triangles)
        for (Index k = 0; k < 3; ++k) {
            const auto [a, b] = mesh.side_vertices(t, k);
            triangulation_.insert_constraint(vertex[a], vertex[b]);
            left_of_[directed_key(a, b)] = t;
        }
}

Place TriangleLocator::place_of(const Vec2& p) const {
    const delaunay::Face face = last_ = triangulation_.locate(delaunay::point(p), last_);
    if (triangulation_.is_infinite(face)) return {};
    const auto number = [&](int k) { return face->vertex(k)->info().value; };
    const auto found = left_of_.find(directed_key(number(0), number(1)));
    if (found == left_of_.end()) return {};
    const Index t = found->second;
    if (std::ranges::find(mesh_.triangles[t], number(2)) == mesh_.triangles[t].end()) return {};
    const Vec2 a = mesh_.corner(t, 0), ab = mesh_.corner(t, 1) - a, ac = mesh_.corner(t, 2) - a;
    const double twice_area = cross(ab, ac), y = cross(p - a, ac) / twice_area, z = cross(ab, p - a) / twice_area;
    return {t, {1 - y - z, y, z}};
}

}  // namespace knap
