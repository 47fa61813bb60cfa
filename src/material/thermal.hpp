#pragma once
// How a material conducts heat, stores it and expands, and properties that follow the temperature.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
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

/// A property over temperature as part of one of its values, and its integral over the temperature.
class PropertyOverTemperature {
public:
    PropertyOverTemperature() = default;  // always that value: 1
    explicit PropertyOverTemperature(TemperatureTable parts) : parts_(std::move(parts)) {
        for (std::size_t i = 0; i < parts_.temperature.size(); ++i)
            sum_.push_back(i == 0 ? parts_.temperature[0] : sum_[i - 1] + piece(i - 1, parts_.temperature[i]));
    }

    bool varies() const { return !parts_.empty(); }
    const TemperatureTable& table() const { return parts_; }
    const std::vector<double>& bends() const { return parts_.temperature; }
    double smallest() const { return varies() ? std::ranges::min(parts_.value) : 1; }
    double operator()(double T) const { return varies() ? parts_(T) : 1; }
    /// [K] Of the parts from the first temperature of the table to T, plus that temperature; T where nothing varies.
    double integral(double T) const {
        if (!varies()) return T;
        const std::vector<double>& at = parts_.temperature;
        if (T <= at.front()) return at.front() + parts_.value.front() * (T - at.front());
        if (T >= at.back()) return sum_.back() + parts_.value.back() * (T - at.back());
        const auto i = static_cast<std::size_t>(std::ranges::upper_bound(at, T) - at.begin()) - 1;
        return sum_[i] + piece(i, T);
    }

private:
    double piece(std::size_t i, double T) const {
        return (T - parts_.temperature[i]) * 0.5 * (parts_.value[i] + parts_(T));
    }

    TemperatureTable parts_;   // [-]
    std::vector<double> sum_;  // [K] integral at the temperatures of the table
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
    double conductivity = 0;                      // [W/(m K)] k, the largest of its table
    double heat_capacity = 0;                     // [J/(kg K)] c, the smallest of its table: both bound explicit steps
    PropertyOverTemperature conductivity_part;    // k(T) over that
    PropertyOverTemperature capacity_part;        // c(T) over that
    double latent_heat = 0;                       // [J/kg] L, taken up over the freezing range
    std::array<double, 2> freezing_range{-1, 0};  // [K]

    /// [K] Stored heat over c, int c(T)/c dT + (L/c) (part of the freezing range below T): T itself where c is constant
    /// and nothing freezes.
    double heat_level(double T) const {
        const double sensible = capacity_part.integral(T);
        if (latent_heat == 0) return sensible;
        const auto& [low, high] = freezing_range;
        return sensible + latent_heat / heat_capacity * std::clamp((T - low) / (high - low), 0.0, 1.0);
    }
    bool has_constant_capacity() const { return latent_heat == 0 && !capacity_part.varies(); }
    /// [-] The slope of the heat level, at least 1.
    double apparent_capacity(double T) const {
        const auto& [low, high] = freezing_range;
        const bool freezes = latent_heat > 0 && T >= low && T < high;
        return freezes ? capacity_part(T) + latent_heat / heat_capacity / (high - low) : capacity_part(T);
    }
    double smallest_conductivity() const { return conductivity * conductivity_part.smallest(); }  // [W/(m K)]
    /// Calls visit(T) where the slope of the heat level bends or jumps.
    template <class Visit>
    void for_each_bend(const Visit& visit) const {
        for (const double T : capacity_part.bends()) visit(T);
        for (const double T : freezing_range)
            if (latent_heat > 0) visit(T);
    }
    /// [-] k(T) over k between two temperatures, so that (k/k_max) (T_b - T_a) is the integral of k(T)/k_max
    /// (Kirchhoff's transform).
    double mean_conductivity_part(double a, double b) const {
        const double reach = conductivity_part.bends().back() - conductivity_part.bends().front();
        if (std::abs(b - a) < 1e-7 * reach) return conductivity_part(0.5 * (a + b));  // else rounding divides by b - a
        return (conductivity_part.integral(b) - conductivity_part.integral(a)) / (b - a);
    }
};

}  // namespace knap
