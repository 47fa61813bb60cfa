#pragma once
// Where a function changes its sign: secants that cannot stall (the Illinois rule).
#include <cmath>

namespace knap {

/// A zero between `low` and `high`, where the function is negative and positive; until it is at most `goal`, or after `most` values of it.
template <class Function>
double zero_between(double low, double at_low, double high, double at_high, double goal, int most, const Function& function) {
    double a = high;
    for (int i = 0, side = 0; i < most; ++i) {
        a = (low * at_high - high * at_low) / (at_high - at_low);
        const double here = function(a);
        if (std::abs(here) <= goal) break;
        if (here > 0) {
            high = a, at_high = here;
            if (side == 1) at_low /= 2;
            side = 1;
        } else {
            low = a, at_low = here;
            if (side == -1) at_high /= 2;
            side = -1;
        }
    }
    return a;
}

}  // namespace knap
