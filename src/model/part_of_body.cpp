#include "model/part_of_body.hpp"

#include "model/fans.hpp"

#include <algorithm>
#include <cassert>

namespace knap {
namespace {

void take_mesh(const Mesh& whole, PartOfBody& part) {
    Mesh& mesh = part.model.mesh;
    std::vector<Index> number(whole.n_vertices(), 0);
    for (const Index t : part.triangles)
        for (const Index v : whole.triangles[t]) number[v] = 1;
    for (Index v = 0; v < whole.n_vertices(); ++v)
        if (number[v]) number[v] = mesh.n_vertices(), mesh.vertices.push_back(whole.vertices[v]);
    for (const Index t : part.triangles) {
        const auto& [a, b, c] = whole.triangles[t];
        mesh.triangles.push_back({number[a], number[b], number[c]});
        mesh.region.push_back(whole.region[t]);
        if (!whole.grain.empty()) mesh.grain.push_back(whole.grain[t]);
        if (!whole.layer_angle.empty()) mesh.layer_angle.push_back(whole.layer_angle[t]);
    }
    mesh.boundary_names = {""};
    for (const BoundaryEdge& edge : whole.boundary_edges)
        if (const Index t = part.triangle_of_part[edge.triangle]; t >= 0)
            mesh.boundary_edges.push_back({t, edge.side, 0});
    for (InteriorEdge edge : whole.interior_edges) {
        for (Index& t : edge.triangle) t = part.triangle_of_part[t];
        if (edge.triangle[0] >= 0 && edge.triangle[1] >= 0) mesh.interior_edges.push_back(edge);
        else
            for (int side = 0; side < 2; ++side)
                if (edge.triangle[side] >= 0) mesh.boundary_edges.push_back({edge.triangle[side], edge.side[side], 0});
    }
}

}  // namespace

bool may_be_parted(const Model& model) {
    return model.mesh.order == 1 && model.ground.vertices.empty() && model.prescribed.empty() &&
           model.state_forces.empty() && model.crack_fluids.empty() && !model.heat && model.vanished.empty() &&
           !model.may_become_finer() &&
           std::ranges::none_of(model.interfaces,
                                [](const Interface& interface) { return interface.triangle[0] == rigid_support; }) &&
           std::ranges::none_of(model.obstacles, [](const Obstacle& obstacle) { return obstacle.is_free(); });
}

PartOfBody part_of(const Model& model, std::span<const Index> triangles) {
    assert(std::ranges::is_sorted(triangles));
    PartOfBody part{
        .model = {.plane = model.plane, .thickness = model.thickness, .materials = model.materials, .laws = model.laws},
        .triangles = {triangles.begin(), triangles.end()},
        .triangle_of_part = std::vector<Index>(model.mesh.n_triangles(), -1)};
    for (std::size_t t = 0; t < triangles.size(); ++t) part.triangle_of_part[triangles[t]] = static_cast<Index>(t);
    Model& own = part.model;
    take_mesh(model.mesh, part);
    if (!model.mass_factor.empty())
        for (const Index t : triangles) own.mass_factor.push_back(model.mass_factor[t]);
    for (Index c = 0; c < own.mesh.n_corners(); ++c) own.corner_mass.push_back(model.corner_mass[part.in_whole(c)]);
    for (Index i = 0; i < static_cast<Index>(model.interfaces.size()); ++i) {
        Interface interface = model.interfaces[i];
        const auto& sides = interface.triangle;
        const std::array<Index, 2> own_sides{part.triangle_of_part[sides[0]], part.triangle_of_part[sides[1]]};
        if (own_sides[0] < 0 || own_sides[1] < 0) continue;
        Index side = 0;  // along which it runs in its first triangle
        while (model.mesh.side_vertices(sides[0], side) != interface.vertex) ++side;
        interface.triangle = own_sides;
        interface.vertex = own.mesh.side_vertices(own_sides[0], side);
        own.interfaces.push_back(interface);
        part.interfaces.push_back(i);
    }
    make_fans(own);
    own.histories = model.histories, own.load_names = model.load_names;
    for (CornerLoad load : model.corner_loads)
        if (load.corner = part.in_part(load.corner); load.corner >= 0) own.corner_loads.push_back(load);
    own.prescribed_of_corner.assign(own.mesh.n_corners(), -1);
    own.obstacles = model.obstacles;
    own.large_rotation = model.large_rotation, own.contact_of_pair = model.contact_of_pair;
    return part;
}

State state_of_part(const Model& model, const State& state, const PartOfBody& part) {
    const Model& own = part.model;
    const std::size_t n_fans = own.fans.size();
    State of_part;
    of_part.time = state.time, of_part.n_steps = state.n_steps;
    of_part.displacement.assign(n_fans, Vec2::Zero()), of_part.velocity = of_part.displacement;
    of_part.node_of_corner = own.fan_of_corner;
    of_part.split_rank.assign(n_fans, -1);
    of_part.obstacles = state.obstacles;
    for (std::size_t f = 0; f < n_fans; ++f) {  // a single corner needs no points
        const Index corner = part.in_whole(own.corners(own.fans[f])[0]);
        if (own.fans[f].n_points > 0 && state.split_rank[model.fan_of_corner[corner]] >= 0)
            split(own, static_cast<Index>(f), of_part);
    }
    for (Index c = 0; c < own.mesh.n_corners(); ++c) {
        const Index node = of_part.node_of_corner[c], from = state.node_of_corner[part.in_whole(c)];
        of_part.displacement[node] = state.displacement[from], of_part.velocity[node] = state.velocity[from];
    }
    const auto in_whole = [&](Index point) { return 2 * part.interfaces[point / 2] + point % 2; };
    for (std::size_t s = 0; s < of_part.split_fans.size(); ++s) {
        const auto points = own.points(own.fans[of_part.split_fans[s]]);
        for (std::size_t j = 0; j < points.size(); ++j)
            of_part.points[of_part.first_point[s] + j] = *state_of(model, state, in_whole(points[j].point));
    }
    if (!state.retired.empty())
        for (Index p = 0; p < own.n_points(); ++p) of_part.retired.push_back(state.retired[in_whole(p)]);
    for (const FaceContactState& at : state.face_contacts)
        if (const Index vertex = part.in_part(at.vertex), edge = part.in_part(at.edge); vertex >= 0 && edge >= 0)
            of_part.face_contacts.push_back({vertex, edge, part.in_part(at.entering), at.contact, at.tangential});
    for (const ObstacleContactState& at : state.obstacle_contacts)
        if (const Index corner = part.in_part(at.corner); corner >= 0)
            of_part.obstacle_contacts.push_back({corner, at.second_corner < 0 ? -1 : part.in_part(at.second_corner),
                                                 at.obstacle, at.contact, at.tangential});
    for (Impact impact : state.impacts) {
        const bool with_piece = impact.other >= 0;
        impact.piece = part.triangle_of_part[impact.piece];
        if (with_piece) impact.other = part.triangle_of_part[impact.other];
        if (impact.piece >= 0 && (!with_piece || impact.other >= 0)) of_part.impacts.push_back(impact);
    }
    return of_part;
}

void write_back(const PartOfBody& part, const State& of_part, const Model& model, State& state) {
    const Model& own = part.model;
    for (const Index f : of_part.split_fans) {
        const Index fan = model.fan_of_corner[part.in_whole(own.corners(own.fans[f])[0])];
        if (state.split_rank[fan] < 0) split(model, fan, state);
    }
    for (Index c = 0; c < own.mesh.n_corners(); ++c) {
        const Index node = state.node_of_corner[part.in_whole(c)], from = of_part.node_of_corner[c];
        state.displacement[node] = of_part.displacement[from], state.velocity[node] = of_part.velocity[from];
    }
    for (std::size_t s = 0; s < of_part.split_fans.size(); ++s) {
        const auto points = own.points(own.fans[of_part.split_fans[s]]);
        for (std::size_t j = 0; j < points.size(); ++j) {
            const Index point = 2 * part.interfaces[points[j].point / 2] + points[j].point % 2;
            const Index in_fans = model.fan_point_of[point];
            const Index fan = model.fan_of_corner[model.fan_points[in_fans].corner()];
            PointState& to =
                state.points[state.first_point[state.split_rank[fan]] + in_fans - model.fans[fan].first_point];
            to = of_part.points[of_part.first_point[s] + j];
            if (of_part.has_retired(points[j].point)) to.traction.setZero();
        }
    }
    for (std::size_t p = 0; p < of_part.retired.size(); ++p)
        state.retired[2 * part.interfaces[p / 2] + p % 2] = of_part.retired[p];
}

}  // namespace knap
