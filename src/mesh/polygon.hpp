#pragma once
// Plane geometry of boxes, polygons and segments. Polygons are closed and do not repeat their first point.
#include "base/vec.hpp"

#include <vector>

namespace knap {

struct Box {
    Vec2 low, high;  // [m]

    Vec2 extent() const { return high - low; }
    Vec2 middle() const { return 0.5 * (low + high); }
    double diagonal() const { return (high - low).norm(); }
    bool contains(const Vec2& p) const { return (p.array() >= low.array()).all() && (p.array() <= high.array()).all(); }
    bool meets(const Box& other) const {
        return (low.array() <= other.high.array()).all() && (high.array() >= other.low.array()).all();
    }
    /// [m] 0 inside.
    double distance(const Vec2& p) const { return (low - p).cwiseMax(p - high).cwiseMax(Vec2::Zero()).norm(); }
    /// Counterclockwise from `low`.
    std::vector<Vec2> corners() const { return {low, {high.x(), low.y()}, high, {low.x(), high.y()}}; }
};

/// At least one point is needed.
Box bounding_box(const std::vector<Vec2>& points);

/// [m2] Positive when the polygon runs counterclockwise.
double signed_area(const std::vector<Vec2>& polygon);

/// [m] Of the area; the first point where there is no area.
Vec2 centroid(const std::vector<Vec2>& polygon);

bool is_convex(const std::vector<Vec2>& polygon);

/// Even-odd rule; a point on the border may be in or out.
bool contains(const std::vector<Vec2>& polygon, const Vec2& p);

/// Cuts a convex polygon to its part with distance(p) <= 0, a function linear in p; empty where that has no area.
template <class Distance>
void clip(std::vector<Vec2>& polygon, const Distance& distance, std::vector<Vec2>& scratch) {
    scratch.clear();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec2 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        const double at_a = distance(a), at_b = distance(b);
        if (at_a <= 0) scratch.push_back(a);
        if ((at_a < 0 && at_b > 0) || (at_a > 0 && at_b < 0)) scratch.push_back(a + at_a / (at_a - at_b) * (b - a));
    }
    if (scratch.size() < 3) scratch.clear();
    polygon.swap(scratch);
}

/// A regular polygon of `n` sides with its vertices on a circle, counterclockwise.
std::vector<Vec2> circle(const Vec2& centre, double radius, int n);

struct Segment {
    Vec2 a, b;
};

/// The sides of a polygon, or (not closed) of a polyline.
std::vector<Segment> sides_of(const std::vector<Vec2>& points, bool closed);

/// Position in [0, 1] of the point of segment a-b that is nearest to p.
double nearest_parameter(const Vec2& a, const Vec2& b, const Vec2& p);

double distance_to_segment(const Vec2& a, const Vec2& b, const Vec2& p);

/// Zero when the segments cross or touch.
double distance_between(const Segment& s, const Segment& t);

/// True when the interiors of the two segments cross; `position` in (0, 1) is then that of the crossing on s.
bool segments_cross(const Segment& s, const Segment& t, double& position);

}  // namespace knap
