#pragma once
// Which points of a table over time a large step may pass over.
#include <cmath>
#include <cstddef>
#include <vector>

namespace knap {

/// [-] Of the difference between all values: how far point k of a table (`time` [s], value(k)) may be from the straight
/// line over a step that passes over it. At a corner, where the slope changes by more than it does from sample to
/// sample of a smooth curve, no more than the digits of a table; at such a sample a hundredth, so that steps need not
/// follow finely sampled curves. Before its first point and behind its last one a table is constant.
template <class Value>
double may_pass_over(const std::vector<double>& time, std::size_t k, const Value& value) {
    constexpr double corner = 0.6;  // change of the slope over both slopes: 1/2 beside the peak of a parabola
    const bool begins = k == 0, ends = k + 1 == time.size();
    const double time_before = begins ? 1 : time[k] - time[k - 1], time_after = ends ? 1 : time[k + 1] - time[k],
                 first = begins ? 0 : (value(k) - value(k - 1)) * time_after,  // jumps have time 0
        second = ends ? 0 : (value(k + 1) - value(k)) * time_before;
    return std::abs(second - first) > corner * (std::abs(second) + std::abs(first)) ? 1e-6 : 0.01;
}

}  // namespace knap
