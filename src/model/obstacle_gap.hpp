#pragma once
// Gaps between rigid obstacles, and between an obstacle and an edge of the body: where contact begins, and how deep one
// lies in the other.
#include "model/obstacle.hpp"

#include <functional>
#include <vector>

namespace knap {

struct ObstacleGap {
    double gap;  // [m] negative: depth of the overlap
    Vec2 place;  // [m] where it is largest
};

/// By the separating axes, so that a positive gap may be less than the distance. Two that are not bounded: infinite.
ObstacleGap gap_between(const ObstacleSurface& a, const ObstacleSurface& b);

/// From an edge of the body, which lies to the left of a to b [m]: the surface of the obstacle, moved against its
/// normals or out of the body along that of the edge. Positive if they do not intersect, also where the obstacle is
/// behind the edge. Of a polyline the deepest of the ends of the edge and of its corners beside it, behind it if
/// `is_in_body`: of a rough terrain others lie in front of the next edge.
ObstacleGap gap_to_edge(
    const ObstacleSurface& surface, const Vec2& a, const Vec2& b,
    const std::function<bool(const Vec2&)>& is_in_body = [](const Vec2&) { return true; });

/// Pairs (i < j) of which one moves freely, unless the components in which they move keep them apart; also with those
/// `behind` them, which are numbered on.
std::vector<std::array<Index, 2>> obstacles_that_may_meet(const std::vector<Obstacle>& obstacles,
                                                          const std::vector<Obstacle>& behind = {});

}  // namespace knap
