#include "model/obstacle_gap.hpp"

#include <algorithm>

namespace knap {
namespace {

using Kind = Outline::Kind;

/// Gap between a disc or polygon and the side of a half plane or polygon that it is furthest from.
ObstacleGap beyond_sides(const ObstacleSurface& sides, const ObstacleSurface& other) {
    if (sides.outline().kind == Kind::half_plane) {
        const Vec2 normal = sides.rotation().turned(sides.outline().normal), nearest = other.furthest(-normal);
        return {normal.dot(nearest - sides.position()), nearest};
    }
    const auto found = sides.furthest_side([&](const Vec2& outward) { return other.furthest(-outward); });
    return {found.gap, found.nearest};
}

/// Gap between a polygon and a polyline: the smallest of the points of each to the other.
ObstacleGap gap_to_polyline(const ObstacleSurface& line, const ObstacleSurface& polygon) {
    ObstacleGap smallest{infinity, polygon.position()};
    const auto look = [&](double gap, const Vec2& place) {
        if (gap < smallest.gap) smallest = {gap, place};
    };
    for (std::size_t i = 0; i < polygon.outline().points.size(); ++i) {
        const Vec2 x = polygon.place(i);
        look(line.distance_to(x).gap, x);
    }
    line.visit_corners(polygon.position(), polygon.radius(), [&](std::size_t i) {
        const Vec2 x = line.corner(i);
        look(polygon.distance_to(x).gap, x);
    });
    return smallest;
}

/// Component k of its motion is free or prescribed.
bool moves(const Obstacle& obstacle, int k) { return obstacle.is_free(k) || obstacle.drive[k].value != 0; }

/// [m] From the lowest to the highest coordinate k of an obstacle at its start, however it turns if it does.
std::array<double, 2> extent(const Obstacle& obstacle, int k, bool turns) {
    const Outline& outline = obstacle.outline;
    const ObstacleSurface surface(outline, obstacle.start);
    const Vec2 along = Vec2::Unit(k);
    const double at = obstacle.start.position[k];
    if (outline.kind == Kind::half_plane) {
        const double normal = turns ? 0 : Rotation::by(obstacle.start.angle).turned(outline.normal)[k];
        return {normal <= -1 ? at : -infinity, normal >= 1 ? at : infinity};
    }
    double radius = outline.radius;
    for (const Vec2& p : outline.points) radius = std::max(radius, p.norm());
    if (turns) return {at - radius, at + radius};
    return {surface.furthest(-along)[k], surface.furthest(along)[k]};
}

bool may_meet(const Obstacle& a, const Obstacle& b) {
    if (!a.is_free() && !b.is_free()) return false;
    for (int k = 0; k < 2; ++k) {
        if (moves(a, k) || moves(b, k)) continue;
        const auto [low_a, high_a] = extent(a, k, moves(a, 2));
        const auto [low_b, high_b] = extent(b, k, moves(b, 2));
        if (low_a > high_b || low_b > high_a) return false;
    }
    return true;
}

}  // namespace

ObstacleGap gap_between(const ObstacleSurface& a, const ObstacleSurface& b) {
    const Kind kind_a = a.outline().kind, kind_b = b.outline().kind;
    if (!a.outline().is_bounded() && !b.outline().is_bounded()) return {infinity, a.position()};
    if (kind_b == Kind::half_plane) return beyond_sides(b, a);
    if (kind_a == Kind::half_plane) return beyond_sides(a, b);
    if (kind_a == Kind::polygon && kind_b == Kind::polygon) {
        const ObstacleGap of_a = beyond_sides(a, b), of_b = beyond_sides(b, a);
        return of_a.gap > of_b.gap ? of_a : of_b;
    }
    if (kind_a != Kind::disc && kind_b != Kind::disc)
        return kind_a == Kind::polyline ? gap_to_polyline(a, b) : gap_to_polyline(b, a);
    const bool first = kind_a == Kind::disc;  // a disc and something with a distance
    const ObstacleSurface &disc = first ? a : b, &other = first ? b : a;
    const auto [gap, normal] = other.distance_to(disc.position());
    const double radius = disc.outline().radius;
    return {gap - radius, disc.position() - radius * normal};
}

ObstacleGap gap_to_edge(const ObstacleSurface& surface, const Vec2& a, const Vec2& b,
                        const std::function<bool(const Vec2&)>& is_in_body) {
    const Outline& outline = surface.outline();
    const PlacedEdge edge = placed_edge(a, b);
    if (outline.kind == Kind::disc) {
        const double radius = outline.radius, along = nearest_parameter(a, b, surface.position());
        const Vec2 nearest = a + along * (b - a), away = surface.position() - nearest;
        const double distance = away.norm();
        if (distance >= radius) return {distance - radius, nearest};
        return {(along > 0 && along < 1 ? edge.outward.dot(away) : distance) - radius, nearest};
    }
    if (outline.line) {
        ObstacleGap smallest{infinity, a};
        const auto look = [&](double gap, const Vec2& place) {
            if (gap < smallest.gap) smallest = {gap, place};
        };
        for (const Vec2& end : {a, b}) look(surface.distance_to(end).gap, end);
        surface.visit_corners(a, 2 * edge.length, [&](std::size_t i) {
            const Vec2 p = surface.corner(i);
            const double height = edge.gap(p), along = edge.place(p);
            if (along > 0 && along < edge.length && height > -edge.length && surface.protrudes(i, edge.outward) &&
                (height >= std::min(smallest.gap, 0.0) || is_in_body(p)))
                look(height, p);
        });
        return smallest;
    }
    ObstacleGap largest{-infinity, a};  // over the directions in which they can be parted
    const auto side = [&](const Vec2& at, const Vec2& normal) {
        const double gap_a = normal.dot(a - at), gap_b = normal.dot(b - at);
        if (const double gap = std::min(gap_a, gap_b); gap > largest.gap) largest = {gap, gap_a < gap_b ? a : b};
    };
    if (outline.kind == Kind::half_plane) {
        side(surface.position(), surface.rotation().turned(outline.normal));
        return largest;
    }
    double before = infinity, behind = infinity;  // [m] of the corners, the edge
    Vec2 deepest = a;
    for (std::size_t i = 0; i < outline.points.size(); ++i) {
        const PlacedEdge own = surface.side(i);
        const double height = edge.gap(own.start);
        if (height < before) before = height, deepest = own.start;
        behind = std::min(behind, -height);
        side(own.start, own.outward);
    }
    if (behind >= 0) return {std::max(behind, largest.gap), deepest};
    return before > largest.gap ? ObstacleGap{before, deepest} : largest;
}

std::vector<std::array<Index, 2>> obstacles_that_may_meet(const std::vector<Obstacle>& obstacles,
                                                          const std::vector<Obstacle>& behind) {
    std::vector<std::array<Index, 2>> pairs;
    const std::size_t n = obstacles.size();
    for (std::size_t j = 0; j < n + behind.size(); ++j)
        for (std::size_t i = 0; i < std::min(j, n); ++i)
            if (may_meet(obstacles[i], j < n ? obstacles[j] : behind[j - n]))
                pairs.push_back({static_cast<Index>(i), static_cast<Index>(j)});
    return pairs;
}

}  // namespace knap
