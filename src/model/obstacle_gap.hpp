#pragma once
// Rigid obstacles among each other. They do not touch: a free one penetrates the others, which is reported.
#include "model/obstacle.hpp"

#include <vector>

namespace knap {

struct ObstacleGap {
    double gap;  // [m] negative: depth of the overlap
    Vec2 place;  // [m] where it is largest
};

/// By the separating axes, so that a positive gap may be less than the distance. Two half planes: infinite.
ObstacleGap gap_between(const ObstacleSurface& a, const ObstacleSurface& b);

/// Pairs (i < j) of which one moves freely, unless the components in which they move keep them apart.
std::vector<std::array<Index, 2>> obstacles_that_may_meet(const std::vector<Obstacle>& obstacles);

}  // namespace knap
