#include "analysis/deformation_watch.hpp"

#include "mesh/overlap.hpp"
#include "model/body_in_obstacles.hpp"
#include "model/make_ground.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr double negligible_overlap = 1e-3;  // of the area of a triangle: faces that slid a little

struct Gradient {
    double xx, xy, yx, yy;  // u_x,x  u_x,y  u_y,x  u_y,y
};

/// Gradient of the linear field through the displacements of the three vertices.
Gradient displacement_gradient(const Mesh& mesh, const State& state, Index t) {
    const auto& vertex = mesh.triangles[t];
    const auto displacement = [&](Index k) -> const Vec2& {
        return state.displacement[state.node_of_corner[mesh.corners_per_triangle() * t + k]];
    };
    const Vec2 a = mesh.vertices[vertex[1]] - mesh.vertices[vertex[0]],
               b = mesh.vertices[vertex[2]] - mesh.vertices[vertex[0]], u_a = displacement(1) - displacement(0),
               u_b = displacement(2) - displacement(0);
    const double inverse = 1 / cross(a, b);
    return {.xx = inverse * (u_a.x() * b.y() - u_b.x() * a.y()),
            .xy = inverse * (u_b.x() * a.x() - u_a.x() * b.x()),
            .yx = inverse * (u_a.y() * b.y() - u_b.y() * a.y()),
            .yy = inverse * (u_b.y() * a.x() - u_a.y() * b.x())};
}

/// The larger principal value of |E|, E = 1/2 (H + H' + H' H).
double largest_strain(const Gradient& g) {
    const double xx = g.xx + 0.5 * (g.xx * g.xx + g.yx * g.yx), yy = g.yy + 0.5 * (g.xy * g.xy + g.yy * g.yy),
                 xy = 0.5 * (g.xy + g.yx + g.xx * g.xy + g.yx * g.yy);
    return std::abs(0.5 * (xx + yy)) + std::hypot(0.5 * (xx - yy), xy);
}

bool on_support(const Interface& interface) {
    return interface.triangle[0] == rigid_support || interface.triangle[1] == rigid_support;
}

}  // namespace

DeformationWatch::DeformationWatch(const Model& model) : model_(model) {
    for (Index t = 0; t < model.mesh.n_triangles(); ++t) body_area_ += model.mesh.area(t);
    triangle_area_ = body_area_ / std::max<Index>(1, model.mesh.n_triangles());
    supports_ = obstacles_of_ground(model);
    obstacle_pairs_ = obstacles_that_may_meet(model.obstacles, supports_);
    renew();
}

/// A triangle passes half a turn where the sine of its angle changes its sign while its cosine is negative.
void DeformationWatch::count_turns(const State& state) {
    if (!model_.large_rotation) return;
    const bool first = turns_.empty();
    turns_.resize(model_.mesh.triangles.size());
    for (Index t = 0; t < model_.mesh.n_triangles(); ++t) {
        const Gradient g = displacement_gradient(model_.mesh, state, t);
        Turns& turns = turns_[t];
        const bool clockwise = g.yx < g.xy;
        if (clockwise != turns.clockwise && 2 + g.xx + g.yy < 0 && !first) turns.full += clockwise ? 1 : -1;
        turns.clockwise = clockwise;
    }
}

double DeformationWatch::turned(const State& state, Index triangle) const {
    const Gradient g = displacement_gradient(model_.mesh, state, triangle);
    return std::atan2(g.yx - g.xy, 2 + g.xx + g.yy) / degree + (turns_.empty() ? 0 : 360 * turns_[triangle].full);
}

void DeformationWatch::look_at_obstacles(const State& state) {
    const auto n = static_cast<Index>(model_.obstacles.size());
    const auto surface = [&](Index i) -> ObstacleSurface {
        if (i >= n) return {supports_[i - n].outline, {}};
        return {model_.obstacles[i].outline, state.obstacles[i].pose};
    };
    for (const auto& [i, j] : obstacle_pairs_) {
        const auto [gap, place] = gap_between(surface(i), surface(j));
        obstacle_overlap_.add(-gap, place);
    }
}

