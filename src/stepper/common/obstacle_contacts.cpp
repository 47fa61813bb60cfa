#include "stepper/common/obstacle_contacts.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace knap {
namespace {

constexpr double near = 0.02;          // of the size of a corner: what is nearer is looked at, at any speed
constexpr double reach_in_steps = 4;   // ways of a step at the speeds of its begin
constexpr double beside_a_corner = 1e-3, as_near = 0.05;  // of an edge: there its ends are met instead
constexpr double touching = 1e-12;     // of the coordinates that a gap is a difference of: rounding

}  // namespace

ObstacleContacts::ObstacleContacts(const Model& model) : model_(model) {
    if (model.obstacles.empty()) return;
    for (Index f = 0; f < static_cast<Index>(model.fans.size()); ++f) {
        const Fan& fan = model.fans[f];
        const bool inside = fan.vertex < 0 && (fan.n_corners == 2 || model.mesh.place_in_triangle(model.fan_corners[fan.first_corner]) == 6);
        if (fan.closed || inside) continue;
        boundary_.push_back({.fan = f, .corner = model.fan_corners[fan.first_corner], .place = 0});
        if (fan.n_corners > 1) boundary_.push_back({.fan = f, .corner = model.fan_corners[fan.first_corner + fan.n_corners - 1], .place = 1});
    }
    corner_size_.resize(model.mesh.n_corners());
    for (Index c = 0; c < model.mesh.n_corners(); ++c) {
        corner_size_[c] = std::numeric_limits<double>::infinity();
        for (Index k = 0; k < model.mesh.corners_per_triangle(); ++k)
            if (k != model.mesh.place_in_triangle(c))
                corner_size_[c] = std::min(corner_size_[c], (model.mesh.corner(model.mesh.triangle_of(c), k) - model.mesh.corner(c)).norm());
    }
}

void ObstacleContacts::list_candidates(const State& begin) {
    candidates_ = boundary_;
    for (const Index f : begin.split_fans) add_pieces(f, begin);
    std::ranges::sort(candidates_, {}, [](const Candidate& c) { return (std::int64_t(c.fan) << 32) + c.place; });
}

/// Round a fan that came apart every piece needs a contact of its own: the corner behind each point whose sides ever moved.
void ObstacleContacts::add_pieces(Index f, const State& begin) {
    const Fan& fan = model_.fans[f];
    const Index first = model_.fan_corners[fan.first_corner], last = model_.fan_corners[fan.first_corner + fan.n_corners - 1];
    const PointState* state = begin.points.data() + begin.first_point[begin.split_rank[f]];
    for (Index i = 0; i < fan.n_points; ++i) {
        const FanPoint& point = model_.fan_points[fan.first_point + i];
        if (point.before == rigid_support || point.after == rigid_support) continue;
        if (!fan.closed && (point.after == first || point.after == last)) continue;  // the ends of a chain have theirs
        const bool together = begin.displacement[begin.node_of_corner[point.after]] == begin.displacement[begin.node_of_corner[point.before]];
        const bool intact = !point.cracked && (state[i].cohesion == 1 || !model_.laws[point.law].breakable());
        if (!(intact && together)) candidates_.push_back({.fan = f, .corner = point.after, .place = i + 2});
    }
}

void ObstacleContacts::find(const State& begin, double h, const std::vector<Vec3>& end_velocity, const std::vector<Vec2>& corner_force) {
    contacts_.clear();
    n_at_corners_ = 0;
    if (model_.obstacles.empty()) return;
    list_candidates(begin);
    for (const Candidate& candidate : candidates_) {
        const Index c = candidate.corner, node = begin.node_of_corner[c];
        const Vec2 x = model_.mesh.corner(c) + begin.displacement[node];
        const double speed = begin.velocity[node].norm() + (corner_force.empty() ? 0 : h / model_.corner_mass[c] * corner_force[c].norm());
        for (Index o = 0; o < static_cast<Index>(model_.obstacles.size()); ++o) {
            const Outline& outline = model_.obstacles[o].outline;
            const ObstacleState& state = begin.obstacles[o];
            const Vec2 arm = x - state.pose.position;
            const double obstacle_speed = velocity_at(state.velocity, arm).norm() + velocity_at(end_velocity[o], arm).norm();
            const double reach = near * corner_size_[c] + reach_in_steps * h * (speed + obstacle_speed);
            if (!may_reach(outline, state.pose, x, reach)) continue;
            SurfaceDistance distance = distance_to(outline, state.pose, x);
            if (distance.gap > reach) continue;
            if (std::abs(distance.gap) <= touching * (x.norm() + state.pose.position.norm())) distance.gap = 0;
            contacts_.push_back({.corner = c, .fan = candidate.fan, .obstacle = o, .arm = arm, .normal = distance.normal, .gap = distance.gap});
            if (outline.kind == Outline::Kind::disc) continue;
            // what turns is taken half way through the step: of second order, so that a point that rides or slides on it does not sink in
            const Pose half{.angle = 0.5 * h * end_velocity[o].z()};
            contacts_.back().normal = half.turned(distance.normal);
            contacts_.back().arm += 0.5 * h * (begin.velocity[node] - end_velocity[o].head<2>());
        }
    }
    n_at_corners_ = contacts_.size();
    find_on_edges(begin, h, end_velocity);
}

