#include "model/outline.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace knap {
namespace {

const Vec2& next(const std::vector<Vec2>& points, std::size_t i) { return points[(i + 1) % points.size()]; }

/// Of a counterclockwise convex polygon, both in its frame.
SurfaceDistance distance_to_polygon(const std::vector<Vec2>& points, const Vec2& p) {
    // inside: the nearest edge; outside: the nearest point of all edges
    SurfaceDistance inside{-std::numeric_limits<double>::infinity(), Vec2::Zero()};
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec2 outward = -turned_left((next(points, i) - points[i]).normalized());
        const double gap = outward.dot(p - points[i]);
        if (gap > inside.gap) inside = {gap, outward};
    }
    if (inside.gap <= 0) return inside;
    SurfaceDistance nearest{std::numeric_limits<double>::infinity(), Vec2::Zero()};
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double along = nearest_parameter(points[i], next(points, i), p);
        const Vec2 away = p - (points[i] + along * (next(points, i) - points[i]));
        const double gap = away.norm();
        if (gap >= nearest.gap) continue;
        // next to an edge its normal is exact; beyond its ends the vertex is nearest
        const Vec2 outward = -turned_left((next(points, i) - points[i]).normalized());
        nearest = {gap, along > 0 && along < 1 ? outward : Vec2(away / gap)};
    }
    return nearest.normal.isZero(0) ? inside : nearest;
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

SurfaceDistance distance_to(const Outline& outline, const Pose& pose, const Vec2& point) {
    const Vec2 away = point - pose.position;
    switch (outline.kind) {
        case Outline::Kind::half_plane: {
            const Vec2 normal = pose.turned(outline.normal);
            return {normal.dot(away), normal};
        }
        case Outline::Kind::disc: {
            const double r = away.norm();
            return {r - outline.radius, r > 0 ? Vec2(away / r) : Vec2(0, 1)};
        }
        case Outline::Kind::polygon: {
            const SurfaceDistance own = distance_to_polygon(outline.points, pose.turned_back(away));
            return {own.gap, pose.turned(own.normal)};
        }
    }
    return {0, Vec2(0, 1)};
}

bool may_reach(const Outline& outline, const Pose& pose, const Vec2& point, double reach) {
    if (outline.kind == Outline::Kind::half_plane) return true;
    double radius = outline.radius;
    for (const Vec2& p : outline.points) radius = std::max(radius, p.norm());
    return (point - pose.position).squaredNorm() <= (radius + reach) * (radius + reach);
}

}  // namespace knap
