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

/// At the same time, with every fan bonded and at rest in its first place.
State all_bonded(const State& state, const Model& to) {
    State next;
    next.time = state.time, next.last_step = state.last_step, next.n_steps = state.n_steps;
    next.displacement.assign(to.fans.size(), Vec2::Zero()), next.velocity = next.displacement;
    if (state.has_end_velocities()) next.rate = next.displacement;
    next.node_of_corner = to.fan_of_corner;
    next.split_rank.assign(to.fans.size(), -1);
    next.reaction.assign(to.prescribed.size(), Vec2::Zero());
    next.fluid_pressure = state.fluid_pressure;
    return next;
}

/// Fan of each vertex; the model has first order and no excavations, so that every vertex has one.
std::vector<Index> fans_at_vertices(const Model& model) {
    std::vector<Index> fans(model.mesh.vertices.size(), -1);
    for (Index f = 0; f < std::ssize(model.fans); ++f) fans[model.fans[f].vertex] = f;
    return fans;
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
    State next = all_bonded(state, to);
    next.elastic_energy = state.elastic_energy, next.elastic_work = state.elastic_work;
    next.obstacles = state.obstacles, next.free_pieces = state.free_pieces;
    next.temperature = state.temperature, next.temperature_before = state.temperature_before;
    const std::size_t n_fans = to.fans.size();
    const auto vanished = [&](Index corner) { return to.has_vanished(to.mesh.triangle_of(corner)); };
    const auto was_split = [&](Index corner) { return state.split_rank[from.fan_of_corner[corner]] >= 0; };
    for (std::size_t f = 0; f < n_fans; ++f)  // a single corner needs no points
        if (to.fans[f].n_points > 0 && was_split(to.corners(to.fans[f])[0])) split(to, static_cast<Index>(f), next);
    for (Index c = 0; c < to.mesh.n_corners(); ++c) {
        if (vanished(c)) continue;
        const Index old = state.node_of_corner[c], node = next.node_of_corner[c];
        next.displacement[node] = state.displacement[old], next.velocity[node] = state.velocity[old];
        if (state.has_end_velocities()) next.rate[node] = state.rate[old];
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
        if (to.fan_point_of[p] < 0) next.retired[p] = Retirement::none;
    const auto stays = [&](Index corner) { return to.ground_at(corner) != nullptr || !vanished(corner); };
    for (const FaceContactState& contact : state.face_contacts)
        if (stays(contact.vertex) && stays(contact.edge)) next.face_contacts.push_back(contact);
    next.obstacle_contacts = state.obstacle_contacts;
    next.impacts = state.impacts;
    return next;
}

State carried_over(const Model& from, const State& state, const Model& to, const RefinedMesh& refined) {
    State next = all_bonded(state, to);
    next.obstacles = state.obstacles;
    if (!state.incubation.empty()) next.incubation.resize(to.fans.size());
    const auto corner_before = [&](Index corner) {
        const Index t = refined.triangle_before[to.mesh.triangle_of(corner)];
        return t < 0 ? -1 : 3 * t + to.mesh.place_in_triangle(corner);
    };
    const std::vector<Index> old_fans = fans_at_vertices(from);
    for (Index f = 0; f < std::ssize(to.fans); ++f) {
        const Fan& fan = to.fans[f];
        const VertexOrigin& origin = refined.origin[fan.vertex];
        if (origin.triangle >= 0) {
            for (int k = 0; k < 3; ++k) {
                const Index node = state.node_of_corner[3 * origin.triangle + k];
                next.displacement[f] += origin.weight[k] * state.displacement[node];
                next.velocity[f] += origin.weight[k] * state.velocity[node];
                if (next.incubation.empty()) continue;
                const Incubation& memory = state.incubation[from.fan_of_corner[3 * origin.triangle + k]];
                next.incubation[f].memory += origin.weight[k] * memory.memory;
                next.incubation[f].utilisation += origin.weight[k] * memory.utilisation;
                next.incubation[f].time += origin.weight[k] * memory.time;
            }
            continue;
        }
        const Index old = old_fans[origin.vertex];
        if (!next.incubation.empty()) next.incubation[f] = state.incubation[old];
        next.displacement[f] = state.displacement[old], next.velocity[f] = state.velocity[old];
        if (state.split_rank[old] < 0) continue;
        split(to, f, next);
        for (const Index c : to.corners(fan)) {
            const Index node = next.node_of_corner[c], node_before = state.node_of_corner[corner_before(c)];
            next.displacement[node] = state.displacement[node_before],
            next.velocity[node] = state.velocity[node_before];
        }
        // the same points, perhaps from another one on
        const auto same_corner = [&](Index now, Index before) {
            return now == rigid_support ? before == rigid_support : before == corner_before(now);
        };
        const auto points = to.points(fan), points_before = from.points(from.fans[old]);
        for (std::size_t j = 0; j < points.size(); ++j) {
            const auto known = std::ranges::find_if(points_before, [&](const FanPoint& point) {
                return same_corner(points[j].before, point.before) && same_corner(points[j].after, point.after);
            });
            next.points[next.first_point.back() + j] =
                state.points[state.first_point[state.split_rank[old]] + (known - points_before.begin())];
        }
    }
    for (Index c = 0; c < to.mesh.n_corners(); ++c)
        if (const Index motion = to.prescribed_of_corner[c], old = corner_before(c); motion >= 0 && old >= 0)
            next.reaction[motion] = state.reaction[from.prescribed_of_corner[old]];
    if (!state.temperature) return next;
    const auto on_new_mesh = [&](const Temperatures& before) -> SharedTemperatures {
        if (!to.heat->conduction) return field_at(to, before.time);
        std::vector<double> of_corner(to.mesh.n_corners(), 0.0);
        for (Index c = 0; c < to.mesh.n_corners(); ++c) {
            const VertexOrigin& origin = refined.origin[to.mesh.triangles[c / 3][c % 3]];
            if (const Index old = corner_before(c); old >= 0) of_corner[c] = before.of_corner[old];
            else if (origin.triangle < 0)
                of_corner[c] = before.of_corner[from.corners(from.fans[old_fans[origin.vertex]])[0]];
            else
                for (int k = 0; k < 3; ++k)
                    of_corner[c] += origin.weight[k] * before.of_corner[3 * origin.triangle + k];
        }
        const auto made = make_temperatures(to, before.time, std::move(of_corner));
        made->heat = before.heat, made->heat_in = before.heat_in, made->heat_moved = before.heat_moved;
        made->heat_scale = before.heat_scale, made->range = before.range, made->overshoot = before.overshoot;
        return made;
    };
    const bool same = state.temperature == state.temperature_before || !state.temperature_before;
    next.temperature = on_new_mesh(*state.temperature);
    next.temperature_before = same ? next.temperature : on_new_mesh(*state.temperature_before);
    return next;
}

}  // namespace knap
