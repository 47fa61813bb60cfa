#pragma once
// What all searches for contacts share: of free faces, of the body with obstacles, of obstacles with each other.
#include "base/tolerance.hpp"
#include "base/vec.hpp"

#include <cmath>
#include <span>
#include <vector>

namespace knap {

constexpr double contact_reach_in_steps = 4;  // distances covered in a step at the speeds of its start
constexpr double near_contact = 0.02;   // [-] of the size of what meets an obstacle: nearer is a candidate at any speed
constexpr double touching_part = 1e-3;  // [-] of an edge: gaps and penetrations that count as rounding of the geometry
constexpr double largest_motion = 0.05;       // [-] of an edge, in a step: what moves further is not where it was found
constexpr double largest_rigid_motion = 0.2;  // [-] likewise of what keeps its shape
constexpr double most_passed = 1;   // [-] of an edge, in a step beside others: further, and it may be through them
constexpr double even_turn = 1e-4;  // sine of a turn that does not protrude
constexpr double max_depth_in_altitudes = 0.35;  // of a triangle: the step before should have been rejected
constexpr double position_rounding = 1e-15;      // [-] of the positions of what touches

/// [-] The largest motion in a step over the edge of what moves, and its place [m].
struct LargestMotion {
    double value = 0;
    Vec2 place = Vec2::Zero();

    void at_least(const LargestMotion& other) {
        if (other.value > value) *this = other;
    }
};

/// [m/s, m/s, rad/s] What is added to the velocities of rigid pieces in a step: sets by their causes, per piece each.
using AddedRates = std::span<const std::vector<Vec3>>;

/// [m/s] Of any place in a body with these rates [m/s, m/s, rad/s], at most; `radius` [m] about its centre.
inline double largest_speed(const Vec3& rates, double radius) {
    return rates.head<2>().norm() + std::abs(rates.z()) * radius;
}

/// [m] `of`: the coordinates.
inline double without_rounding(double gap, double of) { return std::abs(gap) <= relative_tolerance * of ? 0 : gap; }

}  // namespace knap
