#pragma once
// Which points of a table over time a large step may pass over.
#include <array>
#include <cmath>

namespace knap {

/// How a table goes on from a point: by `time` [s] and `value` to its next one, or from the one before; where there is
/// none it is constant, `time` 1.
struct TableWay {
    double time = 1, value = 0;
};

/// [-] Of the difference between all values: how far the point may be from the straight line over a step that passes
/// over it. At a corner, where the slope changes by more than it does from sample to sample of a smooth curve, no more
/// than the digits of a table; at such a sample a hundredth, so that steps need not follow finely sampled curves.
inline double may_pass_over(const TableWay& before, const TableWay& after) {
    constexpr double corner = 0.6;  // change of the slope over both slopes: 1/2 beside the peak of a parabola
    const double first = before.value * after.time, second = after.value * before.time;  // jumps have time 0
    return std::abs(second - first) > corner * (std::abs(second) + std::abs(first)) ? 1e-6 : 0.01;
}

}  // namespace knap
