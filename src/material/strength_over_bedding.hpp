#pragma once
// Strength and fracture energy of facets in layered rock, over their angle to the layers.
#include "base/vec.hpp"
#include "material/thermal.hpp"

#include <numbers>

namespace knap {

/// Linear between its points, constant outside.
struct AngleTable {
    std::vector<double> angle;  // [rad] ascending, at least two; empty: the factor is 1
    std::vector<double> factor;

    bool empty() const { return angle.empty(); }
    double operator()(double at) const {
        return empty() ? 1 : on_polyline(angle, factor, std::clamp(at, angle.front(), angle.back()));
    }
};

/// [-] On sigma_c, and on G_c (and G_II).
struct StrengthOverBedding {
    AngleTable strength, energy;

    bool any() const { return !strength.empty() || !energy.empty(); }
    /// [-] The shortest process zone of all facets, E' G_c/sigma_c^2, over that with the factors 1.
    double shortest_zone() const {
        double shortest = any() ? infinity : 1;
        for (int i = 0; i <= 90 && any(); ++i)
            shortest = std::min(shortest, energy(i * degree) / (strength(i * degree) * strength(i * degree)));
        return shortest;
    }
};

/// [rad] Between two lines, from 0 to pi/2.
inline double acute_angle(double a, double b) {
    const double between = std::abs(std::remainder(a - b, std::numbers::pi));
    return std::min(between, std::numbers::pi - between);
}

}  // namespace knap