void ObstacleContacts::find_on_edges(const State& begin, double h, const std::vector<Vec3>& end_velocity) {
    for (Index o = 0; o < static_cast<Index>(model_.obstacles.size()); ++o) {
        if (model_.obstacles[o].outline.kind != Outline::Kind::polygon) continue;
        for (const BoundaryEdge& edge : model_.mesh.boundary_edges) meet_edge(edge.triangle, edge.side, o, begin, h, end_velocity[o]);
    }
}

void ObstacleContacts::meet_edge(Index triangle, Index side, Index o, const State& begin, double h, const Vec3& end_velocity) {
    const Outline& outline = model_.obstacles[o].outline;
    const ObstacleState& state = begin.obstacles[o];
    const auto place = [&](Index c) -> Vec2 { return model_.mesh.corner(c) + begin.displacement[begin.node_of_corner[c]]; };
    const auto meet = [&](Index a, Index b) {
        const Vec2 x_a = place(a), along = place(b) - x_a;
        const double length = along.norm();
        if (!(length > 0) || !may_reach(outline, state.pose, x_a, 2 * length)) return;
        const Vec2 outward = -turned_left(along) / length;  // of the body: it lies to the left of a to b
        const Vec2 v_a = begin.velocity[begin.node_of_corner[a]], v_b = begin.velocity[begin.node_of_corner[b]];
        for (std::size_t i = 0; i < outline.points.size(); ++i) {
            const Vec2 arm = state.pose.turned(outline.points[i]), x = state.pose.position + arm;
            const double share = along.dot(x - x_a) / (length * length), speed = v_a.norm() + v_b.norm() + velocity_at(end_velocity, arm).norm();
            double gap = outward.dot(x - x_a);
            const double reach = near * length + reach_in_steps * h * (speed + velocity_at(state.velocity, arm).norm());
            if (share <= beside_a_corner || share >= 1 - beside_a_corner || gap > reach || gap < -near * length) continue;
            // it is the corner that comes nearest, not an edge of the obstacle beside it
            const std::size_t n = outline.points.size();
            const auto to = [&](std::size_t j) -> Vec2 { return state.pose.turned(outline.points[j % n] - outline.points[i]); };
            if (outward.dot(to(i + 1)) < 0 || outward.dot(to(i + n - 1)) < 0) continue;
            // where an end of the edge is as near, it is what is met
            const auto is_as_near = [&](Index c) { return distance_to(outline, state.pose, place(c)).gap <= gap + as_near * length; };
            if (is_as_near(a) || is_as_near(b)) continue;
            if (std::abs(gap) <= touching * (x.norm() + state.pose.position.norm())) gap = 0;
            contacts_.push_back({.corner = a,
                                 .fan = model_.fan_of_corner[a],
                                 .obstacle = o,
                                 .arm = arm + 0.5 * h * end_velocity.z() * turned_left(arm),
                                 .normal = -outward,
                                 .gap = gap,
                                 .beside = b,
                                 .fan_beside = model_.fan_of_corner[b],
                                 .share = share});
        }
    };
    const Index n = model_.mesh.corners_per_triangle(), first = n * triangle + side, last = n * triangle + (side + 1) % 3;
    if (model_.mesh.order == 1) return meet(first, last);
    const Index middle = n * triangle + 3 + side;
    meet(first, middle);
    meet(middle, last);
}

bool ObstacleContacts::find_free(std::vector<std::uint8_t>& free) const {
    free.assign(model_.obstacles.size(), 0);
    for (const ObstacleContact& contact : contacts_) free[contact.obstacle] = model_.obstacles[contact.obstacle].is_free();
    return std::ranges::find(free, 1) != free.end();
}

std::span<const ObstacleContact> ObstacleContacts::of_fan(Index fan) const {
    struct ByFan {
        bool operator()(const ObstacleContact& contact, Index f) const { return contact.fan < f; }
        bool operator()(Index f, const ObstacleContact& contact) const { return f < contact.fan; }
    };
    if (contacts_.empty()) return {};
    const auto [first, last] = std::equal_range(contacts_.begin(), contacts_.begin() + static_cast<std::ptrdiff_t>(n_at_corners_), fan, ByFan{});
    return {first, last};
}

}  // namespace knap
