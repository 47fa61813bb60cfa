#include "observe/body_figures.hpp"

#include "observe/body_raster.hpp"
#include "observe/body_view.hpp"
#include "observe/colour_bar.hpp"
#include "observe/key.hpp"

#include <cairo.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace knap {

namespace {

constexpr Colour body_colour{0.90, 0.90, 0.89}, outline_colour{0.35, 0.35, 0.35}, obstacle_colour{0.70, 0.72, 0.76}, damaged_colour{0.25, 0.52, 0.78};
constexpr double outline_width = 0.5, broken_width = 1.1, damaged_width = 0.5, precrack_width = 1, path_width = 0.6,
                 swatch_width = 9, column_gap = 8;  // [unit]

template <class Values>
Vec2 corner_mean(const Values& values, Index t) {
    return (values[3 * t] + values[3 * t + 1] + values[3 * t + 2]) / 3;
}

enum class Kind { intact, damaged, broken, precrack };

Kind kind_of(const Frame& frame, Index i) {
    const PointStatus a = frame.status[2 * i], b = frame.status[2 * i + 1];
    const bool on_foundation = frame.side_a[i][0] < 0 || frame.side_b[i][0] < 0;  // resting on it is no crack
    if (a == PointStatus::precrack) return on_foundation ? Kind::intact : Kind::precrack;
    if (a == PointStatus::broken && b == PointStatus::broken) return Kind::broken;
    return a == PointStatus::intact && b == PointStatus::intact ? Kind::intact : Kind::damaged;
}

std::vector<Index> interfaces_of(const Frame& frame, Kind kind) {
    std::vector<Index> found;
    for (Index i = 0; i < frame.n_interfaces(); ++i)
        if (kind_of(frame, i) == kind) found.push_back(i);
    return found;
}

double mean_opening(const Frame& frame, Index i) { return std::max(0.0, 0.5 * (frame.opening[2 * i] + frame.opening[2 * i + 1])); }
double mean_cohesion(const Frame& frame, Index i) { return 0.5 * (frame.cohesion[2 * i] + frame.cohesion[2 * i + 1]); }

/// A page with a body on it.
class BodyPage {
public:
    BodyPage(const FigureOptions& options, const Frame& frame, const std::filesystem::path& file)
        : options_(options), frame_(frame), file_(file), view_(frame, options), canvas_(file, view_.page_height(), options.width) {}

    Canvas& canvas() { return canvas_; }
    const BodyView& view() const { return view_; }

    template <class ColourOf>
    void fill_triangles(ColourOf colour) {
        BodyRaster raster(canvas_, view_.plot());
        for (Index t = 0; t < frame_.n_triangles(); ++t) raster.triangle({corner(3 * t), corner(3 * t + 1), corner(3 * t + 2)}, colour(t));
        raster.paint(canvas_);
    }

    /// Both faces of each interface; they are one line as long as it is closed.
    void draw_interfaces(const std::vector<Index>& interfaces, const Colour& colour, double width) {
        std::vector<Vec2> ends;
        for (const Index i : interfaces)
            for (const auto& side : {frame_.side_a[i], frame_.side_b[i]})
                if (side[0] >= 0) ends.insert(ends.end(), {corner(side[0]), corner(side[1])});
        canvas_.segments(ends, colour, width);
    }

    void fill_obstacles() {
        for (Index o = 0; o < frame_.n_obstacles(); ++o) {
            std::vector<Vec2> outline;
            for (Index i = o * n_outline_points; i < (o + 1) * n_outline_points; ++i)
                outline.push_back(view_.on_page(frame_.obstacle_position[i] + options_.deform * frame_.obstacle_displacement[i]));
            canvas_.fill(outline, obstacle_colour);
            outline.push_back(Vec2(outline.front()));
            canvas_.line(outline, outline_colour, outline_width);
        }
    }

    /// The edges that only one triangle has.
    void draw_outline() {
        using Place = std::pair<double, double>;
        std::map<std::pair<Place, Place>, std::pair<Index, Index>> lonely;
        const auto place = [&](Index c) { return Place(frame_.position[c].x(), frame_.position[c].y()); };
        for (Index c = 0; c < 3 * frame_.n_triangles(); ++c) {
            const Index next = c % 3 == 2 ? c - 2 : c + 1;
            if (lonely.erase({place(next), place(c)}) == 0) lonely[{place(c), place(next)}] = {c, next};
        }
        std::vector<Vec2> ends;
        for (const auto& [places, corners] : lonely) ends.insert(ends.end(), {corner(corners.first), corner(corners.second)});
        canvas_.segments(ends, outline_colour, outline_width);
    }

