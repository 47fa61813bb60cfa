#include "figures/body_figures.hpp"

#include "figures/body_page.hpp"
#include "figures/crack_colours.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace knap {

namespace {

constexpr Colour body_colour{0.90, 0.90, 0.89}, damaged_colour{0.10, 0.38, 0.66};
constexpr double broken_width = 1.3, damaged_width = 1, precrack_width = 1, path_width = 0.6, swatch_width = 9;  // [unit]
constexpr double outside_of_cracks = 0.02, outside_of_fields = 0.005;                                            // parts of the values that a range leaves out

template <class Values>
Vec2 corner_mean(const Values& values, Index t) {
    return (values[3 * t] + values[3 * t + 1] + values[3 * t + 2]) / 3;
}

const BodyField& field_of(const std::string& name) {
    return *std::find_if(body_fields().begin(), body_fields().end(), [&](const BodyField& f) { return f.name == name; });
}

bool is_seen(const FigureOptions& options, const Frame& frame, Index corner) { return corner >= 0 && options.box->contains(deformed(frame, corner, options.deform)); }

/// Colours come from what lies inside the box.
ValueSpan field_span(const FigureOptions& options, const Frame& frame, const BodyField& field) {
    std::vector<double> values;
    for (Index t = 0; t < frame.n_triangles(); ++t)
        if (!options.box || is_seen(options, frame, 3 * t) || is_seen(options, frame, 3 * t + 1) || is_seen(options, frame, 3 * t + 2)) values.push_back(field.value(frame, t));
    return span_of(std::move(values), outside_of_fields);
}

ValueSpan crack_span(const FigureOptions& options, const Frame& frame, const std::vector<double>& of_interfaces) {
    std::vector<double> values;
    for (Index i = 0; i < frame.n_interfaces(); ++i) {
        const auto &a = frame.side_a[i], &b = frame.side_b[i];
        if (!options.box || is_seen(options, frame, a[0]) || is_seen(options, frame, a[1]) || is_seen(options, frame, b[0]) || is_seen(options, frame, b[1]))
            values.push_back(of_interfaces[i]);
    }
    return span_of(std::move(values), outside_of_cracks);
}

/// The limits asked for, or those of the quantity.
ColourScale with_range(ColourScale scale, const FigureOptions& options, const ValueSpan& values, const ColourRange& otherwise) {
    const bool given = options.range.size() == 2 && options.range[0] < options.range[1];
    scale.low = given ? options.range[0] : otherwise.low;
    scale.high = given ? options.range[1] : otherwise.high;
    scale.more_below = values.least < scale.low;
    scale.more_above = values.most > scale.high;
    return scale;
}

ColourScale field_scale(const FigureOptions& options, const ValueSpan& values) {
    const BodyField& field = field_of(options.show);
    const ColourScale scale{.map = field.is_signed ? ColourMap::diverging() : ColourMap::viridis(), .quantity = field.quantity, .unit = field.unit, .about_zero = field.is_signed};
    ValueSpan shown = values;
    if (field.is_signed) {  // few large triangles may be all that has the other sign: it is not left out
        shown.low = std::min(values.low, std::max(values.least, -values.high));
        shown.high = std::max(values.high, std::min(values.most, -values.low));
    }
    return with_range(scale, options, values, round_limits(shown.low, shown.high, field.is_signed));
}

ColourScale crack_scale(const FigureOptions& options, const ValueSpan& values) {
    const CrackColour& colour = crack_colour(options.colour);
    const ColourScale scale{.map = colour.map, .quantity = colour.quantity, .unit = colour.unit};
    ColourRange range = round_limits(values.low, values.high, false);
    if (colour.unit == "m") range = {0, values.high > 0 ? range.high : 1e-6};  // of sizes, from none on
    return with_range(scale, options, values, colour.range.value_or(range));
}

/// The paler the less damaged: a process zone is a haze, and is still seen in print.
void draw_damaged(BodyPage& page, const Frame& frame, const std::vector<Index>& damaged) {
    constexpr int n_shades = 12;
    constexpr double palest = 0.4;
    std::vector<std::vector<Index>> of_shade(n_shades);
    for (const Index i : damaged) of_shade[std::clamp(static_cast<int>((1 - mean_cohesion(frame, i)) * n_shades), 0, n_shades - 1)].push_back(i);
    for (int shade = 0; shade < n_shades; ++shade) {
        Colour colour = damaged_colour;
        colour.alpha = palest + (1 - palest) * std::min(1.0, 1.5 * (shade + 0.5) / n_shades);
        page.draw_interfaces(of_shade[shade], colour, damaged_width);
    }
}

/// Cracks as thin black lines over colours.
void draw_paths(BodyPage& page, const Frame& frame, bool on_white) {
    std::vector<Index> paths = interfaces_of(frame, Kind::broken);
    for (const Index i : interfaces_of(frame, Kind::precrack)) paths.push_back(i);
    page.draw_open_faces(interfaces_of(frame, Kind::damaged));
    if (on_white) page.draw_interfaces(paths, {1, 1, 1, 0.75}, 3 * path_width);
    page.draw_interfaces(paths, black, path_width);
}

/// Light enough for black cracks; grains of one material differ in lightness.
Colour material_colour(std::int32_t region, std::int32_t grain) {
    static const std::array<Colour, 8> palette{Colour{0.80, 0.80, 0.78}, Colour{0.94, 0.72, 0.62}, Colour{0.62, 0.78, 0.90}, Colour{0.80, 0.86, 0.60},
                                               Colour{0.93, 0.84, 0.55}, Colour{0.80, 0.70, 0.88}, Colour{0.58, 0.86, 0.78}, Colour{0.93, 0.68, 0.80}};
    Colour colour = palette[static_cast<std::size_t>(region) % palette.size()];
    if (grain < 0) return colour;
    const double shade = 0.86 + 0.05 * static_cast<double>((static_cast<std::uint32_t>(grain) * 2654435769u) >> 30);  // one of four
    return {shade * colour.red, shade * colour.green, shade * colour.blue};
}


Legend crack_legend(const FigureOptions& options, const FigureScale& scale) {
    const CrackColour& colour = crack_colour(options.colour);
    Legend legend;
    if (std::isfinite(scale.values.low)) legend.bar = crack_scale(options, scale.values);
    else legend.note = colour.needs_breaks ? "nothing has broken" : "no broken interface";
    if (!colour.precracks && scale.precracks) legend.key.push_back({"pre-crack", black, precrack_width});
    if (!colour.damaged && scale.damaged) legend.key.push_back({"damaged, not broken", damaged_colour, damaged_width});
    return legend;
}

Legend material_legend(const Frame& frame, const std::vector<std::string>& materials) {
    Legend legend;
    std::vector<std::int32_t> present = frame.region;
    std::sort(present.begin(), present.end());
    present.erase(std::unique(present.begin(), present.end()), present.end());
    for (const std::int32_t region : present) {
        const bool named = region < static_cast<std::int32_t>(materials.size());
        legend.key.push_back({named ? materials[region] : "material " + std::to_string(region), material_colour(region, -1), swatch_width});
    }
    return legend;
}

}  // namespace

