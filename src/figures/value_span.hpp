#pragma once
// How far values reach, for a colour range that a few peaks do not set.
#include <cmath>
#include <vector>

namespace knap {

/// Values that are to have one range; empty at first.
struct ValueSpan {
    double low = INFINITY, high = -INFINITY;    // without the outermost (a crack tip's peak says little about the body)
    double least = INFINITY, most = -INFINITY;  // of all
};

/// Of all finite ones; at most an `outside` part of them at either end lies beyond low and high.
ValueSpan span_of(std::vector<double> values, double outside);
ValueSpan joined(const ValueSpan& a, const ValueSpan& b);

}  // namespace knap
