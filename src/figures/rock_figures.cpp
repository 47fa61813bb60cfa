#include "figures/rock_figures.hpp"

#include "analysis/breaks.hpp"
#include "analysis/specimen.hpp"
#include "analysis/strength.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

using Column = std::vector<double>;

Column percent(Column values) {
    for (double& value : values) value *= 100;
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
    // the axis is that of the axial curve, and as much on the other side: beyond it is fragments that fly
    double largest = 0;
    for (const double strain : axial)
        if (std::isfinite(strain)) largest = std::max(largest, 100 * std::abs(strain));
    if (largest > 0) chart.x_within = {-largest, largest};
    for (const auto& [name, label] : {std::pair{"axial_strain", "axial"}, std::pair{"lateral_strain", "lateral"}, std::pair{"volumetric_strain", "volumetric"}})
        if (stress_strain.has(name)) chart.curves.push_back({label, percent(stress_strain.column(name)), stress, curve_colour(chart.curves.size())});
    const Strength strength = strength_of(stress_strain, SpecimenOptions{}.modulus_between);
    chart.curves.push_back({.label = "peak", .x = {100 * strength.peak_strain}, .y = {strength.peak_stress}, .colour = black, .width = 0, .marker = Marker::diamond});
    for (const Level& level : {Level{"crack initiation", strength.crack_initiation, true}, Level{"dilatancy", strength.dilatancy, true},
                               Level{"crack damage", strength.crack_damage, true}})
        if (std::isfinite(level.y)) chart.levels.push_back(level);
    std::sort(chart.levels.begin(), chart.levels.end(), [](const Level& a, const Level& b) { return a.y < b.y; });
    // of levels that lie on each other one name is left
    for (std::size_t i = 1; i < chart.levels.size();) {
        if (chart.levels[i].y - chart.levels[i - 1].y >= 0.02 * strength.peak_stress) {
            ++i;
            continue;
        }
        chart.levels[i - 1].label += ", " + chart.levels[i].label;
        chart.levels.erase(chart.levels.begin() + static_cast<std::ptrdiff_t>(i));
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
