#pragma once
// How a material conducts heat, stores it and expands, and properties that follow the temperature.
#include <algorithm>
#include <array>
#include <vector>

namespace knap {

/// Linear between the points (x, y), at least two, x ascending; with the slopes of the first and last pieces outside.
inline double on_polyline(const std::vector<double>& x, const std::vector<double>& y, double at) {
    const auto last = static_cast<std::size_t>(std::ranges::lower_bound(x, at) - x.begin());
    const std::size_t i = std::clamp<std::size_t>(last, 1, x.size() - 1);
    const double part = (at - x[i - 1]) / (x[i] - x[i - 1]);
    return y[i - 1] + part * (y[i] - y[i - 1]);
}

/// A property over temperature: linear between its points, constant outside.
struct TemperatureTable {
    std::vector<double> temperature;  // [K] ascending, at least two; empty: no table
    std::vector<double> value;        // same length

    bool empty() const { return temperature.empty(); }
    double operator()(double T) const {
        return on_polyline(temperature, value, std::clamp(T, temperature.front(), temperature.back()));
    }
};

/// Free thermal strain e(T) against a temperature of zero: a T, or linear between the points of a table, with the
/// slopes of its first and last pieces outside. A transition of the crystal is a steep piece.
struct Expansion {
    double coefficient = 0;           // [1/K] a; without a table
    std::vector<double> temperature;  // [K] ascending, at least two; empty: no table
    std::vector<double> strain;       // [-] same length

    double operator()(double T) const {
        return temperature.empty() ? coefficient * T : on_polyline(temperature, strain, T);
    }
};

struct Thermal {
    Expansion expansion;
    double conductivity = 0;                      // [W/(m K)] k
    double heat_capacity = 0;                     // [J/(kg K)] c
    double latent_heat = 0;                       // [J/kg] L, taken up over the freezing range
    std::array<double, 2> freezing_range{-1, 0};  // [K]

    /// [K] Stored heat over c, T + (L/c) (part of the freezing range below T): T itself without latent heat.
    double heat_level(double T) const {
        if (latent_heat == 0) return T;
        const auto& [low, high] = freezing_range;
        return T + latent_heat / heat_capacity * std::clamp((T - low) / (high - low), 0.0, 1.0);
    }
    /// [-] Apparent over true heat capacity: the slope of the heat level.
    double apparent_capacity(double T) const {
        const auto& [low, high] = freezing_range;
        return latent_heat > 0 && T >= low && T < high ? 1 + latent_heat / heat_capacity / (high - low) : 1;
    }
};

}  // namespace knap