void DeformationWatch::look_into_obstacles(const State& state) {
    for_edges_in_obstacles(model_, &state, [&](const EdgeInObstacle& at) {
        obstacle_depth_.add(at.part(model_.obstacles[at.obstacle]), at.place);
    });
}

double DeformationWatch::obstacle_speed(const State& state) const {
    double largest = 0;
    for (const ObstacleState& obstacle : state.obstacles)
        largest = std::max(largest, obstacle.velocity.head<2>().norm() + reach_ * std::abs(obstacle.velocity.z()));
    return largest;
}

void DeformationWatch::renew() {
    const Model& model = model_;
    reach_ = 2 * bounding_box(model.mesh.vertices).diagonal();
    stiffest_ = 0;
    for (const Elastic& material : model.materials) stiffest_ = std::max(stiffest_, material.E);
    obstacle_path_ = infinity;
    for (const auto& [triangle, side, boundary] : model.mesh.boundary_edges)
        obstacle_path_ = std::min(obstacle_path_, 0.05 * model.mesh.side_vector(triangle, side).norm());
    for (const Obstacle& obstacle : model.obstacles)
        obstacle_path_ = std::min(obstacle_path_, 0.05 * obstacle.outline.half_width());
    double lowest = infinity;  // [m] height of a triangle
    for (Index t = 0; t < model.mesh.n_triangles(); ++t) {
        for (Index k = 0; k < 3; ++k)
            lowest = std::min(
                lowest, 2 * model.mesh.area(t) / (model.mesh.corner(t, (k + 1) % 3) - model.mesh.corner(t, k)).norm());
    }
    look_path_ = (model.large_rotation ? 0.1 : degree) * lowest;
    next_on_support_.clear();

    std::map<Index, std::vector<Index>> at_vertex;  // interfaces on supports
    for (Index i = 0; i < static_cast<Index>(model.interfaces.size()); ++i)
        if (on_support(model.interfaces[i]))
            for (const Index v : model.interfaces[i].vertex) at_vertex[v].push_back(i);
    for (const auto& [vertex, interfaces] : at_vertex)
        for (const Index i : interfaces) {
            const Interface& interface = model.interfaces[i];
            const Vec2 along = turned_left(interface.normal);
            const Index other = interface.vertex[interface.vertex[0] == vertex];
            const int direction = along.dot(model.mesh.vertices[vertex] - model.mesh.vertices[other]) > 0;
            const auto next = std::ranges::find_if(interfaces, [&](Index n) { return n != i; });
            Index& result = next_on_support_[i][direction];
            result = next == interfaces.end() ? Index(support_ends) : *next;
            if (result < 0) continue;
            const Vec2 further = turned_left(model.interfaces[*next].normal);
            if (along.dot(further) <= 0 || std::abs(cross(along, further)) > straight_on) result = support_turns;
        }
}

double DeformationWatch::search_path() const {
    return 0.1 * std::sqrt(body_area_ / std::max<Index>(1, model_.mesh.n_triangles()));
}

double DeformationWatch::rounding_energy(double path) const {
    if (model_.large_rotation) return 0;
    const double u = displacement_ + std::min(path, look_path_);  // since the last look
    return std::ldexp(std::sqrt(model_.mesh.n_triangles()) * stiffest_ * model_.thickness * u * u, 3 - 53);
}

