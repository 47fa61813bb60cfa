#include "model/selections.hpp"

#include <algorithm>

namespace knap {
namespace {

/// The triangles of the body of a selection; all triangles where it names none.
MeshPart body_of(const Mesh& mesh, const Selection& on) {
    if (on.body.empty()) return {"", 0, mesh.n_triangles()};
    const auto found = std::ranges::find(mesh.parts, on.body, &MeshPart::name);
    return found == mesh.parts.end() ? MeshPart{} : *found;
}

bool contains(const MeshPart& part, Index triangle) {
    return triangle >= part.first_triangle && triangle < part.first_triangle + part.n_triangles;
}

/// A boundary BODY.SIDE has the name SIDE among those of the body, and of a group of bodies.
bool is_named(const std::string& boundary, const Selection& on) {
    if (on.boundary.empty() || boundary == on.boundary) return true;
    const std::size_t dot = boundary.find('.');
    return !on.body.empty() && dot != std::string::npos &&
           boundary.compare(dot + 1, std::string::npos, on.boundary) == 0;
}

}  // namespace

std::vector<std::size_t> selected_edges(const Mesh& mesh, const Selection& on) {
    std::vector<std::size_t> found;
    const MeshPart body = body_of(mesh, on);
    std::vector<char> named;
    for (const std::string& name : mesh.boundary_names) named.push_back(is_named(name, on));
    for (std::size_t i = 0; i < mesh.boundary_edges.size(); ++i) {
        const auto& [triangle, side, boundary] = mesh.boundary_edges[i];
        if (!contains(body, triangle)) continue;
        const Vec2 middle = 0.5 * (mesh.corner(triangle, side) + mesh.corner(triangle, (side + 1) % 3));
        if (named[boundary] && (!on.box || on.box->contains(middle))) found.push_back(i);
    }
    return found;
}

std::vector<char> selected_corners(const Mesh& mesh, const Selection& on) {
    std::vector<char> selected(mesh.n_corners(), 0);
    if (on.boundary.empty()) {
        const MeshPart body = body_of(mesh, on);
        const Index n = mesh.corners_per_triangle(), first = n * body.first_triangle;
        for (Index c = first; c < first + n * body.n_triangles; ++c)
            selected[c] = !on.box || on.box->contains(mesh.corner(c));
        return selected;
    }
    for (const std::size_t i : selected_edges(mesh, on)) {
        const auto& [triangle, side, boundary] = mesh.boundary_edges[i];
        const Index first = mesh.corners_per_triangle() * triangle;
        selected[first + side] = selected[first + (side + 1) % 3] = 1;
        if (mesh.order == 2) selected[first + 3 + side] = 1;
    }
    return selected;
}

std::vector<Index> selected_triangles(const Mesh& mesh, const Selection& on) {
    std::vector<Index> selected;
    const MeshPart body = body_of(mesh, on);
    for (Index t = body.first_triangle; t < body.first_triangle + body.n_triangles; ++t)
        if (!on.box || on.box->contains(mesh.centroid(t))) selected.push_back(t);
    return selected;
}

bool in_triangle(const Mesh& mesh, Index t, const Vec2& x) {
    for (Index k = 0; k < 3; ++k) {
        const Vec2 a = mesh.corner(t, k), b = mesh.corner(t, (k + 1) % 3);
        if (cross(b - a, x - a) < -1e-9 * (b - a).squaredNorm()) return false;
    }
    return true;
}

std::vector<char> held_corners(const Model& model, const Selection& on) {
    std::vector<char> held = selected_corners(model.mesh, on);
    for (const Fan& fan : model.fans) {
        const auto spread = [&](Index j) {
            const FanPoint& point = model.points(fan)[j % fan.n_points];
            if (point.cracked || point.on_support()) return;
            if (held[point.before] || held[point.after]) held[point.before] = held[point.after] = 1;
        };
        // forwards and backwards, each twice round because a fan may be closed
        for (Index j = 0; j < 2 * fan.n_points; ++j) spread(j);
        for (Index j = 2 * fan.n_points; j > 0; --j) spread(j - 1);
    }
    return held;
}

}  // namespace knap
