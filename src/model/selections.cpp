#include "model/selections.hpp"

namespace knap {
namespace {

/// What holds one corner holds all that are bonded to it round the vertex; a crack ends it.
void spread_over_bonds(const Model& model, const Fan& fan, std::vector<char>& held) {
    for (int pass = 0; pass < 2; ++pass)  // forth and back; a second time round for closed fans
        for (Index step = 0; step < 2 * fan.n_points; ++step) {
            const Index j = pass == 0 ? step % fan.n_points : fan.n_points - 1 - step % fan.n_points;
            const FanPoint& point = model.fan_points[fan.first_point + j];
            if (point.cracked || point.before == rigid_support || point.after == rigid_support) continue;
            if (held[point.before] || held[point.after]) held[point.before] = held[point.after] = 1;
        }
}

}  // namespace

std::vector<std::size_t> selected_edges(const Mesh& mesh, const Selection& on) {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < mesh.boundary_edges.size(); ++i) {
        const BoundaryEdge& edge = mesh.boundary_edges[i];
        const Vec2 middle = 0.5 * (mesh.corner(edge.triangle, edge.side) + mesh.corner(edge.triangle, (edge.side + 1) % 3));
        const bool named = on.boundary.empty() || mesh.boundary_names[edge.boundary] == on.boundary;
        if (named && (!on.box || on.box->contains(middle))) found.push_back(i);
    }
    return found;
}

std::vector<char> selected_corners(const Mesh& mesh, const Selection& on) {
    std::vector<char> selected(mesh.n_corners(), 0);
    if (on.boundary.empty()) {
        for (Index c = 0; c < mesh.n_corners(); ++c) selected[c] = !on.box || on.box->contains(mesh.corner(c));
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

std::vector<char> held_corners(const Model& model, const Selection& on) {
    std::vector<char> held = selected_corners(model.mesh, on);
    for (const Fan& fan : model.fans) spread_over_bonds(model, fan, held);
    return held;
}

}  // namespace knap
