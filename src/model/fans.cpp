#include "model/fans.hpp"

#include "base/random.hpp"

#include <algorithm>

namespace knap {
namespace {

/// An interface along edge `side` of the triangle a, or b on a support.
void add_interface(Index a, Index b, Index side, Index law, Index joint_law, bool cracked, double gap, Model& model) {
    const Index t = a == rigid_support ? b : a;
    const Vec2 along = model.mesh.side_vector(t, side), outward = -turned_left(along.normalized());
    model.interfaces.push_back({.triangle = {a, b},
                                .vertex = model.mesh.side_vertices(t, side),
                                .normal = a == rigid_support ? Vec2(-outward) : outward,
                                .length = along.norm(),
                                .law = law,
                                .joint_law = joint_law,
                                .cracked = cracked,
                                .gap = gap});
}

/// Half-edge h = 3 triangle + k runs along edge k of the triangle, from its vertex k, counterclockwise.
class FanMaker {
public:
    explicit FanMaker(Model& model)
        : model_(model),
          mesh_(model.mesh),
          interface_(3 * mesh_.n_triangles(), no_index),
          twin_(3 * mesh_.n_triangles(), no_index) {
        for (Index i = 0; i < static_cast<Index>(model.interfaces.size()); ++i)
            if (!model.is_gone(model.interfaces[i])) join_sides(i);
    }

    /// In the order of their vertices, then of their triangles, so that the nodes keep the locality of the mesh.
    void make_fans() {
        model_.fans.clear(), model_.fan_corners.clear(), model_.fan_points.clear();
        model_.fan_of_corner.assign(mesh_.n_corners(), no_index);
        model_.fan_point_of.assign(model_.n_points(), no_index);
        model_.fans.reserve(mesh_.vertices.size());  // of order 1: some vertices have several fans, but few
        model_.fan_corners.reserve(mesh_.n_corners()), model_.fan_points.reserve(model_.n_points());
        const Grouped<Index> half_edges(mesh_.vertices.size(), [&](const auto& visit) {
            for (Index h = 0; h < 3 * mesh_.n_triangles(); ++h) visit(vertex(h), h);
        });
        for (std::size_t v = 0; v < half_edges.n_groups(); ++v)
            for (const Index h : half_edges[v])
                if (model_.fan_of_corner[corner(h)] == no_index) add_fan_of_vertex(h);
        if (mesh_.order == 1) return;
        for (Index h = 0; h < 3 * mesh_.n_triangles(); ++h)
            if (model_.fan_of_corner[middle(h)] == no_index) add_fan_of_middle(h);
        for (Index t = 0; t < mesh_.n_triangles(); ++t) {
            begin_fan(no_index, false);
            add_corner(7 * t + 6);
        }
    }

private:
    /// The next half-edge from the same vertex, or none.
    Index clockwise(Index h) const { return twin_[h] == no_index ? no_index : next_in_triangle(twin_[h]); }
    Index counterclockwise(Index h) const { return twin_[previous_in_triangle(h)]; }
    Index vertex(Index h) const { return mesh_.triangles[h / 3][h % 3]; }
    Index corner(Index h) const { return mesh_.corners_per_triangle() * (h / 3) + h % 3; }
    Index middle(Index h) const { return 7 * (h / 3) + 3 + h % 3; }

    /// From one of the vertices of a triangle.
    Index half_edge(Index triangle, Index from) const {
        Index h = 3 * triangle;
        while (vertex(h) != from) ++h;
        return h;
    }

    void join_sides(Index i) {
        const auto& [a, b] = model_.interfaces[i].triangle;
        const auto& ends = model_.interfaces[i].vertex;
        if (a == rigid_support) {
            interface_[half_edge(b, ends[0])] = i;
            return;
        }
        const Index h = half_edge(a, ends[0]), other = half_edge(b, ends[1]);
        interface_[h] = interface_[other] = i;
        twin_[h] = other, twin_[other] = h;
    }

    /// The first half-edge of the fan counterclockwise; of a closed fan that with the lowest number.
    Index first_of(Index h) const {
        Index lowest = h, last = h;
        for (Index i = clockwise(h); i != h; i = clockwise(i)) {
            if (i == no_index) return last;
            lowest = std::min(lowest, i);
            last = i;
        }
        return lowest;
    }

