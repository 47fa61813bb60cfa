#pragma once
// Distances in the plane, and whether a polygon contains a point.
#include "base/vec.hpp"

#include <vector>

namespace knap {

/// Even-odd rule; a point on the border may be in or out.
bool contains(const std::vector<Vec2>& polygon, const Vec2& p);

/// Position in [0, 1] of the point of segment a-b that is nearest to p.
double nearest_parameter(const Vec2& a, const Vec2& b, const Vec2& p);

double distance_to_segment(const Vec2& a, const Vec2& b, const Vec2& p);

/// Zero when the segments a-b and c-d cross or touch.
double distance_between_segments(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d);

}  // namespace knap
