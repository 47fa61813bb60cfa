#pragma once
// Elementary plane geometry of polygons and segments.
#include "base/vec.hpp"

#include <vector>

namespace knap {

struct Box {
    Vec2 low, high;  // [m]

    double diagonal() const { return (high - low).norm(); }
    bool contains(const Vec2& p, double margin = 0) const {
        return p.x() >= low.x() - margin && p.x() <= high.x() + margin && p.y() >= low.y() - margin && p.y() <= high.y() + margin;
    }
};

Box bounding_box(const std::vector<Vec2>& points);

/// Positive when the polygon runs counterclockwise.
double signed_area(const std::vector<Vec2>& polygon);

/// Even-odd rule; a point on the border may be in or out.
bool contains(const std::vector<Vec2>& polygon, const Vec2& p);

/// Position in [0, 1] of the point of segment a-b that is nearest to p.
double nearest_parameter(const Vec2& a, const Vec2& b, const Vec2& p);

double distance_to_segment(const Vec2& a, const Vec2& b, const Vec2& p);

/// Zero when the segments a-b and c-d cross or touch.
double distance_between_segments(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d);

/// True when the inner points of a-b and c-d cross; `t` is then the position on a-b.
bool segments_cross(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d, double& t);

}  // namespace knap
