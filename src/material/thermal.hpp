#pragma once
// How a material conducts heat and expands.
#include <algorithm>
#include <vector>

namespace knap {

/// Free thermal strain e(T) against a temperature of zero: a T, or linear between the points of a table, with the
/// slopes
/// of its first and last pieces outside. A transition of the crystal is a steep piece.
struct Expansion {
    double coefficient = 0;           // [1/K] a; without a table
    std::vector<double> temperature;  // [K] ascending, at least two; empty: no table
    std::vector<double> strain;       // [-] same length

    double operator()(double T) const {
        if (temperature.empty()) return coefficient * T;
        const auto last = static_cast<std::size_t>(std::ranges::lower_bound(temperature, T) - temperature.begin());
        const std::size_t i = std::clamp<std::size_t>(last, 1, temperature.size() - 1);
        const double part = (T - temperature[i - 1]) / (temperature[i] - temperature[i - 1]);
        return strain[i - 1] + part * (strain[i] - strain[i - 1]);
    }
};

struct Thermal {
    Expansion expansion;
    double conductivity = 0;   // [W/(m K)] k
    double heat_capacity = 0;  // [J/(kg K)] c
};

}  // namespace knap
