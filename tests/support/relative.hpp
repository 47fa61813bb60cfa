#pragma once
// Equal within a relative tolerance.
#include <doctest/doctest.h>

namespace knap::tests {

/// doctest adds a scale of 1 to the compared values, which would make all lengths in metres and all times in seconds equal.
/// Not for zero: nothing but zero itself is near it.
inline doctest::Approx relative(double value, double tolerance = 1e-9) {
    return doctest::Approx(value).epsilon(tolerance).scale(0);
}

}  // namespace knap::tests
