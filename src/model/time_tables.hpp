#pragma once
// The tables over time of a model: factors of loads, of fluids in cracks and of what moves obstacles, and temperatures.
#include "model/model.hpp"

namespace knap {

/// [s] The size of a step of the implicit bulk from `begin` [s], at most `h` [s]: it ends at a corner of a table that
/// it would pass over by more than TimeFunction::corner_tolerance, unless it is nearer than `nearest_corner` h. What
/// heat is given (flux, source) needs no such end: a step takes its integral.
double step_to_corner(const Model& model, double begin, double h);
inline constexpr double nearest_corner = 1e-3;

}  // namespace knap
