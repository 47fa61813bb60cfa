#include "mesh/triangle_locator.hpp"

#include <algorithm>

namespace knap {

TriangleLocator::TriangleLocator(const Mesh& mesh, const std::vector<Index>& triangles)
    : mesh_(mesh), stars_(mesh.vertices.size(), [&](const auto& visit) {
          for (const Index t : triangles)
              for (const Index v : mesh.triangles[t]) visit(v, t);
      }) {
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
        }
}

Place TriangleLocator::place_of(const Vec2& p) const {
    const delaunay::Face face = last_ = triangulation_.locate(delaunay::point(p), last_);
    if (triangulation_.is_infinite(face)) return {};
    const auto number = [&](int k) { return face->vertex(k)->info().value; };
    const std::array<Index, 3> corners{number(0), number(1), number(2)};
    const std::span<const Index> star = stars_[corners[0]];
    const auto found =
        std::ranges::find_if(star, [&](Index t) { return std::ranges::is_permutation(mesh_.triangles[t], corners); });
    if (found == star.end()) return {};
    const Index t = *found;
    const Vec2 a = mesh_.corner(t, 0), ab = mesh_.corner(t, 1) - a, ac = mesh_.corner(t, 2) - a;
    const double twice_area = cross(ab, ac), y = cross(p - a, ac) / twice_area, z = cross(ab, p - a) / twice_area;
    return {t, {1 - y - z, y, z}};
}

}  // namespace knap
