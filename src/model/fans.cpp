#include "model/fans.hpp"

#include "model/random_strength.hpp"

#include <algorithm>
#include <cassert>

namespace knap {
namespace {

constexpr Index none = -1;

/// Interface at each side (3 triangle + side) of the mesh, or none.
using InterfaceOfSide = std::vector<Index>;

Index ray_side(Index k) { return k; }            // the edge at which corner k begins, going counterclockwise
Index last_side(Index k) { return (k + 2) % 3; }  // the edge at which it ends

Interface interface_at(const Mesh& mesh, Index a, Index b, Index owner, Index side) {
    // seen from `owner`: its outward normal is the edge turned right; N runs from A to B
    const Vec2 from = mesh.corner(owner, side), to = mesh.corner(owner, (side + 1) % 3);
    const Vec2 outward = -turned_left((to - from).normalized());
    return {.triangle = {a, b},
            .vertex = {mesh.triangles[owner][side], mesh.triangles[owner][(side + 1) % 3]},
            .normal = owner == a ? outward : Vec2(-outward),
            .length = (to - from).norm(),
            .law = 0,
            .cracked = false,
            .gap = 0};
}

InterfaceOfSide make_interfaces(const ModelInput& input, const SupportOfEdge& support_of_edge, Model& model) {
    const Mesh& mesh = model.mesh;
    InterfaceOfSide interface_of_side(3 * mesh.n_triangles(), none);
    for (const InteriorEdge& edge : mesh.interior_edges) {
        const auto [a, b] = edge.triangle;
        Interface made = interface_at(mesh, a, b, a, edge.side[0]);
        made.law = edge.joint >= 0           ? input.law_of_joint[edge.joint]
                   : mesh.within_grain(edge) ? input.law_within[mesh.region[a]]
                                             : input.law_of_pair[mesh.region[a]][mesh.region[b]];
        made.cracked = edge.cracked;
        interface_of_side[3 * a + edge.side[0]] = interface_of_side[3 * b + edge.side[1]] = static_cast<Index>(model.interfaces.size());
        model.interfaces.push_back(made);
    }
    for (std::size_t i = 0; i < mesh.boundary_edges.size(); ++i) {
        if (support_of_edge[i] == none) continue;
        const BoundaryEdge& edge = mesh.boundary_edges[i];
        const Support& support = input.supports[support_of_edge[i]];
        Interface made = interface_at(mesh, rigid_support, edge.triangle, edge.triangle, edge.side);
        made.law = support.law;
        made.cracked = !support.glued;
        made.gap = support.gap;
        interface_of_side[3 * edge.triangle + edge.side] = static_cast<Index>(model.interfaces.size());
        model.interfaces.push_back(made);
    }
    return interface_of_side;
}

class FanWalk {
public:
    FanWalk(Model& model, const InterfaceOfSide& interface_of_side) : model_(model), interface_of_side_(interface_of_side) {}

    /// The fan that holds `corner`, walked counterclockwise from its first edge.
    void walk(Index corner) {
        const Index start = first_corner_of(corner);
        const Index vertex = vertex_of(start);
        Fan fan = no_fan();
        fan.vertex = vertex;
        fan.closed = across(start, ray_side(vertex_place(start))) != none;
        Index before = fan.closed ? across(start, ray_side(vertex_place(start))) : rigid_support;
        for (Index here = start;;) {
            add_end_point(interface_of_side_[side_of(here, ray_side(vertex_place(here)))], vertex, before, here, fan);
            add_corner(here, fan);
            before = here;
            here = across(here, last_side(vertex_place(here)));
            if (here == none || here == start) break;
        }
        if (!fan.closed) add_end_point(interface_of_side_[side_of(before, last_side(vertex_place(before)))], vertex, before, rigid_support, fan);
        model_.fans.push_back(fan);
    }

    /// The fan in the middle of a side: `corner` and the one across, if there is one.
    void walk_middle(Index corner) {
        const Index t = model_.mesh.triangle_of(corner), side = vertex_place(corner) - 3, interface = interface_of_side_[3 * t + side];
        Fan fan = no_fan();
        if (interface == none) {
            add_corner(corner, fan);
        } else {
            const Interface& edge = model_.interfaces[interface];
            std::array<Index, 2> sides{rigid_support, rigid_support};  // A and B
            for (int i = 0; i < 2; ++i)
                if (edge.triangle[i] != rigid_support) add_corner(sides[i] = middle_of(edge.triangle[i], interface), fan);
            add_point(interface, 2, sides[0], sides[1], edge.normal, 4. / 6, fan);
        }
        model_.fans.push_back(fan);
    }

    void walk_centre(Index corner) {
        Fan fan = no_fan();
        add_corner(corner, fan);
        model_.fans.push_back(fan);
    }

private:
    Fan no_fan() const {
        return {.vertex = none,
                .first_corner = static_cast<Index>(model_.fan_corners.size()),
                .n_corners = 0,
                .first_point = static_cast<Index>(model_.fan_points.size()),
                .n_points = 0,
                .closed = false,
                .split_at_start = false,
                .mass = 0};
    }

