#pragma once
// What all searches for contacts share: of free faces, of the body with obstacles, of obstacles with each other.
#include "base/tolerance.hpp"

#include <cmath>

namespace knap {

constexpr double contact_reach_in_steps = 4;  // distances covered in a step at the speeds of its start
constexpr double near_contact = 0.02;   // [-] of the size of what meets an obstacle: nearer is a candidate at any speed
constexpr double touching_part = 1e-3;  // [-] of an edge: gaps and penetrations that count as rounding of the geometry
constexpr double largest_motion = 0.05;  // [-] of an edge, in a step: what moves further is not where it was found
constexpr double even_turn = 1e-4;       // sine of a turn that does not protrude
constexpr double max_depth_in_altitudes = 0.35;  // of a triangle: the step before should have been rejected
constexpr double position_rounding = 1e-15;      // [-] of the positions of what touches

/// [m] `of`: the coordinates.
inline double without_rounding(double gap, double of) { return std::abs(gap) <= relative_tolerance * of ? 0 : gap; }

}  // namespace knap
