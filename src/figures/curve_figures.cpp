#include "figures/curve_figures.hpp"

#include "analysis/breaks.hpp"
#include "analysis/energy_ledger.hpp"
#include "analysis/specimen.hpp"
#include "analysis/strength.hpp"

#include <algorithm>
#include <numeric>

namespace knap {
namespace {

const Colour blue = curve_colour(0), vermilion = curve_colour(1);
constexpr Colour light_grey{0.75, 0.75, 0.75};
constexpr double visible = 1e-3;  // of the largest value

using Column = std::vector<double>;

Column scaled(Column values, double factor) {
    for (double& value : values) value *= factor;
    return values;
}

double largest(const Column& values) {
    return std::accumulate(values.begin(), values.end(), 0.,
                           [](double a, double b) { return std::max(a, std::abs(b)); });
}

Chart over_time(const char* title, const char* quantity, const char* unit) {
    return {.title = title, .x_quantity = "time", .x_unit = "s", .y_quantity = quantity, .y_unit = unit};
}

/// Components of the loads or probes of a table: "_u_x" ends the name of the column, "u_{x}" stands in the legend.
struct Component {
    std::string ending, symbol;
};

/// Curves over time of all visible components. The colour stands for the load or probe and the line pattern for the
/// component, as long as there are enough patterns.
/// `over`: end of the name of the abscissa of each load or probe; without it the time.
void add_components(Chart& chart, const History& table, const std::vector<Component>& components,
                    const std::string& over = "") {
    struct Found {
        std::size_t name;
        const Component* component;
        Column values;
    };
    std::vector<std::string> names;
    std::vector<Found> found;
    double max = 0;
    for (const std::string& column : table.columns)
        for (const Component& component : components) {
            if (!column.ends_with(component.ending)) continue;
            const std::string name = column.substr(0, column.size() - component.ending.size());
            if (names.empty() || names.back() != name) names.push_back(name);
            found.push_back({names.size() - 1, &component, table.column(column)});
            max = std::max(max, largest(found.back().values));
        }
    std::erase_if(found, [&](const Found& f) { return largest(f.values) < visible * max; });
    std::vector<const Component*> shown;
    for (const Component& component : components)
        if (std::ranges::count(found, &component, &Found::component) > 0) shown.push_back(&component);
    const std::size_t rounds = (names.size() + n_curve_colours - 1) / n_curve_colours;
    const bool paired = shown.size() * rounds <= n_line_patterns;
    for (const Found& f : found) {
        const std::size_t i = chart.curves.size(),
                          pattern = static_cast<std::size_t>(std::ranges::find(shown, f.component) - shown.begin()) +
                                    shown.size() * (f.name / n_curve_colours);
        chart.curves.push_back({.label = names[f.name] + ", " + f.component->symbol,
                                .x = table.column(over.empty() ? "time" : names[f.name] + over),
                                .y = f.values,
                                .colour = curve_colour(paired ? f.name : i),
                                .dash = paired ? static_cast<int>(pattern) : curve_dash(i)});
    }
}

Chart components_over_time(const char* title, const char* quantity, const char* unit, const History& table,
                           const std::vector<Component>& components) {
    Chart chart = over_time(title, quantity, unit);
    add_components(chart, table, components);
    return chart;
}

/// A sum that rises at each x, from `start` to `end`.
Curve staircase(const std::string& label, const Column& x, const Column& rise, const Colour& colour, double start,
                double end) {
    Curve curve{.label = label, .x = {start}, .y = {0}, .colour = colour};
    for (std::size_t i = 0; i < x.size(); ++i) {
        curve.x.insert(curve.x.end(), 2, x[i]);
        curve.y.insert(curve.y.end(), {curve.y.back(), curve.y.back() + rise[i]});
    }
    curve.x.push_back(end);
    curve.y.push_back(curve.y.back());
    return curve;
}

}  // namespace

Chart energy_chart(const History& energy) {
    // Solid and dotted: physical terms, dashed: errors of the numerical scheme; losses are positive. Their sum equals
    // what was supplied, the energy at the start with the external and thermal work, to rounding.
    const Column time = energy.column("time");
    const auto column = [&](const std::string& name, double sign) {
        return energy.has(name) ? scaled(energy.column(name), sign) : Column(time.size(), 0.);
    };
    Column sum(time.size(), 0.), work = column("external_work", 1);
    const double start = time.empty() ? 0 : column("kinetic", 1).front() + column("strain", 1).front();
    const bool thermal = energy.has("thermal_work");
    const Column warmed = column("thermal_work", 1);
    for (std::size_t i = 0; i < work.size(); ++i) work[i] += start + warmed[i];
    const std::string supplied = thermal ? "external + thermal work" : "external work";
    Chart chart = over_time("Energy", "energy", "J");
    // a wide pale line below the dashed one: where they separate, the balance does not close
    chart.curves = {{"sum of all", time, {}, light_grey, 4},
                    {(start > 0 ? "start + " : "") + supplied, time, work, black, 1.4, 1}};
    if (thermal && largest(column("external_work", 1)) > visible * largest(work))
        chart.curves.push_back({"of it thermal work", time, warmed, vermilion, 1.6, 2});
    for (const EnergyTerm& term : energy_terms()) {
        if (term.use.drawn == 0) continue;
        const bool older = term.name == "dissipated" && !energy.has("dissipated");  // runs with the recoverable in it
        const std::string name = older ? "surface" : std::string(term.name);
        const Column values = column(name, term.use.drawn);
        std::ranges::transform(sum, values, sum.begin(), std::plus<>());
        if (term.use.always || largest(values) > visible * largest(work))
            chart.curves.push_back({older ? name : term.use.label, time, values,
                                    curve_colour(static_cast<std::size_t>(term.use.colour)), 1.6, term.use.dash});
    }
    chart.curves[0].y = sum;
    return chart;
}

Chart crack_length_chart(const History& cracks) {
    Chart chart = over_time("Crack length", "length", "m");
    const auto add = [&](const char* label, const char* column, const Colour& colour) {
        if (cracks.has(column)) chart.curves.push_back({label, cracks.column("time"), cracks.column(column), colour});
    };
    add("main crack", "main_length", black);
    add("all arms", "crack_length", blue);
    add("broken edges", "broken_length", vermilion);
    return chart;
}

Chart crack_speed_chart(const History& cracks, double rayleigh_speed) {
    Chart chart = over_time("Crack speed", "speed of the main tip", "m/s");
    chart.curves = {{"speed", cracks.column("time"), cracks.column("tip_speed"), blue, 1.4}};
    if (rayleigh_speed > 0) chart.levels = {{"0.65 c_{R}", 0.65 * rayleigh_speed}, {"c_{R}", rayleigh_speed}};
    return chart;
}

Chart reaction_chart(const History& reactions, bool at_times) {
    if (at_times) {
        return components_over_time("Reactions", "force", "N", reactions,
                                    {{"_force_x", "F_{x}"}, {"_force_y", "F_{y}"}});
    }
    Chart chart{.title = "Force and displacement",
                .x_quantity = "displacement",
                .x_unit = "m",
                .y_quantity = "force",
                .y_unit = "N"};
    const std::string ending = "_force_x";
    bool any_moves = false;
    for (const std::string& column : reactions.columns) {
        if (!column.ends_with(ending)) continue;
        const std::string load = column.substr(0, column.size() - ending.size());
        const auto range = [&](const char* component) {
            const Column u = reactions.column(load + component);
            return u.empty() ? 0 : std::ranges::max(u) - std::ranges::min(u);
        };
        const double x = range("_u_x"), y = range("_u_y");
        const bool moves = x > 0 || y > 0;
        if (any_moves && !moves) continue;
        if (moves && !any_moves) chart.curves.clear();
        any_moves = any_moves || moves;
        const std::string axis = y > x ? "y" : "x";
        const std::size_t i = chart.curves.size();
        chart.curves.push_back({.label = load + ", F_{" + axis + "}",
                                .x = reactions.column(load + "_u_" + axis),
                                .y = reactions.column(load + "_force_" + axis),
                                .colour = curve_colour(i),
                                .dash = curve_dash(i)});
    }
    return chart;
}

Chart probe_chart(const History& probes, bool over_temperature, bool celsius) {
    const auto ends = [&](const char* ending) {
        return std::ranges::any_of(probes.columns, [&](const std::string& name) { return name.ends_with(ending); });
    };
    if (!ends("_u_x") && !ends("_opening") && ends("_K_I")) return tip_chart(probes);  // all watch tips
    Chart chart = over_time("Displacement", "displacement", "m");
    std::vector<Component> components{{"_u_x", "u_{x}"}, {"_u_y", "u_{y}"}};
    if (over_temperature) {
        chart.x_quantity = "temperature T", chart.x_unit = celsius ? "°C" : "K";
        add_components(chart, probes, components, "_T");
        return chart;
    }
    components.insert(components.end(), {{"_opening", "opening"}, {"_slip", "slip"}});
    add_components(chart, probes, components);
    return chart;
}

Chart probe_velocity_chart(const History& probes) {
    return components_over_time("Velocity", "velocity", "m/s", probes, {{"_v_x", "v_{x}"}, {"_v_y", "v_{y}"}});
}

Chart probe_stress_chart(const History& probes) {
    return components_over_time(
        "Mean stress", "mean stress", "Pa", probes,
        {{"_stress_xx", "\u03c3_{xx}"}, {"_stress_yy", "\u03c3_{yy}"}, {"_stress_xy", "\u03c3_{xy}"}});
}

Chart tip_chart(const History& probes) {
    return components_over_time("Stress intensity factors", "stress intensity factor", "Pa√m", probes,
                                {{"_K_I", "K_{I}"}, {"_K_II", "K_{II}"}});
}

Chart fluid_pressure_chart(const History& fluids) {
    return components_over_time("Pressure of fluids in cracks", "pressure", "Pa", fluids, {{"_pressure", "p"}});
}

Chart fluid_volume_chart(const History& fluids) {
    return components_over_time("Volume of fluids in cracks", "volume", "m3", fluids,
                                {{"_volume", "in cracks"}, {"_injected", "injected"}});
}

Chart fluid_length_chart(const History& fluids) {
    return components_over_time("Cracks that fluids fill", "length", "m", fluids,
                                {{"_length", "length"}, {"_sharp_crack", "sharp crack"}});
}

Chart stress_strain_chart(const History& stress_strain) {
    Chart chart{.title = "Stress and strain", .x_quantity = "strain [%]", .y_quantity = "stress", .y_unit = "Pa"};
    // the axis extends as far as the axial strain, in both directions: larger strains are those of flying fragments
    double max_strain = 0;
    for (const double strain : stress_strain.column("axial_strain"))
        if (std::isfinite(strain)) max_strain = std::max(max_strain, 100 * std::abs(strain));
    if (max_strain > 0) chart.x_within = {-max_strain, max_strain};
    for (const char* label : {"axial", "lateral", "volumetric"})
        if (const std::string column = std::string(label) + "_strain"; stress_strain.has(column))
            chart.curves.push_back({label, scaled(stress_strain.column(column), 100), stress_strain.column("stress"),
                                    curve_colour(chart.curves.size())});
    const Strength strength = strength_of(stress_strain, SpecimenOptions{}.modulus_between);
    if (std::isfinite(strength.strength))  // a stress that still rises at the end has no peak
        chart.curves.push_back({.label = "peak",
                                .x = {100 * strength.peak_strain},
                                .y = {strength.strength},
                                .colour = black,
                                .width = 0,
                                .marker = Marker::diamond});
    std::vector<Level> levels{{"crack initiation", strength.crack_initiation, true},
                              {"dilatancy", strength.dilatancy, true},
                              {"crack damage", strength.crack_damage, true}};
    std::erase_if(levels, [](const Level& level) { return !std::isfinite(level.y); });
    std::ranges::sort(levels, {}, &Level::y);
    for (const Level& level : levels)  // levels at nearly the same stress share a line
        if (!chart.levels.empty() && level.y - chart.levels.back().y < 0.02 * strength.peak_stress)
            chart.levels.back().label += ", " + level.label;
        else chart.levels.push_back(level);
    return chart;
}

Chart break_chart(const History& breaks, double start, double end) {
    Chart chart = over_time("Breaks", "broken interfaces", "");
    const Column time = breaks.column("time"), shear = breaks.column("shear");
    Column all(time.size(), 1.), tensile, sheared;
    for (const double s : shear) tensile.push_back(!is_shear(s)), sheared.push_back(is_shear(s));
    chart.curves = {staircase("all", time, all, black, start, end),
                    staircase("tension", time, tensile, blue, start, end),
                    staircase("shear", time, sheared, vermilion, start, end)};
    return chart;
}

Chart fragment_size_chart(const History& fragments) {
    Chart chart{.title = "Fragment sizes",
                .x_quantity = "diameter of the circle of equal area",
                .x_unit = "m",
                .y_quantity = "mass passing [%]",
                .x_logarithmic = true};
    const Column diameter = fragments.column("diameter"), mass = fragments.column("mass_part");
    std::vector<std::pair<double, double>> sizes;
    for (std::size_t i = 0; i < diameter.size(); ++i) sizes.emplace_back(diameter[i], 100 * mass[i]);
    std::ranges::sort(sizes);
    Column x, rise;
    for (const auto& [d, percent] : sizes) x.push_back(d), rise.push_back(percent);
    if (!x.empty()) chart.curves = {staircase("passing", x, rise, blue, x.front() / 1.2, x.back() * 1.2)};
    return chart;
}

}  // namespace knap