void DeformationWatch::look_at(const State& state) {
    for (const Vec2& u : state.displacement) displacement_ = std::max(displacement_, u.norm());
    count_turns(state);
    // F = R U with R by the angle atan2(F_yx - F_xy, F_xx + F_yy); the angle is computed only where its tangent exceeds
    // that of the largest so far
    const Mesh& mesh = model_.mesh;
    const auto largest_tangent = [&] { return std::tan(std::min(rotation_.value, 89.9) * degree); };
    double tangent = largest_tangent();
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        const Gradient g = displacement_gradient(mesh, state, t);
        const double sine = std::abs(g.yx - g.xy), cosine = 2 + g.xx + g.yy;
        if (model_.large_rotation) strain_.add(largest_strain(g), mesh.centroid(t));
        if (!(sine <= tangent * cosine)) {
            rotation_.add(std::atan2(sine, cosine) / degree, mesh.centroid(t));
            tangent = largest_tangent();
        }
        const double area = std::abs(g.xx + g.yy + g.xx * g.yy - g.xy * g.yx);
        if (!(area <= area_change_.value)) area_change_.add(area, mesh.centroid(t));
    }

    for (std::size_t s = 0; s < state.split_fans.size(); ++s) {
        const Fan& fan = model_.fans[state.split_fans[s]];
        for (Index k = 0; k < fan.n_points; ++k) {
            if (!(state.points[state.first_point[s] + k].traction.x() > 0)) continue;
            const FanPoint& at = model_.fan_points[fan.first_point + k];
            double slip = state.opening_of(at, point_frame(model_, state, at)).y();
            const Index interface = model_.interface_of(at.point);
            if (on_support(model_.interfaces[interface]))
                slip = std::max(0.0, std::abs(slip) - straight_length(interface, slip > 0, std::abs(slip)));
            const Vec2 place = model_.mesh.corner(at.after == rigid_support ? at.before : at.after);
            slip_.add(std::abs(slip) / model_.interfaces[interface].length, place);
        }
    }
}

/// How far a point may slide on a rigid support before the next edge of the support turns away, so that the point
/// leaves the edge whose contact it feels [m]; infinite beyond `slip`, and where the support ends.
double DeformationWatch::straight_length(Index interface, int direction, double slip) const {
    const Index next = next_on_support_.at(interface)[direction];
    if (next == support_turns) return 0;
    if (next == support_ends || !(model_.interfaces[next].length < slip)) return infinity;
    const double length = model_.interfaces[next].length;
    return length + straight_length(next, direction, slip - length);
}

/// Sheets that overlap do so first at their borders, where one crosses the other: all triangles are compared only when
/// triangles there overlap.
void DeformationWatch::look_for_overlap(const State& state) {
    const Mesh& mesh = model_.mesh;
    std::vector<std::uint8_t> is_at_border(mesh.n_triangles(), 0);
    for (const BoundaryEdge& edge : mesh.boundary_edges) is_at_border[edge.triangle] = 1;
    for (const Index f : state.split_fans)
        for (Index i = 0; i < model_.fans[f].n_corners; ++i)
            is_at_border[mesh.triangle_of(model_.fan_corners[model_.fans[f].first_corner + i])] = 1;
    std::vector<Vec2> corner;
    std::vector<Index> vertex;
    const auto add_triangles = [&](bool at_border) {
        for (Index t = 0; t < mesh.n_triangles(); ++t)
            for (Index k = 0; k < 3 && (is_at_border[t] != 0) == at_border && !model_.has_vanished(t); ++k) {
                vertex.push_back(mesh.triangles[t][k]);
                corner.push_back(mesh.corner(t, k) +
                                 state.displacement[state.node_of_corner[mesh.corners_per_triangle() * t + k]]);
            }
        return find_covered_twice(corner, vertex);
    };
    CoveredTwice found = add_triangles(true);
    if (found.area > negligible_overlap * triangle_area_) found = add_triangles(false);
    // a small overlap is compared with the triangles that are there, where they are smaller than the mean
    if (found.area > 0) triangle_area_ = std::min(body_area_ / mesh.n_triangles(), found.area / found.triangles);
    overlap_.add(found.area, found.place);
}

}  // namespace knap
