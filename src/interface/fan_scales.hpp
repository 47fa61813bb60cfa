#pragma once
// What is large and what is rounding in the problem of one fan: the units of its impulses and velocities, and its tolerances.
#include "interface/fan_problem.hpp"

namespace knap {

struct FanScales {
    double impulse = 1;            // [N s] the largest that can occur
    double speed = 1;              // [m/s]
    double impulse_tolerance = 0;  // [N s]
    double speed_tolerance = 0;    // [m/s]
    double rest = 0;               // [m/s] kinks of a staircase that are nearer to each other are one
};

FanScales scales_of(const FanProblem& problem);

}  // namespace knap
