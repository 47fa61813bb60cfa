#pragma once
// The shear that closed faces bear over their pressure: a concave polygon from (0, 0) on, closed by its last slope,
//
//     f(p) = min_i (mu_i p + c_i),     mu_1 > mu_2 > ... >= 0,     0 = c_1 < c_2 < ...
//
// The points below f are the intersection of the half planes of its lines. A point bears |r_T| <= f(p); its slip has
// no part along N whatever the slope is (no dilation), as Coulomb's, so the law is not associated.
#include "base/vec.hpp"

#include <algorithm>
#include <span>
#include <string>
#include <vector>

namespace knap {

/// mu p + c.
struct FrictionLine {
    double slope = 0, offset = 0;  // mu [-], c [Pa]
};

class FrictionOverPressure {
public:
    /// Of points (pressure, threshold) [Pa] without a fault; those on straight parts are left out.
    explicit FrictionOverPressure(const std::vector<Vec2>& points);

    std::span<const FrictionLine> lines() const { return lines_; }
    int n_lines() const { return static_cast<int>(lines_.size()); }
    const FrictionLine& line(int i) const { return lines_[i]; }
    /// [Pa] At which the line begins to be the lowest one.
    double start(int i) const { return start_[i]; }
    int line_at(double pressure) const {
        return std::max(0, static_cast<int>(std::ranges::upper_bound(start_, pressure) - start_.begin()) - 1);
    }
    /// [Pa] f
    double operator()(double pressure) const {
        if (pressure <= 0) return 0;
        const FrictionLine& at = lines_[line_at(pressure)];
        return at.slope * pressure + at.offset;
    }
    /// [-] f/p, up to the pressure.
    double chord(double pressure) const { return pressure > 0 ? (*this)(pressure) / pressure : lines_[0].slope; }

    static constexpr std::size_t most_points = 13;

private:
    std::vector<FrictionLine> lines_;
    std::vector<double> start_;
};

/// What is wrong with points (pressure, threshold) [Pa]; empty: nothing.
std::string fault_of_friction(const std::vector<Vec2>& points);

/// Friction over pressure of a point, of its impulses: pressures times `unit`, the time of its force times its area.
struct PressedFriction {
    const FrictionOverPressure* law = nullptr;
    double unit = 0;  // [N s/Pa]

    explicit operator bool() const { return law != nullptr; }
    double operator()(double p) const { return unit * (*law)(p / unit); }  // [N s]
    int line_at(double p) const { return law->line_at(p / unit); }
    double slope(double p) const { return law->line(line_at(p)).slope; }
    /// With the offset as an impulse [N s].
    FrictionLine line(int i) const { return {law->line(i).slope, unit * law->line(i).offset}; }
};

}  // namespace knap
