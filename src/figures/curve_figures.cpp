#include "figures/curve_figures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <set>

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

/// What a table has of each of its loads or probes.
struct Component {
    const char *ending, *symbol;  // of the column, in the key
};

/// All components that can be seen beside the largest: whose it is by colour, which one by the pattern, as far as there are patterns.
void add_components(Chart& chart, const History& table, const std::vector<Component>& components) {
    struct Found {
        std::size_t name, component;
        Column values;
    };
    std::vector<std::string> names;
    std::vector<Found> found;
    double visible = 0;
    for (const std::string& column : table.columns)
        for (std::size_t c = 0; c < components.size(); ++c) {
            if (!column.ends_with(components[c].ending)) continue;
            const std::string name = column.substr(0, column.size() - std::string(components[c].ending).size());
            if (names.empty() || names.back() != name) names.push_back(name);
            found.push_back({names.size() - 1, c, table.column(column)});
            visible = std::max(visible, 1e-3 * largest(found.back().values));
        }
    std::erase_if(found, [&](const Found& f) { return largest(f.values) < visible; });
    std::set<std::size_t> shown;
    for (const Found& f : found) shown.insert(f.component);
    const std::size_t n = shown.size(), rounds = (names.size() + n_curve_colours - 1) / n_curve_colours;
    for (const Found& f : found) {
        const std::size_t i = chart.curves.size(), component = static_cast<std::size_t>(std::distance(shown.begin(), shown.find(f.component)));
        const bool paired = n * rounds <= n_line_patterns;
        chart.curves.push_back({.label = names[f.name] + ", " + components[f.component].symbol,
                                .x = table.column("time"),
                                .y = f.values,
                                .colour = curve_colour(paired ? f.name : i),
                                .dash = paired ? static_cast<int>(component + n * (f.name / n_curve_colours)) : curve_dash(i)});
    }
}

/// Names in front of `ending` among the columns.
std::vector<std::string> names_before(const History& history, const std::string& ending) {
    std::vector<std::string> names;
    for (const std::string& column : history.columns)
        if (column.ends_with(ending)) names.push_back(column.substr(0, column.size() - ending.size()));
    return names;
}

void add_curve(Chart& chart, const std::string& label, const Column& x, const Column& y) {
    const std::size_t i = chart.curves.size();
    chart.curves.push_back({.label = label, .x = x, .y = y, .colour = curve_colour(i), .dash = curve_dash(i)});
}

}  // namespace

Chart energy_chart(const History& energy) {
    // Where the work of the loads went: with the energy of the start their sum is the work, to rounding. What is physical is drawn through, what is of the
    // numbers is dashed.
    struct Part {
        const char *label, *column;
        double sign;
        Colour colour;
        int dash;
        bool always;
    };
    const bool parted = energy.has("dissipated");  // older runs have only the sum of the two
    const std::array parts{Part{"kinetic", "kinetic", 1, blue, 0, true},
                           Part{"strain", "strain", 1, orange, 0, true},
                           Part{parted ? "dissipated" : "surface", parted ? "dissipated" : "surface", 1, vermilion, 0, true},
                           Part{"recoverable", "recoverable", 1, green, 0, false},
                           Part{"lost in friction", "friction_work", -1, purple, 0, false},
                           Part{"lost in impact", "impact_work", -1, sky, 0, false},
                           Part{"law lag", "law_lag_energy", 1, vermilion, 1, false},
                           Part{"crossing loss", "crossing_loss_energy", 1, purple, 1, false},
                           Part{"damped by the scheme", "scheme_dissipation", 1, green, 1, false},
                           Part{"lost in changes of step", "step_change_work", -1, blue, 1, false}};
    std::vector<Column> values;
    for (const Part& part : parts) values.push_back(part.sign > 0 ? column_or_zero(energy, part.column) : negated(column_or_zero(energy, part.column)));

    const Column time = energy.column("time");
    // a body that moves or is loaded at the start has energy before any work is done
    const double start = time.empty() ? 0 : values[0].front() + values[1].front();
    Column given = column_or_zero(energy, "external_work");
    for (double& work : given) work += start;
    Chart chart{.title = "Energy", .x_quantity = "time", .x_unit = "s", .y_quantity = "energy", .y_unit = "J"};
    // the sum lies broad and pale below the dashed work of the loads: one look tells whether the balance closes
    chart.curves.push_back({"sum of all", time, sum(values), light_grey, 4});
    chart.curves.push_back({start > 0 ? "start + external work" : "external work", time, given, black, 1.4, 1});
    const double visible = 1e-3 * largest(given);  // what would lie on the axis is left out
    for (std::size_t i = 0; i < parts.size(); ++i)
        if (parts[i].always || largest(values[i]) > visible) chart.curves.push_back({parts[i].label, time, values[i], parts[i].colour, 1.6, parts[i].dash});
    return chart;
}

