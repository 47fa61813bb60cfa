// The quantities that colour a figure of the body.
#include "base/error.hpp"
#include "base/text.hpp"
#include "figures/body_figures.hpp"
#include "output/outputs.hpp"

#include <algorithm>
#include <array>
#include <map>

namespace knap {
namespace {

template <class Values>
Vec2 corner_mean(const Values& values, Index t) {
    return (values[3 * t] + values[3 * t + 1] + values[3 * t + 2]) / 3;
}

/// Over the two ends of an interface.
double end_mean(const std::vector<double>& values, Index i) { return 0.5 * (values[2 * i] + values[2 * i + 1]); }

ColourScale with_range(ColourScale scale, const FigureOptions& options, const ValueSpan& values, Limits range) {
    if (options.range.size() == 2) range = {options.range[0], options.range[1]};
    scale.low = range.low, scale.high = range.high;
    scale.more_below = values.min < range.low;
    scale.more_above = values.max > range.high;
    return scale;
}

}  // namespace

const std::vector<BodyField>& body_fields() {
    using F = const Frame&;
    static const std::vector<BodyField> fields{
        {"displacement", "displacement |u|", "m", false,
         [](F f, Index t) { return corner_mean(f.displacement, t).norm(); }},
        {"displacement_x", "displacement u_{x}", "m", true,
         [](F f, Index t) { return corner_mean(f.displacement, t).x(); }},
        {"displacement_y", "displacement u_{y}", "m", true,
         [](F f, Index t) { return corner_mean(f.displacement, t).y(); }},
        {"speed", "speed |v|", "m/s", false, [](F f, Index t) { return corner_mean(f.velocity, t).norm(); }},
        {"velocity_x", "velocity v_{x}", "m/s", true, [](F f, Index t) { return corner_mean(f.velocity, t).x(); }},
        {"velocity_y", "velocity v_{y}", "m/s", true, [](F f, Index t) { return corner_mean(f.velocity, t).y(); }},
        {"stress_xx", "stress σ_{xx}", "Pa", true, [](F f, Index t) { return f.stress[t][0]; }},
        {"stress_yy", "stress σ_{yy}", "Pa", true, [](F f, Index t) { return f.stress[t][1]; }},
        {"stress_xy", "stress σ_{xy}", "Pa", true, [](F f, Index t) { return f.stress[t][2]; }},
        {"von_mises", "von Mises stress", "Pa", false, von_mises},
        {"max_shear", "maximum shear stress", "Pa", false, max_shear},
        {"temperature", "temperature T", "K", false,
         [](F f, Index t) {
             if (f.temperature.empty())
                 throw UserError("no-heat", "a figure shows `temperature`, and the run has none", "[heat]");
             return (f.temperature[3 * t] + f.temperature[3 * t + 1] + f.temperature[3 * t + 2]) / 3;
         },
         [](F f, Index c) { return f.temperature[c]; }, FigureNeed::heat},
        {"principal_stress", "largest principal stress σ_{1}", "Pa", false,
         [](F f, Index t) { return largest_principal(f.stress[t]); }},
    };
    return fields;
}

const BodyField* body_field(const std::string& show) {
    const auto found = std::ranges::find(body_fields(), show, &BodyField::name);
    return found == body_fields().end() ? nullptr : &*found;
}

InterfaceStatus drawn_status(const Frame& frame, Index i) {
    const InterfaceStatus status = frame.status_of_interface(i);
    return status == InterfaceStatus::precrack && frame.on_support(i) ? InterfaceStatus::intact : status;
}

const std::vector<CrackColour>& crack_colours() {
    using F = const Frame&;
    static const std::vector<CrackColour> colours{
        {.name = "opening",
         .quantity = "opening",
         .unit = "m",
         .value = [](F f, Index i) { return std::max(0.0, end_mean(f.opening, i)); }},
        {.name = "slip",
         .quantity = "slip",
         .unit = "m",
         .value = [](F f, Index i) { return 0.5 * (std::abs(f.slip[2 * i]) + std::abs(f.slip[2 * i + 1])); },
         .precracks = true},
        {.name = "beta",
         .quantity = "cohesion β",
         .unit = "",
         .value = [](F f, Index i) { return end_mean(f.cohesion, i); },
         .damaged = true,
         .smallest_last = true,
         .range = Limits{0, 1},
         .map = ColourMap::fading},
        {.name = "mode",
         .quantity = "mode of breaking: 0 opening (I), 1 sliding (II)",
         .unit = "",
         .column = "shear",
         .range = Limits{0, 1}},
        {.name = "break_time", .quantity = "time of breaking", .unit = "s", .column = "time"},
    };
    return colours;
}

const CrackColour& crack_colour(const std::string& name) {
    std::vector<std::string> names;
    for (const CrackColour& colour : crack_colours()) {
        if (colour.name == name) return colour;
        names.push_back(colour.name);
    }
    throw UserError("figure-colour", "`" + name + "` is not a quantity that colours cracks", "known: " + joined(names));
}

std::vector<double> crack_values(const CrackColour& colour, const Frame& frame, const History& breaks) {
    // an interface is found in breaks.csv by the cell of its middle
    const double size = 1e-6 * frame.length_scale;  // [m] of a cell
    const auto cell = [&](const Vec2& x) { return std::array{std::floor(x.x() / size), std::floor(x.y() / size)}; };
    std::map<std::array<double, 2>, double> of_break;
    if (!colour.value && !breaks.columns.empty()) {
        const std::vector<double> x = breaks.column("x"), y = breaks.column("y"), value = breaks.column(colour.column);
        for (std::size_t i = 0; i < x.size(); ++i) of_break.emplace(cell({x[i], y[i]}), value[i]);
    }
    std::vector<double> values(frame.n_interfaces(), NAN);
    for (Index i = 0; i < frame.n_interfaces(); ++i) {
        const InterfaceStatus status = drawn_status(frame, i);
        const bool coloured = status == InterfaceStatus::broken ||
                              (status == InterfaceStatus::damaged && colour.damaged) ||
                              (status == InterfaceStatus::precrack && colour.precracks);
        if (coloured && colour.value) values[i] = colour.value(frame, i);
        if (!coloured || of_break.empty()) continue;
        const Vec2 a = frame.end_position[2 * i], b = frame.end_position[2 * i + 1];
        for (const Vec2& middle : {a, b, Vec2(0.5 * (a + b))})  // that of second order is an end of its halves
            for (const double dx : {-0.25, 0.25})               // it may lie close to the border of its cell
                for (const double dy : {-0.25, 0.25})
                    if (const auto found = of_break.find(cell(middle + size * Vec2(dx, dy))); found != of_break.end())
                        values[i] = found->second;
    }
    return values;
}

ColourScale field_scale(const FigureOptions& options, const Frame& frame, const ValueSpan& values) {
    const BodyField& field = *body_field(options.show);
    double low = values.low, high = values.high;
    if (field.is_signed) {  // the values of the other sign may be those of a few large triangles: no outliers
        low = std::min(low, std::max(values.min, -values.high));
        high = std::max(high, std::min(values.max, -values.low));
    }
    return with_range({.map = field.is_signed ? ColourMap::diverging : ColourMap::viridis,
                       .quantity = field.quantity,
                       .unit = unit_of_temperature(field.unit, frame.celsius) == "C" ? "°C" : field.unit,
                       .about_zero = field.is_signed},
                      options, values, round_limits(low, high, field.is_signed));
}

ColourScale crack_scale(const FigureOptions& options, const ValueSpan& values) {
    const CrackColour& colour = crack_colour(options.colour);
    Limits range = round_limits(values.low, values.high, false);
    if (colour.unit == "m") range = {0, values.high > 0 ? range.high : 1e-6};  // openings and slips start at zero
    return with_range({.map = colour.map, .quantity = colour.quantity, .unit = colour.unit}, options, values,
                      colour.range.value_or(range));
}

ColourScale path_scale(const FigureOptions& options, const ValueSpan& values) {
    return with_range({.map = ColourMap::plasma, .quantity = "speed of the centre", .unit = "m/s"}, options, values,
                      {0, values.high > 0 ? round_limits(0, values.high, false).high : 1});
}

std::vector<PiecePath> piece_paths(const Histories& histories, double until) {
    const bool of_sweep = histories.fragment_paths.columns.empty();  // output.trajectories
    const History& table = of_sweep ? histories.trajectories : histories.fragment_paths;
    std::map<double, PiecePath> paths;  // by label; of an obstacle -1 - its number
    if (table.columns.empty()) return {};
    const std::size_t time = table.place_of("time"), label = table.place_of("label"),
                      x = table.place_of(of_sweep ? "x" : "centre_x"), y = table.place_of(of_sweep ? "y" : "centre_y"),
                      first = table.place_of(of_sweep ? "speed" : "velocity_x");
    for (const std::vector<double>& row : table.rows) {
        if (row[time] > until * (1 + 1e-9)) continue;
        const bool of_obstacle = std::isnan(row[label]);
        PiecePath& path = paths[of_obstacle ? -1 - row[table.place_of("obstacle")] : row[label]];
        path.at.emplace_back(row[x], row[y]);
        path.speed.push_back(of_sweep ? row[first] : std::hypot(row[first], row[table.place_of("velocity_y")]));
    }
    std::vector<PiecePath> all;
    for (auto& [key, path] : paths) all.push_back(std::move(path));
    return all;
}

Colour material_colour(std::int32_t region, std::int32_t grain) {
    static constexpr double palette[][3]{{0.80, 0.80, 0.78}, {0.94, 0.72, 0.62}, {0.62, 0.78, 0.90},
                                         {0.80, 0.86, 0.60}, {0.93, 0.84, 0.55}, {0.80, 0.70, 0.88},
                                         {0.58, 0.86, 0.78}, {0.93, 0.68, 0.80}};
    const auto& c = palette[static_cast<std::size_t>(region) % std::size(palette)];
    const std::uint32_t mixed = static_cast<std::uint32_t>(grain) * 2654435769u;  // Fibonacci hashing
    const double shade = grain < 0 ? 1 : 0.86 + 0.05 * static_cast<double>(mixed >> 30);
    return {shade * c[0], shade * c[1], shade * c[2]};
}

}  // namespace knap