const std::vector<BodyField>& body_fields() {
    static const std::vector<BodyField> fields{
        {"displacement", "displacement |u|", "m", false, [](const Frame& f, Index t) { return corner_mean(f.displacement, t).norm(); }},
        {"displacement_x", "displacement u_{x}", "m", true, [](const Frame& f, Index t) { return corner_mean(f.displacement, t).x(); }},
        {"displacement_y", "displacement u_{y}", "m", true, [](const Frame& f, Index t) { return corner_mean(f.displacement, t).y(); }},
        {"speed", "speed |v|", "m/s", false, [](const Frame& f, Index t) { return corner_mean(f.velocity, t).norm(); }},
        {"velocity_x", "velocity v_{x}", "m/s", true, [](const Frame& f, Index t) { return corner_mean(f.velocity, t).x(); }},
        {"velocity_y", "velocity v_{y}", "m/s", true, [](const Frame& f, Index t) { return corner_mean(f.velocity, t).y(); }},
        {"stress_xx", "stress σ_{xx}", "Pa", true, [](const Frame& f, Index t) { return f.stress[t][0]; }},
        {"stress_yy", "stress σ_{yy}", "Pa", true, [](const Frame& f, Index t) { return f.stress[t][1]; }},
        {"stress_xy", "stress σ_{xy}", "Pa", true, [](const Frame& f, Index t) { return f.stress[t][2]; }},
        {"principal_stress", "largest principal stress σ_{1}", "Pa", false, [](const Frame& f, Index t) { return largest_principal(f.stress[t]); }},
    };
    return fields;
}

