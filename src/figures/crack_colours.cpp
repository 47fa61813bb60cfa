#include "figures/crack_colours.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_map>

namespace knap {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// Finds the line of breaks.csv that is about an interface, by the place of its middle.
class BreakFinder {
public:
    BreakFinder(const History& breaks, const std::string& column, double length_scale)
        : x_(breaks.column("x")), y_(breaks.column("y")), value_(breaks.column(column)), cell_(1e-6 * length_scale) {
        for (std::size_t i = 0; i < x_.size(); ++i) line_of_cell_.emplace(cell(x_[i], y_[i]), i);
    }

    double operator()(const Vec2& middle) const {
        // it may lie beside the border of its cell
        for (const double dx : {-0.25, 0.25})
            for (const double dy : {-0.25, 0.25})
                if (const auto found = line_of_cell_.find(cell(middle.x() + dx * cell_, middle.y() + dy * cell_)); found != line_of_cell_.end()) return value_[found->second];
        return unknown;
    }

private:
    std::uint64_t cell(double x, double y) const {
        const auto i = static_cast<std::int64_t>(std::floor(x / cell_)), j = static_cast<std::int64_t>(std::floor(y / cell_));
        return static_cast<std::uint64_t>(i) * 0x9E3779B97F4A7C15u ^ static_cast<std::uint64_t>(j);
    }

    std::vector<double> x_, y_, value_;
    double cell_;  // [m]
    std::unordered_map<std::uint64_t, std::size_t> line_of_cell_;
};

bool has_colour(const CrackColour& colour, Kind kind) {
    return kind == Kind::broken || (kind == Kind::damaged && colour.damaged) || (kind == Kind::precrack && colour.precracks);
}

/// Over the two ends of an interface.
double mean(const std::vector<double>& of_points, Index i) { return 0.5 * (of_points[2 * i] + of_points[2 * i + 1]); }

}  // namespace

Kind kind_of(const Frame& frame, Index i) {
    const PointStatus a = frame.status[2 * i], b = frame.status[2 * i + 1];
    const bool on_support = frame.side_a[i][0] < 0 || frame.side_b[i][0] < 0;  // resting on it is no crack
    if (a == PointStatus::precrack) return on_support ? Kind::intact : Kind::precrack;
    if (a == PointStatus::broken && b == PointStatus::broken) return Kind::broken;
    return a == PointStatus::intact && b == PointStatus::intact ? Kind::intact : Kind::damaged;
}

std::vector<Index> interfaces_of(const Frame& frame, Kind kind) {
    std::vector<Index> found;
    for (Index i = 0; i < frame.n_interfaces(); ++i)
        if (kind_of(frame, i) == kind) found.push_back(i);
    return found;
}

double mean_cohesion(const Frame& frame, Index i) { return mean(frame.cohesion, i); }

const std::vector<CrackColour>& crack_colours() {
    static const std::vector<CrackColour> colours{
        {.name = "opening", .quantity = "opening", .unit = "m"},
        {.name = "slip", .quantity = "slip", .unit = "m", .precracks = true},
        {.name = "beta", .quantity = "cohesion β", .unit = "", .damaged = true, .falls = true, .range = ColourRange{0, 1}, .map = ColourMap::fading()},
        {.name = "mode", .quantity = "mode at breaking: 0 opened (I), 1 slid (II)", .unit = "", .needs_breaks = true, .range = ColourRange{0, 1}},
        {.name = "break_time", .quantity = "time of breaking", .unit = "s", .needs_breaks = true, .map = ColourMap::plasma()},
    };
    return colours;
}

const CrackColour& crack_colour(const std::string& name) {
    const auto found = std::find_if(crack_colours().begin(), crack_colours().end(), [&](const CrackColour& c) { return c.name == name; });
    if (found != crack_colours().end()) return *found;
    std::string known;
    for (const CrackColour& colour : crack_colours()) known += (known.empty() ? "" : ", ") + colour.name;
    throw UserError("figure-colour", "`" + name + "` is nothing cracks can be coloured by", "known: " + known);
}

std::vector<double> crack_values(const CrackColour& colour, const Frame& frame, const History* breaks) {
    std::vector<double> values(frame.n_interfaces(), unknown);
    std::optional<BreakFinder> finder;
    if (colour.needs_breaks && breaks != nullptr && !breaks->columns.empty()) finder.emplace(*breaks, colour.name == "mode" ? "shear" : "time", frame.length_scale);
    for (Index i = 0; i < frame.n_interfaces(); ++i) {
        if (!has_colour(colour, kind_of(frame, i))) continue;
        const Vec2 a = frame.end_position[2 * i], b = frame.end_position[2 * i + 1];
        if (colour.name == "opening") values[i] = std::max(0.0, mean(frame.opening, i));
        if (colour.name == "slip") values[i] = 0.5 * (std::abs(frame.slip[2 * i]) + std::abs(frame.slip[2 * i + 1]));
        if (colour.name == "beta") values[i] = mean(frame.cohesion, i);
        // of second order the middle of the interface is an end of its halves
        for (const Vec2& middle : {Vec2(0.5 * (a + b)), a, b})
            if (finder && !std::isfinite(values[i])) values[i] = (*finder)(middle);
    }
    return values;
}

}  // namespace knap
