#include "analysis/deformation_watch.hpp"

#include "mesh/overlap.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace knap {
namespace {

constexpr double degree = M_PI / 180;
constexpr double little = 1e-3;    // of a triangle: faces that slid a little
constexpr double straight = 1e-6;  // [rad] supports that turn by less go straight on

struct Gradient {
    double xx, xy, yx, yy;  // u_x,x  u_x,y  u_y,x  u_y,y
};

/// Of the linear field through the displacements of the three vertices.
Gradient displacement_gradient(const Mesh& mesh, const State& state, Index t) {
    const Index first = mesh.corners_per_triangle() * t;
    const auto& vertex = mesh.triangles[t];
    const Vec2 a = mesh.vertices[vertex[1]] - mesh.vertices[vertex[0]], b = mesh.vertices[vertex[2]] - mesh.vertices[vertex[0]];
    const Vec2& u = state.displacement[state.node_of_corner[first]];
    const Vec2 u_a = state.displacement[state.node_of_corner[first + 1]] - u, u_b = state.displacement[state.node_of_corner[first + 2]] - u;
    const double inverse = 1 / cross(a, b);
    return {.xx = inverse * (u_a.x() * b.y() - u_b.x() * a.y()),
            .xy = inverse * (u_b.x() * a.x() - u_a.x() * b.x()),
            .yx = inverse * (u_a.y() * b.y() - u_b.y() * a.y()),
            .yy = inverse * (u_b.y() * a.x() - u_a.y() * b.x())};
}

Vec2 displacement_of(const State& state, Index corner) { return corner == rigid_support ? Vec2(Vec2::Zero()) : state.displacement[state.node_of_corner[corner]]; }

}  // namespace

DeformationWatch::DeformationWatch(const Model& model) : model_(model) {
    double lowest = std::numeric_limits<double>::infinity();  // [m] height of a triangle
    for (Index t = 0; t < model.mesh.n_triangles(); ++t) {
        const double area = model.mesh.area(t);
        body_area_ += area;
        for (Index k = 0; k < 3; ++k) lowest = std::min(lowest, 2 * area / (model.mesh.corner(t, (k + 1) % 3) - model.mesh.corner(t, k)).norm());
    }
    look_path_ = degree * lowest;
    triangle_area_ = body_area_ / std::max<Index>(1, model.mesh.n_triangles());
    measure_supports();
}

double DeformationWatch::search_path() const { return 0.1 * std::sqrt(body_area_ / std::max<Index>(1, model_.mesh.n_triangles())); }

void DeformationWatch::look_at(const State& state) {
    look_at_triangles(state);
    look_at_points(state);
}

/// F = R U with R by the angle atan2(F_yx - F_xy, F_xx + F_yy); the angle is taken only where its tangent beats the largest so far.
void DeformationWatch::look_at_triangles(const State& state) {
    const Mesh& mesh = model_.mesh;
    double tangent = std::tan(std::min(rotation_.value, 89.9) * degree), change = area_change_.value;
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        const Gradient g = displacement_gradient(mesh, state, t);
        const double sine = std::abs(g.yx - g.xy), cosine = 2 + g.xx + g.yy;
        if (!(sine <= tangent * cosine)) {
            rotation_.meet(std::atan2(sine, cosine) / degree, mesh.centroid(t));
            tangent = std::tan(std::min(rotation_.value, 89.9) * degree);
        }
        const double area = std::abs(g.xx + g.yy + g.xx * g.yy - g.xy * g.yx);
        if (!(area <= change)) area_change_.meet(area, mesh.centroid(t)), change = area_change_.value;
    }
}

void DeformationWatch::look_at_points(const State& state) {
    for (std::size_t s = 0; s < state.split_fans.size(); ++s) {
        const Fan& fan = model_.fans[state.split_fans[s]];
        const PointState* point = state.points.data() + state.first_point[s];
        for (Index k = 0; k < fan.n_points; ++k) {
            if (!(point[k].traction.x() > 0)) continue;
            const FanPoint& at = model_.fan_points[fan.first_point + k];
            double slip = turned_left(at.normal).dot(displacement_of(state, at.after) - displacement_of(state, at.before));
            const Index interface = model_.interface_of(at.point);
            if (at.before == rigid_support || at.after == rigid_support) slip = beyond_support(interface, slip);
            const double edges = std::abs(slip) / model_.interfaces[interface].length;
            if (!(edges <= slip_.value)) slip_.meet(edges, model_.mesh.corner(at.after == rigid_support ? at.before : at.after));
        }
    }
}

