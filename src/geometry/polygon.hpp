#pragma once
// Elementary plane geometry of polygons and segments.
#include "geometry/distances.hpp"

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

/// True when the inner points of a-b and c-d cross; `t` is then the position on a-b.
bool segments_cross(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d, double& t);

}  // namespace knap