FigureScale body_scale(const FigureOptions& options, const Frame& frame, const History* breaks) {
    FigureScale scale{.seen = seen_part(options, frame)};
    if (options.show == "cracks") {
        scale.values = crack_span(options, frame, crack_values(crack_colour(options.colour), frame, breaks));
        scale.damaged = !interfaces_of(frame, Kind::damaged).empty();
        scale.precracks = !interfaces_of(frame, Kind::precrack).empty();
    } else if (options.show != "materials") scale.values = field_span(options, frame, field_of(options.show));
    return scale;
}

Legend body_legend(const FigureOptions& options, const Frame& frame, const std::vector<std::string>& materials, const FigureScale& scale) {
    if (options.show == "cracks") return crack_legend(options, scale);
    if (options.show == "materials") return material_legend(frame, materials);
    return {.bar = field_scale(options, scale.values)};
}

DrawnFigure draw_cracks(const FigureOptions& options, const Frame& frame, const std::string& title, const std::filesystem::path& file, const BodyExtras& extras) {
    const CrackColour& colour = crack_colour(options.colour);
    const std::vector<double> values = crack_values(colour, frame, extras.breaks);
    const FigureScale own = extras.scale ? *extras.scale : body_scale(options, frame, extras.breaks);
    const ColourScale scale = crack_scale(options, own.values);
    std::vector<Index> coloured, others;
    for (Index i = 0; i < frame.n_interfaces(); ++i)
        if (std::isfinite(values[i])) coloured.push_back(i);
        else if (kind_of(frame, i) == Kind::broken) others.push_back(i);
    // what is of most interest is drawn last: the widest, or the most broken
    std::sort(coloured.begin(), coloured.end(), [&](Index a, Index b) { return colour.falls ? values[a] > values[b] : values[a] < values[b]; });
    const std::vector<Index> damaged = interfaces_of(frame, Kind::damaged);

    BodyPage page(options, frame, own.seen, title, crack_legend(options, own), file);
    page.inside_plot([&] { page.fill_obstacles(); });
    page.fill_triangles([](Index) { return body_colour; });
    page.inside_plot([&] {
        page.draw_outline();
        page.draw_open_faces(damaged);
        if (!colour.damaged) draw_damaged(page, frame, damaged);
        if (!colour.precracks) page.draw_interfaces(interfaces_of(frame, Kind::precrack), black, precrack_width);
        page.draw_interfaces(others, outline_colour, path_width);
        for (const Index i : coloured) page.draw_interfaces({i}, scale(values[i]), broken_width);
    });
    return page.finished();
}

DrawnFigure draw_field(const FigureOptions& options, const Frame& frame, const std::string& title, const std::filesystem::path& file, const BodyExtras& extras) {
    const BodyField& field = field_of(options.show);
    const FigureScale own = extras.scale ? *extras.scale : body_scale(options, frame, nullptr);
    const ColourScale scale = field_scale(options, own.values);
    BodyPage page(options, frame, own.seen, title, {.bar = scale}, file);
    page.inside_plot([&] { page.fill_obstacles(); });
    page.fill_triangles([&](Index t) { return scale(field.value(frame, t)); });
    page.inside_plot([&] {
        page.draw_outline();
        draw_paths(page, frame, true);  // to be seen on dark colours too
    });
    return page.finished();
}

DrawnFigure draw_materials(const FigureOptions& options, const Frame& frame, const std::vector<std::string>& materials, const std::string& title,
                           const std::filesystem::path& file, const BodyExtras& extras) {
    BodyPage page(options, frame, extras.scale ? extras.scale->seen : seen_part(options, frame), title, material_legend(frame, materials), file);
    page.inside_plot([&] { page.fill_obstacles(); });
    page.fill_triangles([&](Index t) { return material_colour(frame.region[t], frame.grain.empty() ? -1 : frame.grain[t]); });
    page.inside_plot([&] {
        page.draw_outline();
        draw_paths(page, frame, false);
    });
    return page.finished();
}

}  // namespace knap
