#include "observe/curve_figures.hpp"

#include <algorithm>
#include <cmath>

namespace knap {

namespace {

const Colour blue = curve_colour(0), vermilion = curve_colour(1), green = curve_colour(2), orange = curve_colour(3), purple = curve_colour(4), sky = curve_colour(5);
constexpr Colour light_grey{0.75, 0.75, 0.75};

using Column = std::vector<double>;

Column column_or_zero(const History& history, const std::string& name) {
    return history.has(name) ? history.column(name) : Column(history.rows.size(), 0.0);
}

double largest(const Column& values) {
    double found = 0;
    for (const double v : values) found = std::max(found, std::abs(v));
    return found;
}

Column negated(Column values) {
    for (double& v : values) v = -v;
    return values;
}

Column sum(const std::vector<Column>& parts) {
    Column total(parts.front().size(), 0.0);
    for (const Column& part : parts)
        for (std::size_t i = 0; i < total.size(); ++i) total[i] += part[i];
    return total;
}

double range(const Column& values) {
    if (values.empty()) return 0;
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    return *high - *low;
}

/// Names in front of `ending` among the columns.
std::vector<std::string> names_before(const History& history, const std::string& ending) {
    std::vector<std::string> names;
    for (const std::string& column : history.columns)
        if (column.ends_with(ending)) names.push_back(column.substr(0, column.size() - ending.size()));
    return names;
}

void add_curve(Chart& chart, const std::string& label, const Column& x, const Column& y) {
    chart.curves.push_back({label, x, y, curve_colour(chart.curves.size())});
}

}  // namespace

Chart energy_chart(const History& energy) {
    const Column time = energy.column("time"), kinetic = column_or_zero(energy, "kinetic"), strain = column_or_zero(energy, "strain"),
                 surface = column_or_zero(energy, "surface"), friction = negated(column_or_zero(energy, "friction_work")),
                 impact = negated(column_or_zero(energy, "impact_work")), damped = column_or_zero(energy, "scheme_dissipation");
    // a body that moves or is loaded at the start has energy before any work is done
    const double start = time.empty() ? 0 : kinetic.front() + strain.front();
    Column given = column_or_zero(energy, "external_work");
    for (double& work : given) work += start;
    Chart chart{.title = "Energy", .x_quantity = "time", .x_unit = "s", .y_quantity = "energy", .y_unit = "J"};
    // the sum lies broad and pale below the dashed work of the loads: one look tells whether the balance closes
    chart.curves.push_back({"sum of all", time, sum({kinetic, strain, surface, friction, impact, damped}), light_grey, 4});
    chart.curves.push_back({start > 0 ? "start + external work" : "external work", time, given, black, 1.4, true});
    chart.curves.push_back({"kinetic", time, kinetic, blue});
    chart.curves.push_back({"strain", time, strain, orange});
    chart.curves.push_back({"surface", time, surface, vermilion});
    // what would lie on the axis is left out
    const double visible = 1e-3 * largest(given);
    if (largest(friction) > visible) chart.curves.push_back({"lost in friction", time, friction, purple});
    if (largest(impact) > visible) chart.curves.push_back({"lost in impact", time, impact, sky});
    if (largest(damped) > visible) chart.curves.push_back({"damped by the scheme", time, damped, green});
    return chart;
}

Chart crack_length_chart(const History& cracks) {
    const Column time = cracks.column("time");
    Chart chart{.title = "Crack length", .x_quantity = "time", .x_unit = "s", .y_quantity = "length", .y_unit = "m"};
    const auto add = [&](const char* label, const char* name, const Colour& colour) {
        if (cracks.has(name)) chart.curves.push_back({label, time, cracks.column(name), colour});
    };
    add("main crack", "main_length", black);
    add("all branches", "crack_length", blue);
    add("broken edges", "broken_length", vermilion);
    return chart;
}

Chart crack_speed_chart(const History& cracks, double rayleigh_speed) {
    Chart chart{.title = "Crack speed", .x_quantity = "time", .x_unit = "s", .y_quantity = "speed of the main tip", .y_unit = "m/s"};
    chart.curves.push_back({"speed", cracks.column("time"), cracks.column("tip_speed"), blue, 1.4});
    if (rayleigh_speed > 0) chart.levels = {{"0.65 c_{R}", 0.65 * rayleigh_speed}, {"c_{R}", rayleigh_speed}};
    return chart;
}

Chart reaction_chart(const History& reactions) {
    Chart chart{.title = "Force and displacement", .x_quantity = "displacement", .x_unit = "m", .y_quantity = "force", .y_unit = "N"};
    const std::vector<std::string> loads = names_before(reactions, "_force_x");
    const auto moves = [&](const std::string& load) { return range(reactions.column(load + "_u_x")) > 0 || range(reactions.column(load + "_u_y")) > 0; };
    const bool any_moves = std::any_of(loads.begin(), loads.end(), moves);
    for (const std::string& load : loads) {
        if (any_moves && !moves(load)) continue;
        const std::string axis = range(reactions.column(load + "_u_y")) > range(reactions.column(load + "_u_x")) ? "_y" : "_x";
        add_curve(chart, load + axis, reactions.column(load + "_u" + axis), reactions.column(load + "_force" + axis));
    }
    return chart;
}

Chart probe_chart(const History& probes) {
    Chart chart{.title = "Displacement", .x_quantity = "time", .x_unit = "s", .y_quantity = "displacement", .y_unit = "m"};
    std::vector<std::string> shown;
    double visible = 0;
    for (const char* ending : {"_u_x", "_u_y", "_opening", "_slip"})
        for (const std::string& name : names_before(probes, ending)) {
            shown.push_back(name + ending);
            visible = std::max(visible, 1e-3 * largest(probes.column(shown.back())));
        }
    for (const std::string& name : shown)
        if (largest(probes.column(name)) >= visible) add_curve(chart, name, probes.column("time"), probes.column(name));
    return chart;
}

}  // namespace knap
