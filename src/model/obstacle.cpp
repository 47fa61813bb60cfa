#include "model/obstacle.hpp"

#include <algorithm>
#include <numbers>

namespace knap {
namespace {

const Vec2& next(const std::vector<Vec2>& points, std::size_t i) { return points[(i + 1) % points.size()]; }

/// Distance of p to a counterclockwise convex polygon, both in the frame of the polygon.
SurfaceDistance distance_to_polygon(const std::vector<Vec2>& points, const Vec2& p) {
    SurfaceDistance inside{-infinity, Vec2::Zero()}, nearest{infinity, Vec2::Zero()};
    for (std::size_t i = 0; i < points.size(); ++i) {
        const PlacedEdge side = placed_edge(points[i], next(points, i));
        const double height = side.gap(p), along = nearest_parameter(side.start, side.end, p);
        if (height > inside.gap) inside = {height, side.outward};
        const Vec2 away = p - (side.start + along * (side.end - side.start));
        const double gap = away.norm();
        // next to an edge its normal is exact; beyond its ends the vertex is nearest
        if (gap < nearest.gap) nearest = {gap, along > 0 && along < 1 ? side.outward : Vec2(away / gap)};
    }
    return inside.gap <= 0 ? inside : nearest;
}

}  // namespace

double Outline::area() const {
    if (kind == Kind::disc) return std::numbers::pi * radius * radius;
    return kind == Kind::polygon ? signed_area(points) : 0;
}

double Outline::second_moment() const {
    if (kind == Kind::disc) return 0.5 * area() * radius * radius;
    double sum = 0;  // of the triangles from the origin: area/6 (a.a + a.b + b.b)
    for (std::size_t i = 0; i < points.size() && kind == Kind::polygon; ++i) {
        const Vec2 &a = points[i], &b = next(points, i);
        sum += cross(a, b) / 12 * (a.dot(a) + a.dot(b) + b.dot(b));
    }
    return sum;
}

double Outline::half_width() const {
    if (kind == Kind::disc) return radius;
    if (kind == Kind::polyline) return infinity;
    double smallest = infinity;  // at a side
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec2 inward = turned_left((next(points, i) - points[i]).normalized());
        double width = 0;
        for (const Vec2& p : points) width = std::max(width, inward.dot(p - points[i]));
        smallest = std::min(smallest, 0.5 * width);
    }
    return smallest;
}

ObstacleSurface::ObstacleSurface(const Outline& outline, const Pose& pose)
    : outline_(&outline),
      position_(pose.position),
      rotation_(Rotation::by(pose.angle)),
      line_(outline.is_joined() ? Frame{Vec2::Zero(), Rotation::by(0)} : Frame{position_, rotation_}),
      normal_(rotation_.turned(outline.normal)),
      radius_(outline.radius) {
    if (outline.kind != Outline::Kind::polygon) return;
    low_ = high_ = outline.points.front();
    for (const Vec2& p : outline.points)
        radius_ = std::max(radius_, p.norm()), low_ = low_.cwiseMin(p), high_ = high_.cwiseMax(p);
}

SurfaceDistance ObstacleSurface::distance_to(const Vec2& point) const {
    const Vec2 away = point - position_;
    if (outline_->line) {
        Vec2 normal;
        const double gap = outline_->line->distance_to(line_.from(point), normal);
        return {gap, line_.rotation.turned(normal)};
    }
    switch (outline_->kind) {
        case Outline::Kind::half_plane: return {normal_.dot(away), normal_};
        case Outline::Kind::disc: {
            const double r = away.norm();
            return {r - outline_->radius, r > 0 ? Vec2(away / r) : Vec2(0, 1)};
        }
        case Outline::Kind::polygon: {
            const SurfaceDistance own = distance_to_polygon(outline_->points, rotation_.turned_back(away));
            return {own.gap, rotation_.turned(own.normal)};
        }
        case Outline::Kind::polyline: break;
    }
    return {0, Vec2(0, 1)};
}

