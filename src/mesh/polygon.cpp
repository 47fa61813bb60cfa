#include "mesh/polygon.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace knap {

Box bounding_box(const std::vector<Vec2>& points) {
    Box box{points.front(), points.front()};
    for (const Vec2& p : points) box = {box.low.cwiseMin(p), box.high.cwiseMax(p)};
    return box;
}

// Areas and moments are taken relative to the first point, so that a distant origin costs no digits.

double signed_area(const std::vector<Vec2>& polygon) {
    double twice = 0;
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
        twice += cross(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]);
    return 0.5 * twice;
}

Vec2 centroid(const std::vector<Vec2>& polygon) {
    const Vec2& o = polygon.front();
    Vec2 moment = Vec2::Zero();
    double twice_area = 0;
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
        const Vec2 a = polygon[i] - o, b = polygon[i + 1] - o;
        twice_area += cross(a, b);
        moment += cross(a, b) * (a + b) / 3;
    }
    return twice_area != 0 ? Vec2(o + moment / twice_area) : o;
}

bool is_convex(const std::vector<Vec2>& polygon) {
    const double sign = signed_area(polygon);
    for (std::size_t i = 0, n = polygon.size(); i < n; ++i) {
        const Vec2 &a = polygon[i], &b = polygon[(i + 1) % n], &c = polygon[(i + 2) % n];
        if (cross(b - a, c - b) * sign <= 0) return false;
    }
    return sign != 0;
}

bool contains(const std::vector<Vec2>& polygon, const Vec2& p) {
    bool inside = false;
    for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
        const Vec2 &a = polygon[i], &b = polygon[j];
        if ((a.y() > p.y()) == (b.y() > p.y())) continue;
        if (p.x() < a.x() + (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y())) inside = !inside;
    }
    return inside;
}

std::vector<Vec2> circle(const Vec2& centre, double radius, int n) {
    std::vector<Vec2> points;
    for (int i = 0; i < n; ++i) {
        const double angle = 2 * std::numbers::pi * i / n;
        points.push_back(centre + radius * Vec2(std::cos(angle), std::sin(angle)));
    }
    return points;
}

std::vector<Segment> sides_of(const std::vector<Vec2>& points, bool closed) {
    std::vector<Segment> sides;
    for (std::size_t i = 0; i + (closed ? 0 : 1) < points.size(); ++i)
        sides.push_back({points[i], points[(i + 1) % points.size()]});
    return sides;
}

double nearest_parameter(const Vec2& a, const Vec2& b, const Vec2& p) {
    const double length2 = (b - a).squaredNorm();
    return length2 > 0 ? std::clamp((p - a).dot(b - a) / length2, 0.0, 1.0) : 0.0;
}

double distance_to_segment(const Vec2& a, const Vec2& b, const Vec2& p) {
    return (p - (a + nearest_parameter(a, b, p) * (b - a))).norm();
}

double distance_between(const Segment& s, const Segment& t) {
    double position;
    if (segments_cross(s, t, position)) return 0;
    return std::min({distance_to_segment(s.a, s.b, t.a), distance_to_segment(s.a, s.b, t.b),
                     distance_to_segment(t.a, t.b, s.a), distance_to_segment(t.a, t.b, s.b)});
}

bool segments_cross(const Segment& s, const Segment& t, double& position) {
    const double to_c = cross(s.b - s.a, t.a - s.a), to_d = cross(s.b - s.a, t.b - s.a);
    const double to_a = cross(t.b - t.a, s.a - t.a), to_b = cross(t.b - t.a, s.b - t.a);
    if (!(to_c * to_d < 0 && to_a * to_b < 0)) return false;
    position = to_a / (to_a - to_b);
    return true;
}

}  // namespace knap