    void add_fan_of_vertex(Index any) {
        const Index first = first_of(any);
        const bool closed = twin_[first] != no_index;
        begin_fan(vertex(first), closed);
        Index before = closed ? corner(clockwise(first)) : rigid_support;
        for (Index h = first;;) {
            add_end_point(interface_[h], before, corner(h));
            add_corner(corner(h));
            before = corner(h);
            const Index last = previous_in_triangle(h);
            h = counterclockwise(h);
            if (h == no_index) return add_end_point(interface_[last], before, rigid_support);
            if (h == first) return;
        }
    }

    /// The one or two corners in the middle of an edge.
    void add_fan_of_middle(Index h) {
        begin_fan(no_index, false);
        if (interface_[h] == no_index) return add_corner(middle(h));
        const Interface& edge = model_.interfaces[interface_[h]];
        std::array<Index, 2> sides{rigid_support, rigid_support};  // A and B
        for (int i = 0; i < 2; ++i)
            if (edge.triangle[i] != rigid_support)
                add_corner(sides[i] = middle(edge.triangle[i] == h / 3 ? h : twin_[h]));
        add_point(interface_[h], 2, sides[0], sides[1], edge.normal, 4. / 6);
    }

    void begin_fan(Index vertex, bool closed) {
        model_.fans.push_back({.vertex = vertex,
                               .first_corner = static_cast<Index>(model_.fan_corners.size()),
                               .n_corners = 0,
                               .first_point = static_cast<Index>(model_.fan_points.size()),
                               .n_points = 0,
                               .closed = closed,
                               .split_at_start = false,
                               .mass = 0});
    }

    void add_corner(Index corner) {
        Fan& fan = model_.fans.back();
        model_.fan_of_corner[corner] = static_cast<Index>(model_.fans.size()) - 1;
        model_.fan_corners.push_back(corner);
        fan.mass += model_.corner_mass[corner];
        ++fan.n_corners;
    }

    void add_end_point(Index interface, Index before, Index after) {
        if (interface == no_index) return;  // a free boundary edge
        const Index vertex = model_.fans.back().vertex;
        const auto& ends = model_.interfaces[interface].vertex;
        const Index place = ends[0] == vertex ? 0 : 1;
        const Vec2 ray = (mesh_.vertices[ends[1 - place]] - mesh_.vertices[vertex]).normalized();
        add_point(interface, place, before, after, turned_left(ray), mesh_.order == 1 ? 1. / 2 : 1. / 6);
    }

    /// `share`: of the edge.
    void add_point(Index interface, Index place, Index before, Index after, const Vec2& normal, double share) {
        const Interface& edge = model_.interfaces[interface];
        Fan& fan = model_.fans.back();
        const Index point = model_.points_per_interface() * interface + place;
        model_.fan_point_of[point] = static_cast<Index>(model_.fan_points.size());
        model_.fan_points.push_back({.before = before,
                                     .after = after,
                                     .point = point,
                                     .law = edge.law,
                                     .cracked = edge.cracked,
                                     .normal = normal,
                                     .area = share * edge.length * model_.thickness,
                                     .gap = edge.gap});
        ++fan.n_points;
        fan.split_at_start = fan.split_at_start || edge.cracked || model_.fan_points.back().on_support();
    }

    Model& model_;
    const Mesh& mesh_;
    std::vector<Index> interface_, twin_;  // per half-edge, or none
};

}  // namespace

void make_fans(Model& model) { FanMaker(model).make_fans(); }

void make_interfaces(const ModelInput& input, const SupportOfEdge& support_of_edge, Model& model) {
    const Mesh& mesh = model.mesh;
    model.interfaces.reserve(mesh.interior_edges.size() + mesh.boundary_edges.size() -
                             std::ranges::count(support_of_edge, no_index));
    for (const InteriorEdge& edge : mesh.interior_edges) {
        const auto [a, b] = edge.triangle;
        const Index law = law_of_edge(input, mesh, edge);
        add_interface(a, b, edge.side[0], law, edge.joint >= 0 ? law : no_index, edge.cracked, 0, model);
    }
    for (std::size_t i = 0; i < mesh.boundary_edges.size(); ++i) {
        if (support_of_edge[i] == no_index) continue;
        const BoundaryEdge& edge = mesh.boundary_edges[i];
        const Support& support = input.supports[support_of_edge[i]];
        add_interface(rigid_support, edge.triangle, edge.side, support.law, no_index, !support.glued, support.gap,
                      model);
        model.interfaces.back().beyond = support.beyond;
    }
    vary_strength(input, model);
}

}  // namespace knap