SurfaceDistance ObstacleSurface::distance_to(const Vec2& point, const Vec2& motion, double tolerance) const {
    if (outline_->kind != Outline::Kind::polygon) return distance_to(point);
    const std::vector<Vec2>& points = outline_->points;
    const Vec2 p = rotation_.turned_back(point - position_), moved = rotation_.turned_back(motion);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const PlacedEdge before = placed_edge(points[(i + points.size() - 1) % points.size()], points[i]),
                         after = placed_edge(points[i], next(points, i));
        const AtCorner at = at_corner(before, after, p, moved, tolerance);
        if (at == AtCorner::none) continue;
        const Vec2& normal = (at == AtCorner::first ? before : after).outward;
        return {normal.dot(p - points[i]), rotation_.turned(normal)};
    }
    return distance_to(point);
}

Vec2 ObstacleSurface::furthest(const Vec2& direction) const {
    if (outline_->kind == Outline::Kind::disc) return position_ + outline_->radius * direction;
    Vec2 best = place(0);
    for (std::size_t i = 1; i < outline_->points.size(); ++i)
        if (const Vec2 other = place(i); direction.dot(other - best) > 0) best = other;
    return best;
}

bool ObstacleSurface::may_reach(const Vec2& point, double reach) const {
    const Vec2 away = point - position_;
    if (outline_->kind == Outline::Kind::half_plane) return normal_.dot(away) <= reach;
    if (outline_->kind == Outline::Kind::polyline) return outline_->line->may_reach(line_.from(point), reach);
    if (away.squaredNorm() > (radius_ + reach) * (radius_ + reach)) return false;
    if (outline_->kind != Outline::Kind::polygon) return true;
    const Vec2 p = rotation_.turned_back(away);
    return ((p - high_).array() <= reach).all() && ((low_ - p).array() <= reach).all();
}

const ContactLaw& Obstacle::law_at(const Vec2& arm, double angle) const {
    if (ranges.empty()) return contact;
    const double x = start.position.x() + Rotation::by(start.angle - angle).turned(arm).x();
    const auto after = std::ranges::upper_bound(ranges, x, {}, &SurfaceRange::from);
    return after == ranges.begin() || x > std::prev(after)->to ? contact : std::prev(after)->law;
}

double Obstacle::largest_restitution() const {
    double largest = contact.restitution;
    for (const SurfaceRange& range : ranges) largest = std::max(largest, range.law.restitution);
    return largest;
}

ObstacleState initial_state(const Obstacle& obstacle) {
    ObstacleState state{.pose = obstacle.start};
    for (int k = 0; k < 3; ++k) {
        const Drive& drive = obstacle.drive[k];
        if (drive.kind == Drive::Kind::free) state.velocity[k] = obstacle.initial_velocity[k];
        if (drive.kind == Drive::Kind::velocity) state.velocity[k] = drive.value * drive.history(0);
    }
    return state;
}

void move(const Obstacle& obstacle, const Vec3& change, ObstacleState& state) {
    state.moved += change;
    state.pose.position = obstacle.start.position + state.moved.head<2>();
    state.pose.angle = obstacle.start.angle + state.moved.z();
}

Vec3 force_at(const Obstacle& obstacle, double t) {
    Vec3 force = Vec3::Zero();
    for (const ObstacleForce& each : obstacle.forces) force += each.history(t) * each.value;
    for (int k = 0; k < 3; ++k)
        if (!obstacle.is_free(k)) force[k] = 0;
    return force;
}

double kinetic_energy(const Obstacle& obstacle, const Vec3& velocity) {
    double energy = 0;
    for (int k = 0; k < 3; ++k)
        if (obstacle.is_free(k)) energy += 0.5 * obstacle.inertia_of(k) * velocity[k] * velocity[k];
    return energy;
}

}  // namespace knap
