#pragma once
// What the bulk hands to the interfaces in a step: how the corners would move if no interface acted.
#include "base/vec.hpp"

#include <vector>

namespace knap {

struct FreeMotion {
    double drift_time = 0;           // [s] h: velocities move points for so long
    double kick_time = 0;            // [s] k: forces change velocities for so long
    std::vector<Vec2> corner_force;  // [N] internal and external, per corner, at the begin of the step; known of the corners that more than a block asks for
};

}  // namespace knap
