#include "model/state.hpp"

#include <cmath>

namespace knap {

State initial_state(const Model& model) {
    State state;
    const std::size_t n_fans = model.fans.size();
    state.displacement.assign(n_fans, Vec2::Zero());
    state.velocity.resize(n_fans);
    state.node_of_corner = model.fan_of_corner;
    state.split_rank.assign(n_fans, -1);
    state.reaction.assign(model.prescribed.size(), Vec2::Zero());
    for (const Obstacle& obstacle : model.obstacles) state.obstacles.push_back(initial_state(obstacle));
    for (std::size_t f = 0; f < n_fans; ++f) state.velocity[f] = model.initial_velocity[model.fan_corners[model.fans[f].first_corner]];
    for (std::size_t f = 0; f < n_fans; ++f) {
        if (!model.fans[f].split_at_start) continue;
        split(model, static_cast<Index>(f), state);
        for (Index i = 0; i < model.fans[f].n_corners; ++i) {
            const Index corner = model.fan_corners[model.fans[f].first_corner + i];
            state.velocity[state.node_of_corner[corner]] = model.initial_velocity[corner];
        }
    }
    return state;
}

void split(const Model& model, Index f, State& state) {
    const Fan& fan = model.fans[f];
    for (Index i = 1; i < fan.n_corners; ++i) {
        state.node_of_corner[model.fan_corners[fan.first_corner + i]] = static_cast<Index>(state.displacement.size());
        state.displacement.push_back(Vec2(state.displacement[f]));
        state.velocity.push_back(Vec2(state.velocity[f]));
        if (!state.rate.empty()) state.rate.push_back(Vec2(state.rate[f]));
    }
    state.split_rank[f] = static_cast<Index>(state.split_fans.size());
    state.split_fans.push_back(f);
    state.first_point.push_back(static_cast<Index>(state.points.size()));
    for (Index i = 0; i < fan.n_points; ++i) {
        const FanPoint& point = model.fan_points[fan.first_point + i];
        const bool cohesive = !point.cracked && model.laws[point.law].sigma_c > 0;
        state.points.push_back({.cohesion = cohesive ? 1.0 : 0.0, .traction = Vec2::Zero()});
    }
}

namespace {

Vec2 displacement_of(const State& state, Index corner) {
    return corner == ground ? Vec2::Zero() : state.displacement[state.node_of_corner[corner]];
}

/// The remembered state of a point, or null in a fan in one piece.
const PointState* remembered(const Model& model, const State& state, Index point) {
    const Index in_fans = model.fan_point_of[point];
    const FanPoint& at = model.fan_points[in_fans];
    const Index fan = model.fan_of_corner[at.after == ground ? at.before : at.after];
    const Index rank = state.split_rank[fan];
    if (rank < 0) return nullptr;
    return &state.points[state.first_point[rank] + in_fans - model.fans[fan].first_point];
}

}  // namespace

Vec2 opening(const Model& model, const State& state, Index point) {
    // the frame of a fan point differs from its interface's at most by a turn of both axes and both sides: same components
    const FanPoint& at = model.fan_points[model.fan_point_of[point]];
    const Vec2 jump = displacement_of(state, at.after) - displacement_of(state, at.before);
    return {at.gap + at.normal.dot(jump), turned_left(at.normal).dot(jump)};
}

double cohesion(const Model& model, const State& state, Index point) {
    const PointState* known = remembered(model, state, point);
    return known ? known->cohesion : 1;
}

Vec2 traction(const Model& model, const State& state, Index point) {
    if (const PointState* known = remembered(model, state, point)) return known->traction;
    const Interface& edge = model.interfaces[point / 2];
    const Eigen::Vector3d mean = 0.5 * (stress(model, state, edge.triangle[0]) + stress(model, state, edge.triangle[1]));
    const Vec2 n = edge.normal, t = turned_left(n);
    const Vec2 on_a(mean[0] * n.x() + mean[2] * n.y(), mean[2] * n.x() + mean[1] * n.y());  // sigma N acts on A; the reaction on B
    return {-on_a.dot(n), -on_a.dot(t)};
}

Eigen::Vector3d stress(const Model& model, const State& state, Index t) {
    const Mesh& mesh = model.mesh;
    const double twice_area = 2 * mesh.area(t);
    Eigen::Vector3d strain = Eigen::Vector3d::Zero();
    for (Index k = 0; k < 3; ++k) {
        const Vec2 gradient = turned_left(mesh.corner(t, (k + 2) % 3) - mesh.corner(t, (k + 1) % 3)) / twice_area;
        const Vec2 u = displacement_of(state, 3 * t + k);
        strain += Eigen::Vector3d(gradient.x() * u.x(), gradient.y() * u.y(), gradient.y() * u.x() + gradient.x() * u.y());
    }
    return model.materials[mesh.region[t]].stiffness(model.plane) * strain;
}

}  // namespace knap
