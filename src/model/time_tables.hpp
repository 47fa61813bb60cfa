#pragma once
// The tables over time of a model: factors of loads, of fluids in cracks and of what moves obstacles, and temperatures.
#include "model/model.hpp"

#include <cmath>

namespace knap {

/// [s] The size of a step of the implicit bulk from `begin` [s], at most `h` [s]: it ends at a point of a table
/// that it may not pass over (TimeFunction::corner), unless it is nearer than `nearest_corner` h. What heat is given
/// (flux, source) needs no such end: a step takes its integral.
double step_to_corner(const Model& model, double begin, double h);
inline constexpr double nearest_corner = 1e-3;

struct Rise {
    double size = 0, time = 0;  // [-], and when it begins [s]
    void include(double other, double when) {
        if (std::abs(other) > size) size = std::abs(other), time = when;
    }
};
/// The largest change of a history within `window` [s], before `end` [s]; `first` is its value before t = 0.
Rise largest_rise(const TimeFunction& history, double first, double window, double end);

}  // namespace knap