    Index middle_of(Index triangle, Index interface) const {
        Index side = 0;
        while (interface_of_side_[3 * triangle + side] != interface) ++side;
        return model_.mesh.corners_per_triangle() * triangle + 3 + side;
    }

    Index side_of(Index corner, Index side) const { return 3 * model_.mesh.triangle_of(corner) + side; }
    Index vertex_place(Index corner) const { return model_.mesh.place_in_triangle(corner); }
    Index vertex_of(Index corner) const { return model_.mesh.triangles[model_.mesh.triangle_of(corner)][vertex_place(corner)]; }

    /// The corner at the same vertex on the other side of an edge, or none at the boundary.
    Index across(Index corner, Index side) const {
        const Index i = interface_of_side_[side_of(corner, side)];
        if (i == none || model_.interfaces[i].triangle[0] == rigid_support) return none;
        const auto& pair = model_.interfaces[i].triangle;
        const Index other = pair[0] == model_.mesh.triangle_of(corner) ? pair[1] : pair[0];
        for (Index k = 0; k < 3; ++k)
            if (model_.mesh.triangles[other][k] == vertex_of(corner)) return model_.mesh.corners_per_triangle() * other + k;
        assert(false);
        return none;
    }

    Index first_corner_of(Index corner) const {
        Index first = corner;  // walk clockwise to the boundary; round a closed fan begin at the lowest corner
        for (Index here = across(corner, ray_side(vertex_place(corner))); here != corner; here = across(here, ray_side(vertex_place(here)))) {
            if (here == none) {
                Index open_end = corner;
                while (across(open_end, ray_side(vertex_place(open_end))) != none) open_end = across(open_end, ray_side(vertex_place(open_end)));
                return open_end;
            }
            first = std::min(first, here);
        }
        return first;
    }

    void add_corner(Index corner, Fan& fan) {
        model_.fan_of_corner[corner] = static_cast<Index>(model_.fans.size());
        model_.fan_corners.push_back(corner);
        fan.mass += model_.corner_mass[corner];
        ++fan.n_corners;
    }

    void add_end_point(Index interface, Index vertex, Index before, Index after, Fan& fan) {
        if (interface == none) return;  // a free end
        const Interface& edge = model_.interfaces[interface];
        const Index end = edge.vertex[0] == vertex ? 0 : 1;
        const Vec2 ray = (model_.mesh.vertices[edge.vertex[1 - end]] - model_.mesh.vertices[vertex]).normalized();
        add_point(interface, end, before, after, turned_left(ray), model_.mesh.order == 1 ? 1. / 2 : 1. / 6, fan);
    }

    /// `part`: of the edge.
    void add_point(Index interface, Index place, Index before, Index after, const Vec2& normal, double part, Fan& fan) {
        const Interface& edge = model_.interfaces[interface];
        const Index point = model_.points_per_interface() * interface + place;
        model_.fan_point_of[point] = static_cast<Index>(model_.fan_points.size());
        model_.fan_points.push_back({.before = before,
                                     .after = after,
                                     .point = point,
                                     .law = edge.law,
                                     .cracked = edge.cracked,
                                     .normal = normal,
                                     .area = part * edge.length * model_.thickness,
                                     .gap = edge.gap});
        ++fan.n_points;
        fan.split_at_start = fan.split_at_start || edge.cracked || before == rigid_support || after == rigid_support;
    }

    Model& model_;
    const InterfaceOfSide& interface_of_side_;
};

}  // namespace

void make_interfaces_and_fans(const ModelInput& input, const SupportOfEdge& support_of_edge, Model& model) {
    const InterfaceOfSide interface_of_side = make_interfaces(input, support_of_edge, model);
    scatter_strength(input, model);
    model.fan_of_corner.assign(model.mesh.n_corners(), none);
    model.fan_point_of.assign(model.n_points(), none);

    // fans in the order of their vertices, then of their triangles, so that the nodes keep the mesh's locality
    const Mesh& mesh = model.mesh;
    std::vector<Index> order, middles, centres;
    for (Index c = 0; c < mesh.n_corners(); ++c) {
        const Index place = mesh.place_in_triangle(c);
        (place < 3 ? order : place < 6 ? middles : centres).push_back(c);
    }
    const auto vertex = [&](Index c) { return mesh.triangles[mesh.triangle_of(c)][mesh.place_in_triangle(c)]; };
    std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return vertex(a) < vertex(b); });
    FanWalk walker(model, interface_of_side);
    for (const Index corner : order)
        if (model.fan_of_corner[corner] == none) walker.walk(corner);
    for (const Index corner : middles)
        if (model.fan_of_corner[corner] == none) walker.walk_middle(corner);
    for (const Index corner : centres) walker.walk_centre(corner);
}

}  // namespace knap