Chart crack_length_chart(const History& cracks) {
    const Column time = cracks.column("time");
    Chart chart{.title = "Crack length", .x_quantity = "time", .x_unit = "s", .y_quantity = "length", .y_unit = "m"};
    const auto add = [&](const char* label, const char* name, const Colour& colour) {
        if (cracks.has(name)) chart.curves.push_back({label, time, cracks.column(name), colour});
    };
    add("main crack", "main_length", black);
    add("all arms", "crack_length", blue);
    add("broken edges", "broken_length", vermilion);
    return chart;
}

Chart crack_speed_chart(const History& cracks, double rayleigh_speed) {
    Chart chart{.title = "Crack speed", .x_quantity = "time", .x_unit = "s", .y_quantity = "speed of the main tip", .y_unit = "m/s"};
    chart.curves.push_back({"speed", cracks.column("time"), cracks.column("tip_speed"), blue, 1.4});
    if (rayleigh_speed > 0) chart.levels = {{"0.65 c_{R}", 0.65 * rayleigh_speed}, {"c_{R}", rayleigh_speed}};
    return chart;
}

Chart reaction_chart(const History& reactions, bool over_time) {
    Chart chart{.title = "Force and displacement", .x_quantity = "displacement", .x_unit = "m", .y_quantity = "force", .y_unit = "N"};
    if (over_time) chart.title = "Reactions", chart.x_quantity = "time", chart.x_unit = "s";
    const std::vector<std::string> loads = names_before(reactions, "_force_x");
    const auto moves = [&](const std::string& load) { return range(reactions.column(load + "_u_x")) > 0 || range(reactions.column(load + "_u_y")) > 0; };
    if (over_time) {  // also of what stands still, in both directions, where it can be seen
        add_components(chart, reactions, {{"_force_x", "F_{x}"}, {"_force_y", "F_{y}"}});
        return chart;
    }
    const bool any_moves = std::any_of(loads.begin(), loads.end(), moves);
    for (const std::string& load : loads) {
        if (any_moves && !moves(load)) continue;
        const std::string axis = range(reactions.column(load + "_u_y")) > range(reactions.column(load + "_u_x")) ? "_y" : "_x";
        add_curve(chart, load + (axis == "_x" ? ", F_{x}" : ", F_{y}"), reactions.column(load + "_u" + axis), reactions.column(load + "_force" + axis));
    }
    return chart;
}

Chart probe_chart(const History& probes) {
    Chart chart{.title = "Displacement", .x_quantity = "time", .x_unit = "s", .y_quantity = "displacement", .y_unit = "m"};
    add_components(chart, probes, {{"_u_x", "u_{x}"}, {"_u_y", "u_{y}"}, {"_opening", "opening"}, {"_slip", "slip"}});
    return chart;
}

Chart probe_velocity_chart(const History& probes) {
    Chart chart{.title = "Velocity", .x_quantity = "time", .x_unit = "s", .y_quantity = "velocity", .y_unit = "m/s"};
    add_components(chart, probes, {{"_v_x", "v_{x}"}, {"_v_y", "v_{y}"}});
    return chart;
}

}  // namespace knap
