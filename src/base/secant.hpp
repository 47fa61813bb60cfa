#pragma once
// Root finding by secants that cannot stall (regula falsi with the Illinois rule).
#include <cmath>

namespace knap {

/// A zero between `low` and `high`, where the function is negative and positive. Stops where its magnitude is at most
/// `tolerance`, or after `max_evaluations`.
template <class Function>
double zero_between(double low, double at_low, double high, double at_high, double tolerance, int max_evaluations,
                    const Function& function) {
    double a = high;
    for (int i = 0, side = 0; i < max_evaluations; ++i) {
        a = (low * at_high - high * at_low) / (at_high - at_low);
        const double here = function(a);
        if (std::abs(here) <= tolerance) break;
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
