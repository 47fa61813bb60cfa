#include "stepper/common/obstacle_contacts.hpp"

namespace knap {
namespace {

constexpr double near = 0.02;  // [-] of the size of a corner: nearer corners are candidates at any speed
constexpr double obstacle_reach_in_steps = 4;  // distances covered in a step at the speeds of its start
constexpr double touching_corner = 1e-3;       // [-] of the size of a corner: as a rounding error of the geometry
constexpr double end_of_edge = 1e-3;           // [-] of an edge: there its end is in contact instead
constexpr double almost_as_near = 0.05;        // [-] of an edge: likewise where an end is about as near to the obstacle
constexpr double rounded_up = 1 + 1e-12;       // more than the rounding of a bound
constexpr double gap_rounding = 1e-12;         // [-] of the coordinates whose difference is a gap

/// The gap at x, or zero where it is rounding.
double cleared(double gap, const Vec2& x, const ObstacleSurface& surface) {
    return std::abs(gap) <= gap_rounding * (x.norm() + surface.position().norm()) ? 0 : gap;
}

}  // namespace

ObstacleContacts::ObstacleContacts(const Model& model) : model_(model) {
    if (model.obstacles.empty()) return;
    const Mesh& mesh = model.mesh;
    for (Index f = 0; f < static_cast<Index>(model.fans.size()); ++f) {
        const Fan& fan = model.fans[f];
        const auto corners = model.corners(fan);
        const bool inside = fan.vertex < 0 && (fan.n_corners == 2 || mesh.place_in_triangle(corners[0]) == 6);
        if (fan.closed || inside || model.has_vanished(mesh.triangle_of(corners[0]))) continue;
        boundary_.push_back({.fan = f, .corner = corners.front(), .place = 0});
        if (fan.n_corners > 1) boundary_.push_back({.fan = f, .corner = corners.back(), .place = 1});
    }
    corner_size_.resize(mesh.n_corners(), infinity);
    for (Index c = 0; c < mesh.n_corners(); ++c)
        for (Index k = 0; k < mesh.corners_per_triangle(); ++k)
            if (k != mesh.place_in_triangle(c))
                corner_size_[c] =
                    std::min(corner_size_[c], (mesh.corner(mesh.triangle_of(c), k) - mesh.corner(c)).norm());
}

/// Every piece of a split fan needs a contact of its own: the corner after each point whose sides ever moved.
void ObstacleContacts::add_pieces(Index f, const State& begin) {
    const Fan& fan = model_.fans[f];
    const auto corners = model_.corners(fan);
    const PointState* state = begin.points.data() + begin.first_point[begin.split_rank[f]];
    for (Index i = 0; i < fan.n_points; ++i) {
        const FanPoint& point = model_.points(fan)[i];
        if (point.on_support()) continue;
        if (!fan.closed && (point.after == corners.front() || point.after == corners.back())) continue;  // in boundary_
        const bool together = begin.displacement_of(point.after) == begin.displacement_of(point.before);
        const bool intact = unbreakable(model_, point) || (!point.cracked && state[i].cohesion == 1);
        if (!(intact && together)) candidates_.push_back({.fan = f, .corner = point.after, .place = i + 2});
    }
}

void ObstacleContacts::find(const State& begin, double h, const std::vector<Vec3>& end_velocity,
                            const std::vector<Vec2>& corner_force) {
    contacts_.clear();
    n_at_corners_ = 0;
    if (model_.obstacles.empty()) return;
    surfaces_.clear();
    for (std::size_t o = 0; o < model_.obstacles.size(); ++o)
        surfaces_.emplace_back(model_.obstacles[o].outline, begin.obstacles[o].pose);
    at_most_.clear();
    for (std::size_t o = 0; o < model_.obstacles.size(); ++o) {
        const Vec3 &start = begin.obstacles[o].velocity, &end = end_velocity[o];
        at_most_.push_back({.speed = start.head<2>().lpNorm<1>() + end.head<2>().lpNorm<1>(),
                            .spin = std::abs(start.z()) + std::abs(end.z())});
    }
    candidates_ = boundary_;
    for (const Index f : begin.split_fans) add_pieces(f, begin);
    if (candidates_.size() > boundary_.size())
        std::ranges::sort(candidates_, {}, [](const Candidate& c) { return (std::int64_t(c.fan) << 32) + c.place; });
    for (const Candidate& candidate : candidates_) find_at_corner(candidate, begin, h, end_velocity, corner_force);
    n_at_corners_ = contacts_.size();
    const Mesh& mesh = model_.mesh;
    for (Index o = 0; o < static_cast<Index>(model_.obstacles.size()); ++o)
        for (const auto& [triangle, side, boundary] : mesh.boundary_edges) {
            if (model_.obstacles[o].outline.kind != Outline::Kind::polygon) break;
            const Index first = mesh.corners_per_triangle() * triangle, a = first + side, b = first + (side + 1) % 3,
                        middle = mesh.order == 1 ? b : first + 3 + side;
            find_on_edge(a, middle, o, begin, h, end_velocity[o]);
            if (middle != b) find_on_edge(middle, b, o, begin, h, end_velocity[o]);
        }
}

void ObstacleContacts::find_at_corner(const Candidate& at, const State& begin, double h,
                                      const std::vector<Vec3>& end_velocity, const std::vector<Vec2>& corner_force) {
    const Index c = at.corner, node = begin.node_of_corner[c];
    const Vec2 x = model_.mesh.corner(c) + begin.displacement[node];
    const Vec2& v = begin.velocity[node];
    const double kick = corner_force.empty() ? 0 : h / model_.corner_mass[c];
    const Vec2 force = corner_force.empty() ? Vec2::Zero() : corner_force[c];
    const double nearest = near * corner_size_[c], in_steps = obstacle_reach_in_steps * h,
                 most = v.lpNorm<1>() + kick * force.lpNorm<1>();  // [m/s] at least its speed
    for (Index o = 0; o < static_cast<Index>(model_.obstacles.size()); ++o) {
        const ObstacleSurface& surface = surfaces_[o];
        const Vec2 arm = x - surface.position();
        // nearly all corners are far, so at first without roots
        const double most_of_obstacle = at_most_[o].speed + at_most_[o].spin * arm.lpNorm<1>();
        if (!surface.may_reach(x, rounded_up * (nearest + in_steps * (most + most_of_obstacle)))) continue;
        const double speed = v.norm() + kick * force.norm();
        const double obstacle_speed =
            velocity_at(begin.obstacles[o].velocity, arm).norm() + velocity_at(end_velocity[o], arm).norm();
        const double reach = near * corner_size_[c] + obstacle_reach_in_steps * h * (speed + obstacle_speed);
        if (!surface.may_reach(x, reach)) continue;
        const Vec2 motion = h * (begin.velocity[node] - velocity_at(end_velocity[o], arm));
        const SurfaceDistance distance = surface.distance_to(x, motion, touching_corner * corner_size_[c]);
        if (distance.gap > reach) continue;
        contacts_.push_back({.corner = c,
                             .fan = at.fan,
                             .obstacle = o,
                             .arm = arm,
                             .normal = distance.normal,
                             .gap = cleared(distance.gap, x, surface)});
        if (surface.outline().kind == Outline::Kind::disc) continue;
        // a surface that turns is taken at the middle of the step: of second order, so that a corner that rides or
        // slides on it does not sink in
        contacts_.back().normal = Rotation::by(0.5 * h * end_velocity[o].z()).turned(distance.normal);
        contacts_.back().arm += 0.5 * h * (begin.velocity[node] - end_velocity[o].head<2>());
    }
}

/// Corners of the polygon against the inside of the edge a-b.
void ObstacleContacts::find_on_edge(Index a, Index b, Index o, const State& begin, double h, const Vec3& end_velocity) {
    const ObstacleSurface& surface = surfaces_[o];
    const std::vector<Vec2>& points = surface.outline().points;
    const auto place = [&](Index c) -> Vec2 { return model_.mesh.corner(c) + begin.displacement_of(c); };
    const Vec2 x_a = place(a), along = place(b) - x_a;
    const double length = along.norm();
    if (!(length > 0) || !surface.may_reach(x_a, 2 * length)) return;
    const Vec2 outward = -turned_left(along) / length;  // of the body, which lies to the left of a to b
    const Vec2 v_a = begin.velocity[begin.node_of_corner[a]], v_b = begin.velocity[begin.node_of_corner[b]];
    const std::size_t n = points.size();
    for (std::size_t i = 0; i < n; ++i) {
        const Vec2 arm = surface.rotation().turned(points[i]), x = surface.position() + arm;
        const double share = along.dot(x - x_a) / (length * length), gap = outward.dot(x - x_a);
        const double speed = v_a.norm() + v_b.norm() + velocity_at(end_velocity, arm).norm();
        const double reach = near * length + obstacle_reach_in_steps * h *
                                                 (speed + velocity_at(begin.obstacles[o].velocity, arm).norm());
        if (share <= end_of_edge || share >= 1 - end_of_edge || gap > reach || gap < -near * length) continue;
        // the corner is nearest, not an adjacent edge of the obstacle
        const auto falls_towards_body = [&](std::size_t j) {
            return outward.dot(surface.rotation().turned(points[j % n] - points[i])) < 0;
        };
        if (falls_towards_body(i + 1) || falls_towards_body(i + n - 1)) continue;
        const auto is_as_near = [&](Index c) {
            return surface.distance_to(place(c)).gap <= gap + almost_as_near * length;
        };
        if (is_as_near(a) || is_as_near(b)) continue;
        contacts_.push_back({.corner = a,
                             .fan = model_.fan_of_corner[a],
                             .obstacle = o,
                             .arm = arm + 0.5 * h * end_velocity.z() * turned_left(arm),
                             .normal = -outward,
                             .gap = cleared(gap, x, surface),
                             .second_corner = b,
                             .second_fan = model_.fan_of_corner[b],
                             .share = share});
    }
}

bool ObstacleContacts::find_free(std::vector<std::uint8_t>& free) const {
    free.assign(model_.obstacles.size(), 0);
    for (const ObstacleContact& contact : contacts_)
        free[contact.obstacle] = model_.obstacles[contact.obstacle].is_free();
    return std::ranges::find(free, 1) != free.end();
}

}  // namespace knap
