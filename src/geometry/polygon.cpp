#include "geometry/polygon.hpp"

#include <algorithm>

namespace knap {

Box bounding_box(const std::vector<Vec2>& points) {
    Box box{points.front(), points.front()};
    for (const Vec2& p : points) {
        box.low = box.low.cwiseMin(p);
        box.high = box.high.cwiseMax(p);
    }
    return box;
}

double signed_area(const std::vector<Vec2>& polygon) {
    // relative to the first point, so that a far-off origin costs no digits
    double twice = 0;
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) twice += cross(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]);
    return 0.5 * twice;
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

double nearest_parameter(const Vec2& a, const Vec2& b, const Vec2& p) {
    const double length2 = (b - a).squaredNorm();
    return length2 > 0 ? std::clamp((p - a).dot(b - a) / length2, 0.0, 1.0) : 0.0;
}

double distance_to_segment(const Vec2& a, const Vec2& b, const Vec2& p) { return (p - (a + nearest_parameter(a, b, p) * (b - a))).norm(); }

double distance_between_segments(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
    double t;
    if (segments_cross(a, b, c, d, t)) return 0;
    return std::min(
        {distance_to_segment(a, b, c), distance_to_segment(a, b, d), distance_to_segment(c, d, a), distance_to_segment(c, d, b)});
}

bool segments_cross(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d, double& t) {
    const double to_c = cross(b - a, c - a), to_d = cross(b - a, d - a);
    const double to_a = cross(d - c, a - c), to_b = cross(d - c, b - c);
    if (!(to_c * to_d < 0 && to_a * to_b < 0)) return false;
    t = to_a / (to_a - to_b);
    return true;
}

}  // namespace knap