    /// Lines of the body stay inside the plot.
    template <class Draw>
    void inside_plot(Draw draw) {
        const Area& p = view_.plot();
        cairo_save(canvas_.cairo());
        cairo_new_path(canvas_.cairo());
        cairo_rectangle(canvas_.cairo(), p.left, p.bottom, p.width, p.height);
        cairo_clip(canvas_.cairo());
        draw();
        cairo_restore(canvas_.cairo());
    }

    DrawnFigure finished(const std::string& title) {
        view_.draw_axes(canvas_);
        std::string moment = "t = " + time_text(frame_.time);
        if (options_.deform != 1) moment += ", displacements × " + short_number(options_.deform);
        view_.draw_title(canvas_, title, moment);
        canvas_.finish();
        return {file_, canvas_.height(), canvas_.texts()};
    }

private:
    Vec2 corner(Index c) const { return view_.on_page(deformed(frame_, c, options_.deform)); }

    const FigureOptions& options_;
    const Frame& frame_;
    std::filesystem::path file_;
    BodyView view_;
    Canvas canvas_;
};

/// The limits asked for, or round ones for these values.
void set_range(ColourScale& scale, const FigureOptions& options, const std::vector<double>& values, const ColourRange& from_data) {
    const bool given = options.range.size() == 2 && options.range[0] < options.range[1];
    scale.low = given ? options.range[0] : from_data.low;
    scale.high = given ? options.range[1] : from_data.high;
    for (const double v : values) {
        scale.more_below = scale.more_below || v < scale.low;
        scale.more_above = scale.more_above || v > scale.high;
    }
}

/// The paler the less damaged: a process zone is a haze and not a net.
void draw_damaged(BodyPage& page, const Frame& frame, const std::vector<Index>& damaged) {
    constexpr int n_shades = 12;
    std::vector<std::vector<Index>> of_shade(n_shades);
    for (const Index i : damaged) of_shade[std::clamp(static_cast<int>((1 - mean_cohesion(frame, i)) * n_shades), 0, n_shades - 1)].push_back(i);
    for (int shade = 0; shade < n_shades; ++shade) {
        Colour colour = damaged_colour;
        colour.alpha = (shade + 0.5) / n_shades;
        page.draw_interfaces(of_shade[shade], colour, damaged_width);
    }
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

DrawnFigure draw_cracks(const FigureOptions& options, const Frame& frame, const std::string& title, const std::filesystem::path& file) {
    const bool by_cohesion = options.colour == "beta";
    std::vector<Index> coloured = interfaces_of(frame, Kind::broken);
    const std::vector<Index> damaged = interfaces_of(frame, Kind::damaged), precracks = interfaces_of(frame, Kind::precrack);
    if (by_cohesion) coloured.insert(coloured.end(), damaged.begin(), damaged.end());
    const auto value = [&](Index i) { return by_cohesion ? mean_cohesion(frame, i) : mean_opening(frame, i); };
    std::vector<double> values;
    for (const Index i : coloured) values.push_back(value(i));

    ColourScale scale{.map = ColourMap::plasma(), .quantity = by_cohesion ? "cohesion β" : "opening", .unit = by_cohesion ? "" : "m"};
    const double largest = robust_range(values, 0.02, false).high;
    set_range(scale, options, values, by_cohesion ? ColourRange{0, 1} : ColourRange{0, largest > 0 ? largest : 1e-6});
    // what is of most interest is drawn last: the widest, or the most broken
    std::sort(coloured.begin(), coloured.end(), [&](Index a, Index b) { return by_cohesion ? value(a) > value(b) : value(a) < value(b); });

    BodyPage page(options, frame, file);
    page.inside_plot([&] { page.fill_obstacles(); });
    page.fill_triangles([](Index) { return body_colour; });
    page.inside_plot([&] {
        page.draw_outline();
        if (!by_cohesion) draw_damaged(page, frame, damaged);
        page.draw_interfaces(precracks, black, precrack_width);
        for (const Index i : coloured) page.draw_interfaces({i}, scale(value(i)), broken_width);
    });
    std::vector<KeyEntry> key;
    if (!precracks.empty()) key.push_back({"pre-crack", black, precrack_width});
    if (!damaged.empty() && !by_cohesion) key.push_back({"damaged, not broken", damaged_colour, damaged_width});
    const Area below = page.view().below();
    if (coloured.empty())
        page.canvas().text({below.left, below.top() - 5}, "no broken interface", {.size = type_size, .along = Along::middle});
    else
        draw_colour_bar(page.canvas(), scale, {below.left, below.bottom, 0.58 * below.width, below.height});
    draw_key(page.canvas(), key, {below.left + 0.66 * below.width, below.bottom, 0.34 * below.width, below.height});
    return page.finished(title);
}

DrawnFigure draw_field(const FigureOptions& options, const Frame& frame, const std::string& title, const std::filesystem::path& file) {
    const auto field = std::find_if(body_fields().begin(), body_fields().end(), [&](const BodyField& f) { return f.name == options.show; });
    std::vector<double> values;
    for (Index t = 0; t < frame.n_triangles(); ++t) values.push_back(field->value(frame, t));
    ColourScale scale{.map = field->is_signed ? ColourMap::diverging() : ColourMap::viridis(),
                      .quantity = field->quantity,
                      .unit = field->unit,
                      .about_zero = field->is_signed};
    set_range(scale, options, values, robust_range(values, 0.005, field->is_signed));

    BodyPage page(options, frame, file);
    page.inside_plot([&] { page.fill_obstacles(); });
    page.fill_triangles([&](Index t) { return scale(values[t]); });
    page.inside_plot([&] {
        page.draw_outline();
        // black on white, to be seen on dark colours too
        std::vector<Index> paths = interfaces_of(frame, Kind::broken);
        for (const Index i : interfaces_of(frame, Kind::precrack)) paths.push_back(i);
        page.draw_interfaces(paths, {1, 1, 1, 0.75}, 3 * path_width);
        page.draw_interfaces(paths, black, path_width);
    });
    const Area below = page.view().below();
    draw_colour_bar(page.canvas(), scale, {below.left + 0.15 * below.width, below.bottom, 0.7 * below.width, below.height});
    return page.finished(title);
}

DrawnFigure draw_materials(const FigureOptions& options, const Frame& frame, const std::vector<std::string>& materials, const std::string& title,
                           const std::filesystem::path& file) {
    BodyPage page(options, frame, file);
    page.fill_triangles([&](Index t) { return material_colour(frame.region[t], frame.grain.empty() ? -1 : frame.grain[t]); });
    page.inside_plot([&] {
        page.draw_outline();
        std::vector<Index> paths = interfaces_of(frame, Kind::broken);
        for (const Index i : interfaces_of(frame, Kind::precrack)) paths.push_back(i);
        page.draw_interfaces(paths, black, path_width);
    });
    std::vector<KeyEntry> key;
    std::vector<std::int32_t> present = frame.region;
    std::sort(present.begin(), present.end());
    present.erase(std::unique(present.begin(), present.end()), present.end());
    for (const std::int32_t region : present) {
        const bool named = region < static_cast<std::int32_t>(materials.size());
        key.push_back({named ? materials[region] : "material " + std::to_string(region), material_colour(region, -1), swatch_width});
    }
    // two below each other, up to four beside each other
    const Area below = page.view().below();
    const std::size_t n_columns = (key.size() + 1) / 2;
    const double width = below.width / static_cast<double>(std::max<std::size_t>(n_columns, 4));
    for (std::size_t column = 0; column < n_columns; ++column) {
        const auto first = key.begin() + static_cast<std::ptrdiff_t>(2 * column), last = key.begin() + static_cast<std::ptrdiff_t>(std::min(key.size(), 2 * column + 2));
        const double left = static_cast<double>(column) * width, room = column + 1 < n_columns ? width - column_gap : below.width - left;
        draw_key(page.canvas(), {first, last}, {below.left + left, below.bottom, room, below.height});
    }
    return page.finished(title);
}

}  // namespace knap
