#pragma once
// Equal within a tolerance, of the values or in their unit. doctest::Approx adds a scale of 1 to the compared values,
// which makes all lengths in metres and all times in seconds equal.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

namespace knap::tests {

struct Near {
    double value;
    double share;  // of the larger magnitude of the two values
    double bound;  // in the unit of the values
};

inline bool operator==(double found, const Near& near) {
    return std::abs(found - near.value) <= near.share * std::max(std::abs(found), std::abs(near.value)) + near.bound;
}

inline doctest::String toString(const Near& near) {
    return doctest::toString(near.value) + " within " +
           (near.share > 0 ? doctest::toString(near.share) + " of it" : doctest::toString(near.bound));
}

/// Not for zero: nothing but zero itself is near it.
inline Near relative(double value, double tolerance = 1e-9) { return {value, tolerance, 0}; }

/// For what is zero or a difference that cancels; the bound has the unit of the value.
inline Near within(double value, double bound) { return {value, 0, bound}; }

}  // namespace knap::tests
