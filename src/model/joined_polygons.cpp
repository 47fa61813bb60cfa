#include "model/joined_polygons.hpp"

#include "mesh/polygon.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr double flush = 1e-6;  // [-] of the half width: sides as near as this lie on each other

struct Placed {
    Index number;              // of the obstacle
    std::vector<Vec2> points;  // [m] counterclockwise
    double rounding;           // [m]
    bool touches = false;      // another one

    const Vec2& next(std::size_t i) const { return points[(i + 1) % points.size()]; }
};

bool is_fixed(const Obstacle& obstacle) {
    return std::ranges::none_of(obstacle.drive,
                                [](const Drive& drive) { return drive.kind == Drive::Kind::free || drive.value != 0; });
}

std::vector<Placed> fixed_polygons(const std::vector<Obstacle>& obstacles) {
    std::vector<Placed> found;
    for (std::size_t o = 0; o < obstacles.size(); ++o) {
        const Outline& outline = obstacles[o].outline;
        if (outline.kind != Outline::Kind::polygon || !is_fixed(obstacles[o])) continue;
        const ObstacleSurface surface(outline, obstacles[o].start);
        Placed& placed = found.emplace_back(Placed{static_cast<Index>(o), {}, flush * outline.half_width()});
        for (std::size_t i = 0; i < outline.points.size(); ++i) placed.points.push_back(surface.place(i));
    }
    return found;
}

struct Interval {
    double from, to;  // [-] of a side
};

/// What of the side from a to b lies in the polygon, or on it, unless `is_later` and the sides face the same way.
Interval inside(const Vec2& a, const Vec2& b, const Placed& polygon, bool is_later, double rounding) {
    constexpr Interval none{1, 0};
    Interval found{0, 1};
    for (std::size_t i = 0; i < polygon.points.size(); ++i) {
        const Vec2 along = polygon.next(i) - polygon.points[i], outward = -turned_left(along.normalized());
        const double h_a = outward.dot(a - polygon.points[i]), h_b = outward.dot(b - polygon.points[i]);
        if (std::min(h_a, h_b) > rounding) return none;
        if (std::max(std::abs(h_a), std::abs(h_b)) <= rounding) {
            if (along.dot(b - a) > 0 && is_later) return none;
        } else if (std::max(h_a, h_b) > rounding) {
            (h_a > h_b ? found.from : found.to) =
                h_a > h_b ? std::max(found.from, h_a / (h_a - h_b)) : std::min(found.to, h_a / (h_a - h_b));
        }
    }
    return (found.to - found.from) * (b - a).norm() > rounding ? found : none;
}

/// The parts of the sides that lie in no other polygon.
std::vector<Polyline::Part> outer_parts(std::vector<Placed>& polygons) {
    std::vector<Polyline::Part> parts;
    for (std::size_t p = 0; p < polygons.size(); ++p)
        for (std::size_t i = 0; i < polygons[p].points.size(); ++i) {
            const Vec2 &a = polygons[p].points[i], &b = polygons[p].next(i);
            std::vector<Interval> hidden;
            for (std::size_t q = 0; q < polygons.size(); ++q) {
                if (p == q) continue;
                const double rounding = std::max(polygons[p].rounding, polygons[q].rounding);
                if (const Interval found = inside(a, b, polygons[q], q > p, rounding); found.from < found.to)
                    hidden.push_back(found), polygons[p].touches = polygons[q].touches = true;
            }
            std::ranges::sort(hidden, {}, &Interval::from);
            hidden.push_back({1, 1});
            const auto at = [&](double s) -> Vec2 { return s == 1 ? b : a + s * (b - a); };
            const double least = polygons[p].rounding / (b - a).norm();
            double from = 0;
            for (const Interval& next : hidden) {
                if (next.from - from > least) parts.push_back({at(from), at(next.from), -1, -1, polygons[p].number});
                from = std::max(from, next.to);
            }
        }
    return parts;
}

/// Each part goes on where it ends.
void link(std::vector<Polyline::Part>& parts, double rounding) {
    const auto turn = [&](const Polyline::Part& one, const Polyline::Part& two) {
        const Vec2 t_1 = one.end - one.start, t_2 = two.end - two.start;
        return std::atan2(cross(t_1, t_2), t_1.dot(t_2));
    };
    for (Index i = 0; i < std::ssize(parts); ++i)
        for (Index j = 0; j < std::ssize(parts); ++j) {
            if (i == j || (parts[j].start - parts[i].end).norm() > rounding) continue;
            if (parts[i].after >= 0 && turn(parts[i], parts[parts[i].after]) <= turn(parts[i], parts[j])) continue;
            parts[i].after = j;
        }
    for (Index i = 0; i < std::ssize(parts); ++i)
        if (parts[i].after >= 0) parts[parts[i].after].before = i;
}

}  // namespace

void join_fixed_polygons(std::vector<Obstacle>& obstacles) {
    std::vector<Placed> polygons = fixed_polygons(obstacles);
    outer_parts(polygons);  // marks those that touch others
    std::erase_if(polygons, [](const Placed& polygon) { return !polygon.touches; });
    if (polygons.empty()) return;
    std::vector<Polyline::Part> parts = outer_parts(polygons);
    double rounding = 0;
    for (const Placed& polygon : polygons) rounding = std::max(rounding, polygon.rounding);
    link(parts, 2 * rounding);
    const auto line = std::make_shared<const Polyline>(parts);
    for (const Placed& polygon : polygons)
        obstacles[polygon.number].outline.line = line, obstacles[polygon.number].outline.owner = polygon.number;
}

}  // namespace knap