/// A support is rigid, and goes on straight where its last edge ends: what slides along it stays on it. Only where the next edge of the support turns away
/// does a point come to where the support is not what it feels.
void DeformationWatch::measure_supports() {
    struct Side {
        Index interface;
        Vec2 along;     // T
        double length;  // [m]
        std::array<Index, 2> end;  // vertices, along T
    };
    std::vector<Side> sides;
    std::map<Index, std::vector<std::size_t>> at_vertex;
    for (Index i = 0; i < static_cast<Index>(model_.interfaces.size()); ++i) {
        const Interface& interface = model_.interfaces[i];
        if (interface.triangle[0] != rigid_support && interface.triangle[1] != rigid_support) continue;
        Side side{.interface = i, .along = turned_left(interface.normal), .length = interface.length, .end = interface.vertex};
        if (side.along.dot(model_.mesh.vertices[side.end[1]] - model_.mesh.vertices[side.end[0]]) < 0) std::swap(side.end[0], side.end[1]);
        for (const Index v : side.end) at_vertex[v].push_back(sides.size());
        sides.push_back(side);
    }
    // the reach of a side is the length and the reach of the one that goes on straight; where a run ends it is all, where it turns away none
    const auto reaches = [&](int direction) {
        constexpr double endless = std::numeric_limits<double>::infinity(), unknown = -1;
        std::vector<double> reach(sides.size(), unknown);
        for (std::size_t s = 0; s < sides.size(); ++s) {
            std::vector<std::size_t> run;  // from here on, all but its last of unknown reach
            for (std::size_t at = s; reach[at] == unknown; at = run.back()) {
                run.push_back(at);
                reach[at] = endless;  // also of a ring
                const auto& here = at_vertex[sides[at].end[direction]];
                const auto next = std::find_if(here.begin(), here.end(), [&](std::size_t other) { return other != at; });
                if (next == here.end()) break;
                const Vec2 &along = sides[at].along, &further = sides[*next].along;
                if (along.dot(further) <= 0 || std::abs(cross(along, further)) > straight) {
                    reach[at] = 0;
                    break;
                }
                run.push_back(*next);
            }
            for (std::size_t i = run.size(); i-- > 1;)
                if (run[i] != run[i - 1]) reach[run[i - 1]] = sides[run[i]].length + reach[run[i]];
        }
        return reach;
    };
    const std::vector<double> backward = reaches(0), forward = reaches(1);
    for (std::size_t s = 0; s < sides.size(); ++s) straight_.push_back({.interface = sides[s].interface, .backward = backward[s], .forward = forward[s]});
}

double DeformationWatch::beyond_support(Index interface, double slip) const {
    const auto found = std::lower_bound(straight_.begin(), straight_.end(), interface, [](const StraightReach& side, Index i) { return side.interface < i; });
    return std::max(0.0, std::abs(slip) - (slip > 0 ? found->forward : found->backward));
}

/// Sheets that lie over each other do so at their borders first, where one crosses the other: only where triangles there do are all compared.
void DeformationWatch::look_for_overlap(const State& state) {
    const Mesh& mesh = model_.mesh;
    std::vector<Vec2> corner;
    std::vector<Index> vertex;
    const auto add = [&](Index t) {
        for (Index k = 0; k < 3; ++k) {
            vertex.push_back(mesh.triangles[t][k]);
            corner.push_back(mesh.corner(t, k) + state.displacement[state.node_of_corner[mesh.corners_per_triangle() * t + k]]);
        }
    };
    std::vector<std::uint8_t> is_at_border(mesh.n_triangles(), 0);
    for (const BoundaryEdge& edge : mesh.boundary_edges) is_at_border[edge.triangle] = 1;
    for (const Index f : state.split_fans)
        for (Index i = 0; i < model_.fans[f].n_corners; ++i) is_at_border[mesh.triangle_of(model_.fan_corners[model_.fans[f].first_corner + i])] = 1;
    for (Index t = 0; t < mesh.n_triangles(); ++t)
        if (is_at_border[t]) add(t);
    CoveredTwice found = find_covered_twice(corner, vertex);
    if (found.area > little * triangle_area_) {
        for (Index t = 0; t < mesh.n_triangles(); ++t)
            if (!is_at_border[t]) add(t);
        found = find_covered_twice(corner, vertex);
    }
    // what is small there is measured by the triangles that lie there, where those are smaller than the mean
    if (found.area > 0) triangle_area_ = std::min(body_area_ / mesh.n_triangles(), found.area / found.triangles);
    overlap_.meet(found.area, found.place);
}

}  // namespace knap
