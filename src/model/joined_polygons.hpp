#pragma once
// Polygons that stay in their places and touch or overlap have one surface. What slides over the seam of two flush ones
// would else meet the side of the next one, which lies inside:
//
//     ------------.-----          parts     of each side, what lies in no other polygon; of flush sides that face the
//      one  ->    |  two                    same way the first one has it
//     ____________|_____          surface   each part goes on with the one that begins where it ends, by the sharpest
//                                           turn to the right where there are several
#include "model/obstacle.hpp"

namespace knap {

/// Gives those that touch others their surface (Outline::line), in which each has its own parts: reactions and laws of
/// contact stay those of the obstacle that is touched. Others keep theirs.
void join_fixed_polygons(std::vector<Obstacle>& obstacles);

}  // namespace knap
