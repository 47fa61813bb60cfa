#include "observe/rock_figures.hpp"

#include "observe/breaks.hpp"
#include "observe/specimen.hpp"
#include "observe/strength.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

using Column = std::vector<double>;

Column percent(Column values) {
    for (double& value : values) value *= 100;
    return values;
}

/// Without what lies beyond `limit`.
Column within(Column values, double limit) {
    for (double& value : values)
        if (std::abs(value) > limit) value = std::nan("");
    return values;
}

/// A count that goes up by `rise` at each x.
Curve staircase(const std::string& label, const Column& x, const Column& rise, const Colour& colour, double first, double last) {
    Curve curve{.label = label, .x = {first}, .y = {0}, .colour = colour};
    double sum = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        curve.x.insert(curve.x.end(), 2, x[i]);
        curve.y.push_back(sum);
        curve.y.push_back(sum += rise[i]);
    }
    curve.x.push_back(last);
    curve.y.push_back(sum);
    return curve;
}

}  // namespace

Chart stress_strain_chart(const History& stress_strain) {
    Chart chart{.title = "Stress and strain", .x_quantity = "strain [%]", .y_quantity = "stress", .y_unit = "Pa"};
    const Column stress = stress_strain.column("stress"), axial = stress_strain.column("axial_strain");
    double largest = 0;
    for (const double strain : axial) largest = std::max(largest, std::abs(strain));
    // beyond three times the largest axial strain it is fragments that fly, and the rest would be a line beside them
    for (const auto& [name, label] : {std::pair{"axial_strain", "axial"}, std::pair{"lateral_strain", "lateral"}, std::pair{"volumetric_strain", "volumetric"}})
        if (stress_strain.has(name)) chart.curves.push_back({label, percent(within(stress_strain.column(name), 3 * largest)), stress, curve_colour(chart.curves.size())});
    const Strength strength = strength_of(stress_strain, SpecimenOptions{}.modulus_between);
    chart.curves.push_back({.label = "peak", .x = {100 * strength.peak_strain}, .y = {strength.peak_stress}, .colour = black, .width = 0, .marker = Marker::diamond});
    // names of levels that lie close would lie over each other
    double last = -1;
    std::vector<Level> levels{{"crack initiation", strength.crack_initiation, true}, {"dilatancy", strength.dilatancy, true}, {"crack damage", strength.crack_damage, true}};
    std::sort(levels.begin(), levels.end(), [](const Level& a, const Level& b) { return a.y < b.y; });
    for (const Level& level : levels) {
        if (!std::isfinite(level.y)) continue;
        if (last >= 0 && level.y - last < 0.06 * strength.peak_stress) chart.levels.back().label += ", " + level.label;
        else chart.levels.push_back(level), last = level.y;
    }
    return chart;
}

Chart break_chart(const History& breaks, double begin, double end) {
    Chart chart{.title = "Breaks", .x_quantity = "time", .x_unit = "s", .y_quantity = "broken interfaces"};
    const Column time = breaks.column("time"), shear = breaks.column("shear");
    Column all(time.size(), 1.0), tensile(time.size()), sheared(time.size());
    for (std::size_t i = 0; i < time.size(); ++i) tensile[i] = !is_shear(shear[i]), sheared[i] = is_shear(shear[i]);
    chart.curves = {staircase("all", time, all, black, begin, end), staircase("tension", time, tensile, curve_colour(0), begin, end),
                    staircase("shear", time, sheared, curve_colour(1), begin, end)};
    return chart;
}

Chart fragment_size_chart(const History& fragments) {
    Chart chart{.title = "Size of fragments", .x_quantity = "diameter of the circle of the same area", .x_unit = "m", .y_quantity = "mass passing [%]", .x_logarithmic = true};
    std::vector<std::pair<double, double>> sizes;  // diameter, part of the mass
    const Column diameter = fragments.column("diameter"), part = fragments.column("mass_part");
    for (std::size_t i = 0; i < diameter.size(); ++i) sizes.emplace_back(diameter[i], part[i]);
    std::sort(sizes.begin(), sizes.end());
    Column x, rise;
    for (const auto& [d, mass] : sizes) x.push_back(d), rise.push_back(100 * mass);
    if (!x.empty()) chart.curves = {staircase("passing", x, rise, curve_colour(0), x.front() / 1.2, x.back() * 1.2)};
    return chart;
}

}  // namespace knap
