#include "model/successor.hpp"

#include "model/fans.hpp"

#include <algorithm>

namespace knap {
namespace {

/// Edges of the mesh: what was between a triangle that vanishes and one that stays becomes boundary.
void cut_edges(Model& model) {
    Mesh& mesh = model.mesh;
    const auto vanished = [&](Index triangle) { return model.has_vanished(triangle); };
    std::erase_if(mesh.boundary_edges, [&](const BoundaryEdge& edge) { return vanished(edge.triangle); });
    auto name = std::ranges::find(mesh.boundary_names, "") - mesh.boundary_names.begin();
    if (name == std::ssize(mesh.boundary_names)) mesh.boundary_names.emplace_back();
    for (const InteriorEdge& edge : mesh.interior_edges)
        for (int side = 0; side < 2; ++side)
            if (vanished(edge.triangle[1 - side]) && !vanished(edge.triangle[side]))
                mesh.boundary_edges.push_back({edge.triangle[side], edge.side[side], static_cast<Index>(name)});
    std::erase_if(mesh.interior_edges,
                  [&](const InteriorEdge& edge) { return vanished(edge.triangle[0]) || vanished(edge.triangle[1]); });
}

/// Loads and prescribed motions of the corners that stay.
void keep_loads(Model& model) {
    const auto vanished = [&](Index corner) { return model.has_vanished(model.mesh.triangle_of(corner)); };
    std::erase_if(model.corner_loads, [&](const CornerLoad& load) { return vanished(load.corner); });
    std::vector<PrescribedMotion> kept;
    for (Index c = 0; c < model.mesh.n_corners(); ++c) {
        Index& number = model.prescribed_of_corner[c];
        if (number < 0) continue;
        if (!vanished(c)) kept.push_back(model.prescribed[number]), kept.back().fan = model.fan_of_corner[c];
        number = vanished(c) ? -1 : static_cast<Index>(kept.size()) - 1;
    }
    model.prescribed = std::move(kept);
}

}  // namespace

Model without(Model model, std::span<const Index> triangles) {
    model.vanished.resize(model.mesh.n_triangles(), 0);
    for (const Index t : triangles) model.vanished[t] = 1;
    cut_edges(model);
    make_fans(model);
    keep_loads(model);
    return model;
}

State carried_over(const Model& from, const State& state, const Model& to) {
    State next;
    next.time = state.time, next.last_step = state.last_step, next.n_steps = state.n_steps;
    next.elastic_energy = state.elastic_energy, next.elastic_work = state.elastic_work;
    next.obstacles = state.obstacles;
    next.temperature = state.temperature, next.temperature_before = state.temperature_before;
    const std::size_t n_fans = to.fans.size();
    next.displacement.assign(n_fans, Vec2::Zero()), next.velocity = next.displacement;
    if (!state.rate.empty()) next.rate = next.displacement;
    next.node_of_corner = to.fan_of_corner;
    next.split_rank.assign(n_fans, -1);
    next.reaction.assign(to.prescribed.size(), Vec2::Zero());
    const auto vanished = [&](Index corner) { return to.has_vanished(to.mesh.triangle_of(corner)); };
    const auto was_split = [&](Index corner) { return state.split_rank[from.fan_of_corner[corner]] >= 0; };
    for (std::size_t f = 0; f < n_fans; ++f)  // a single corner needs no points
        if (to.fans[f].n_points > 0 && was_split(to.corners(to.fans[f])[0])) split(to, static_cast<Index>(f), next);
    for (Index c = 0; c < to.mesh.n_corners(); ++c) {
        if (vanished(c)) continue;
        const Index old = state.node_of_corner[c], node = next.node_of_corner[c];
        next.displacement[node] = state.displacement[old], next.velocity[node] = state.velocity[old];
        if (!state.rate.empty()) next.rate[node] = state.rate[old];
        if (const Index motion = to.prescribed_of_corner[c]; motion >= 0)
            next.reaction[motion] = state.reaction[from.prescribed_of_corner[c]];
    }
    for (std::size_t s = 0; s < next.split_fans.size(); ++s) {
        const auto points = to.points(to.fans[next.split_fans[s]]);
        for (std::size_t j = 0; j < points.size(); ++j)
            next.points[next.first_point[s] + j] = *state_of(from, state, points[j].point);
    }
    if (!state.incubation.empty()) next.incubation.resize(n_fans);
    for (std::size_t f = 0; f < next.incubation.size(); ++f)
        next.incubation[f] = state.incubation[from.fan_of_corner[to.corners(to.fans[f])[0]]];
    next.retired = state.retired;
    for (std::size_t p = 0; p < next.retired.size(); ++p)
        if (to.fan_point_of[p] < 0) next.retired[p] = 0;
    for (const FaceContactState& contact : state.face_contacts)
        if (!vanished(contact.vertex) && !vanished(contact.edge)) next.face_contacts.push_back(contact);
    return next;
}

}  // namespace knap
