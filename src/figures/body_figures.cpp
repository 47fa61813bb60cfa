#include "figures/body_figures.hpp"

#include <algorithm>
#include <array>
#include <set>

namespace knap {

/// Interfaces that are drawn in one stroke.
struct Layer {
    std::vector<Index> interfaces;
    Colour colour;
    double width;            // [unit]
    bool only_open = false;  // only interfaces whose faces are visibly apart
};

/// A figure of the body: what its triangles and interfaces look like.
struct BodyDrawing {
    int n_parts = 1;                // of each side of a triangle, which is drawn as the square of it
    std::vector<Colour> triangles;  // of all these parts
    std::vector<Layer> layers;      // from below to above
    struct Lines {
        std::vector<Vec2> ends;  // [m] from ends[2i] to ends[2i + 1]
        Colour colour;
    };
    std::vector<Lines> paths = {};  // below the body
};

namespace {

constexpr Colour body_colour{0.90, 0.90, 0.89}, damaged_colour{0.10, 0.38, 0.66}, outline_colour{0.35, 0.35, 0.35},
    obstacle_colour{0.70, 0.72, 0.76}, isoline_colour{0.84, 0.10, 0.11};
// [unit]
constexpr double broken_width = 1.3, damaged_width = 1, precrack_width = 1, path_width = 0.6, outline_width = 0.5,
                 isoline_width = 1.6, collector_width = 1.2, path_line_width = 1;
constexpr double margin_left = 52, margin_right = 16, panel_margin = 4, max_height = 620, min_size = 60;

Vec2 deformed(const Frame& frame, Index corner, double magnification) {
    return frame.position[corner] + magnification * frame.displacement[corner];
}

std::vector<Index> interfaces_of(const Frame& frame, InterfaceStatus status) {
    std::vector<Index> found;
    for (Index i = 0; i < frame.n_interfaces(); ++i)
        if (drawn_status(frame, i) == status) found.push_back(i);
    return found;
}

/// Scale of x and y relative to each other: the short side is drawn `aspect` times larger.
Vec2 stretch_of(const Box& seen, double aspect) {
    return seen.extent().x() < seen.extent().y() ? Vec2(aspect, 1) : Vec2(1, aspect);
}

std::vector<Vec2> obstacle_outline(const Frame& frame, Index obstacle, double magnification) {
    std::vector<Vec2> points;
    for (Index i = obstacle * frame.n_outline(); i < (obstacle + 1) * frame.n_outline(); ++i)
        points.push_back(frame.obstacle_position[i] + magnification * frame.obstacle_displacement[i]);
    return points;
}

/// The surface of a half plane: the foot of `x` on it, its direction, and the direction into the half plane.
struct Surface {
    Vec2 foot, along, inwards;
};
Surface surface_of(const std::vector<Vec2>& outline, const Vec2& x) {
    const Vec2 along = (outline[1] - outline[0]).normalized();
    return {outline[0] + along.dot(x - outline[0]) * along, along, (outline[2] - outline[1]).normalized()};
}

/// The deformed body and paths with the obstacles near them, and a margin of 2 %.
Box seen_part(const FigureOptions& options, const Frame& frame, const std::vector<PiecePath>& paths) {
    if (options.box) return *options.box;
    if (frame.position.empty()) return {{0, 0}, {1, 1}};
    constexpr double far = 1000;  // [-] of the body: what a run that has failed throws further is not looked for
    const Box start = bounding_box(frame.position);
    std::vector<Vec2> points;
    for (Index c = 0; c < 3 * frame.n_triangles(); ++c) {
        const Vec2 x = deformed(frame, c, options.deform);
        if ((x - start.middle()).norm() < far * start.diagonal()) points.push_back(x);  // false if it is no number
    }
    for (const PiecePath& path : paths) points.insert(points.end(), path.at.begin(), path.at.end());
    if (points.empty()) return start;
    const Box body = bounding_box(points);
    const double size = body.extent().maxCoeff();
    const double beyond = (paths.empty() ? 0.75 : 0.1) * size;  // paths are already much longer than the body
    const Box near{body.low.array() - beyond, body.high.array() + beyond};
    for (Index o = 0; o < frame.n_obstacles(); ++o) {
        std::vector<Vec2> outline = obstacle_outline(frame, o, options.deform);
        if (frame.is_half_plane(o)) {  // a strip of it below the middle of the body
            const Surface surface = surface_of(outline, body.middle());
            outline.clear();
            if (near.contains(surface.foot)) outline = {surface.foot, surface.foot + 0.05 * size * surface.inwards};
            points.insert(points.end(), outline.begin(), outline.end());
        } else
            std::ranges::copy_if(outline, std::back_inserter(points), [&](const Vec2& x) { return near.contains(x); });
    }
    const Box seen = bounding_box(points);
    const Vec2 stretch = stretch_of(seen, options.aspect);
    const Vec2 margin = std::max(0.02 * stretch.cwiseProduct(seen.extent()).maxCoeff(), 1e-12) * stretch.cwiseInverse();
    return {seen.low - margin, seen.high + margin};
}

/// The span of the finite values of triangles or interfaces; of those with a corner in the box of the options, if any.
/// `corners_of(i)`: corners, -1 for none.
template <class CornersOf>
ValueSpan seen_span(const FigureOptions& options, const Frame& frame, std::vector<double> values, double outliers,
                    CornersOf corners_of) {
    const auto is_seen = [&](Index c) { return c >= 0 && options.box->contains(deformed(frame, c, options.deform)); };
    for (std::size_t i = 0; options.box && i < values.size(); ++i)
        if (std::ranges::none_of(corners_of(static_cast<Index>(i)), is_seen)) values[i] = NAN;
    return span_of(std::move(values), outliers);
}

// ---- drawing

/// The less cohesion is left the darker: a process zone is a haze that is visible in print.
void add_damaged(BodyDrawing& drawing, const Frame& frame, const std::vector<Index>& damaged) {
    constexpr int n_shades = 12;
    std::vector<Layer> shades(n_shades, {{}, damaged_colour, damaged_width});
    for (int k = 0; k < n_shades; ++k) shades[k].colour.alpha = 0.4 + 0.6 * std::min(1.0, 1.5 * (k + 0.5) / n_shades);
    for (const Index i : damaged) {
        const double mean_damage = 1 - 0.5 * (frame.cohesion[2 * i] + frame.cohesion[2 * i + 1]);
        shades[std::clamp(static_cast<int>(mean_damage * n_shades), 0, n_shades - 1)].interfaces.push_back(i);
    }
    drawing.layers.insert(drawing.layers.end(), shades.begin(), shades.end());
}

BodyDrawing cracks_drawing(const FigureOptions& options, const Frame& frame, const Histories& histories,
                           const FigureScale& scale) {
    const CrackColour& colour = crack_colour(options.colour);
    const ColourScale colours = crack_scale(options, scale.values);
    const std::vector<double> values = crack_values(colour, frame, histories.breaks);
    std::vector<Index> coloured, others;
    for (Index i = 0; i < frame.n_interfaces(); ++i)
        if (std::isfinite(values[i])) coloured.push_back(i);
        else if (drawn_status(frame, i) == InterfaceStatus::broken) others.push_back(i);
    std::ranges::sort(coloured, [&](Index a, Index b) {
        return colour.smallest_last ? values[a] > values[b] : values[a] < values[b];
    });
    const std::vector<Index> damaged = interfaces_of(frame, InterfaceStatus::damaged);
    BodyDrawing drawing{.triangles = std::vector<Colour>(frame.n_triangles(), body_colour),
                        .layers = {{damaged, outline_colour, outline_width, true}}};
    if (!colour.damaged) add_damaged(drawing, frame, damaged);
    if (!colour.precracks)
        drawing.layers.push_back({interfaces_of(frame, InterfaceStatus::precrack), black, precrack_width});
    drawing.layers.push_back({others, outline_colour, path_width});
    for (const Index i : coloured) drawing.layers.push_back({{i}, colours(values[i]), broken_width});
    return drawing;
}

/// Parts of a side, so that linear values look smooth: some 200 parts over the width of a body of equal triangles.
int n_parts_of(Index n_triangles) {
    return std::clamp(static_cast<int>(std::ceil(200 / std::sqrt(std::max<double>(n_triangles, 1)))), 1, 40);
}

/// visit(barycentric coordinates of the three corners, a row each)
template <class Visit>
void for_each_part(int n, const Visit& visit) {
    const auto at = [n](int i, int j) -> Eigen::RowVector3d { return Eigen::RowVector3d(n - i - j, i, j) / n; };
    Eigen::Matrix3d corners;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n - i; ++j) {
            corners << at(i, j), at(i + 1, j), at(i, j + 1);
            visit(corners);
            if (i + j + 2 > n) continue;
            corners << at(i + 1, j), at(i + 1, j + 1), at(i, j + 1);
            visit(corners);
        }
}

/// Ends of the lines along which the values at corners, linear in triangles, are `value`.
std::vector<Vec2> isoline(const Frame& frame, double (*at_corner)(const Frame&, Index), double value,
                          const std::vector<Vec2>& corners) {
    std::vector<Vec2> ends;
    for (Index t = 0; t < frame.n_triangles(); ++t) {
        const std::size_t n = ends.size();
        for (Index k = 0; k < 3; ++k) {
            const Index a = 3 * t + k, b = 3 * t + (k + 1) % 3;
            const double v = at_corner(frame, a), w = at_corner(frame, b);
            if ((v < value) != (w < value))
                ends.push_back(corners[a] + (value - v) / (w - v) * (corners[b] - corners[a]));
        }
        ends.resize(n + (ends.size() - n) / 2 * 2);  // values that are no numbers
    }
    return ends;
}

/// Black cracks, over a field with a white border: they must be visible on dark colours, too.
void add_cracks(BodyDrawing& drawing, const Frame& frame, bool border) {
    std::vector<Index> paths = interfaces_of(frame, InterfaceStatus::broken);
    for (const Index i : interfaces_of(frame, InterfaceStatus::precrack)) paths.push_back(i);
    drawing.layers = {{interfaces_of(frame, InterfaceStatus::damaged), outline_colour, outline_width, true},
                      {border ? paths : std::vector<Index>(), {1, 1, 1, 0.75}, 3 * path_width},
                      {paths, black, path_width}};
}

BodyDrawing materials_drawing(const FigureOptions&, const Frame& frame, const Histories&, const FigureScale&) {
    BodyDrawing drawing;
    for (Index t = 0; t < frame.n_triangles(); ++t)
        drawing.triangles.push_back(material_colour(frame.region[t], frame.grain.empty() ? -1 : frame.grain[t]));
    add_cracks(drawing, frame, false);
    return drawing;
}

BodyDrawing field_drawing(const FigureOptions& options, const Frame& frame, const Histories&,
                          const FigureScale& scale) {
    const BodyField& field = *body_field(options.show);
    const ColourScale colours = field_scale(options, frame, scale.values);
    BodyDrawing drawing;
    if (field.at_corner) drawing.n_parts = n_parts_of(frame.n_triangles());
    for (Index t = 0; t < frame.n_triangles(); ++t) {
        if (!field.at_corner) {
            drawing.triangles.push_back(colours(field.value(frame, t)));
            continue;
        }
        const Eigen::Vector3d values(field.at_corner(frame, 3 * t), field.at_corner(frame, 3 * t + 1),
                                     field.at_corner(frame, 3 * t + 2));
        for_each_part(drawing.n_parts, [&](const Eigen::Matrix3d& corners) {
            drawing.triangles.push_back(colours((corners * values).mean()));
        });
    }
    add_cracks(drawing, frame, true);
    return drawing;
}

BodyDrawing paths_drawing(const FigureOptions& options, const Frame& frame, const Histories& histories,
                          const FigureScale& scale) {
    constexpr int n_shades = 24;
    const ColourScale colours = path_scale(options, scale.values);
    BodyDrawing drawing{.triangles = std::vector<Colour>(frame.n_triangles(), body_colour)};
    for (int k = 0; k < n_shades; ++k)
        drawing.paths.push_back({{}, colours(colours.low + (k + 0.5) / n_shades * (colours.high - colours.low))});
    for (const PiecePath& path : piece_paths(histories, frame.time))
        for (std::size_t i = 1; i < path.at.size(); ++i) {
            const double part =
                (0.5 * (path.speed[i - 1] + path.speed[i]) - colours.low) / (colours.high - colours.low);
            std::vector<Vec2>& ends =
                drawing.paths[std::clamp(static_cast<int>(part * n_shades), 0, n_shades - 1)].ends;
            ends.insert(ends.end(), {path.at[i - 1], path.at[i]});
        }
    add_cracks(drawing, frame, false);
    return drawing;
}

std::vector<Vec2> parts_of(const std::vector<Vec2>& corners, int n) {
    std::vector<Vec2> parts;
    for (std::size_t t = 0; t < corners.size(); t += 3)
        for_each_part(n, [&](const Eigen::Matrix3d& weights) {
            for (int k = 0; k < 3; ++k)
                parts.push_back(weights(k, 0) * corners[t] + weights(k, 1) * corners[t + 1] +
                                weights(k, 2) * corners[t + 2]);
        });
    return parts;
}

/// Half planes extend to the end of what is seen.
void draw_obstacles(Canvas& canvas, const Plot& plot, const Frame& frame, double magnification) {
    const auto at = [&](double x, double y) { return Vec2(Vec2(x, y) / plot.x.unit.factor); };
    const Box seen{at(plot.x.low, plot.y.low), at(plot.x.high, plot.y.high)};
    for (Index o = 0; o < frame.n_obstacles(); ++o) {
        std::vector<Vec2> outline = obstacle_outline(frame, o, magnification);
        if (frame.is_half_plane(o)) {
            const auto [foot, along, inwards] = surface_of(outline, seen.middle());
            const double far = seen.diagonal(), deep = far + (seen.middle() - foot).norm();
            outline = {foot - far * along, foot + far * along, foot + far * along + deep * inwards,
                       foot - far * along + deep * inwards};
        }
        for (Vec2& x : outline) x = plot.on_page(x);
        canvas.fill(outline, obstacle_colour);
        outline.push_back(Vec2(outline.front()));
        canvas.line(outline, outline_colour, outline_width);
    }
}

/// Both faces of each interface; they are one line while it is closed.
void draw_layer(Canvas& canvas, const Frame& frame, const std::vector<Vec2>& corners, const Layer& layer,
                double width) {
    constexpr double visible = 0.4;  // [unit]
    std::vector<Vec2> ends;
    for (const Index i : layer.interfaces) {
        const auto &a = frame.side_a[i], &b = frame.side_b[i];
        if (layer.only_open &&
            (a[0] < 0 || b[0] < 0 ||
             std::max((corners[a[0]] - corners[b[0]]).norm(), (corners[a[1]] - corners[b[1]]).norm()) <= visible))
            continue;
        for (const auto& side : {a, b})
            if (side[0] >= 0) ends.insert(ends.end(), {corners[side[0]], corners[side[1]]});
    }
    canvas.segments(ends, layer.colour, width);
}

/// Openings and slips have the range of faces less than an edge apart, if there are any: pieces fly off.
void add_crack_scale(const FigureOptions& options, const Frame& frame, const Histories& histories, FigureScale& scale) {
    const CrackColour& colour = crack_colour(options.colour);
    std::vector<double> values = crack_values(colour, frame, histories.breaks);
    const auto seen = [&] {
        return seen_span(options, frame, values, 0.02, [&](Index i) {
            return std::array{frame.side_a[i][0], frame.side_a[i][1], frame.side_b[i][0], frame.side_b[i][1]};
        });
    };
    scale.values = seen();
    if (colour.unit == "m") {
        for (Index i = 0; i < frame.n_interfaces(); ++i)
            if (values[i] > (frame.end_position[2 * i + 1] - frame.end_position[2 * i]).norm()) values[i] = NAN;
        if (const ValueSpan near = seen(); near.low <= near.high)
            scale.values.low = near.low, scale.values.high = near.high;
    }
    scale.damaged = !interfaces_of(frame, InterfaceStatus::damaged).empty();
    scale.precracks = !interfaces_of(frame, InterfaceStatus::precrack).empty();
}

/// Zeros give no range: a bar of 0 to 1 would be the scale of nothing.
void add_bar(const ColourScale& bar, const FigureOptions& options, const ValueSpan& values, Legend& legend) {
    const BodyField* const field = body_field(options.show);
    const bool has_isolines = field && field->at_corner;  // they name the unit of the bar
    if (values.min == 0 && values.max == 0 && options.range.empty() && !has_isolines)
        legend.note = bar.quantity + ": 0 everywhere";
    else legend.bar = bar;
}

void add_crack_legend(const FigureOptions& options, const Frame&, const FigureContext&, const FigureScale& scale,
                      Legend& legend) {
    const CrackColour& colour = crack_colour(options.colour);
    if (std::isfinite(scale.values.low)) add_bar(crack_scale(options, scale.values), options, scale.values, legend);
    else legend.note = "no broken interface";
    if (!colour.precracks && scale.precracks) legend.entries.push_back({"pre-crack", black, precrack_width});
    if (!colour.damaged && scale.damaged)
        legend.entries.push_back({"damaged, not broken", damaged_colour, damaged_width});
}

void add_materials(const FigureOptions&, const Frame& frame, const FigureContext& context, const FigureScale&,
                   Legend& legend) {
    const std::set<std::int32_t> present(frame.region.begin(), frame.region.end());
    for (const std::int32_t region : present) {
        const bool named = region < static_cast<std::int32_t>(context.materials.size());
        legend.entries.push_back(
            {named ? context.materials[region] : "material " + std::to_string(region), material_colour(region, -1), 9});
    }
}

void add_field_scale(const FigureOptions& options, const Frame& frame, const Histories&, FigureScale& scale) {
    std::vector<double> values;
    for (Index t = 0; t < frame.n_triangles(); ++t) values.push_back(body_field(options.show)->value(frame, t));
    scale.values = seen_span(options, frame, std::move(values), 0.005, [](Index t) {
        return std::array{3 * t, 3 * t + 1, 3 * t + 2};
    });
}

void add_field_legend(const FigureOptions& options, const Frame& frame, const FigureContext&, const FigureScale& scale,
                      Legend& legend) {
    add_bar(field_scale(options, frame, scale.values), options, scale.values, legend);
}

void add_path_scale(const FigureOptions&, const Frame& frame, const Histories& histories, FigureScale& scale) {
    std::vector<double> speeds;
    for (const PiecePath& path : piece_paths(histories, frame.time))
        speeds.insert(speeds.end(), path.speed.begin(), path.speed.end());
    scale.values = span_of(std::move(speeds), 0);
}

void add_path_legend(const FigureOptions& options, const Frame&, const FigureContext&, const FigureScale& scale,
                     Legend& legend) {
    add_bar(path_scale(options, scale.values), options, scale.values, legend);
}

const BodyKind body_kinds[] = {
    {"cracks", "broken and damaged interfaces", true, true, cracks_drawing, add_crack_scale, add_crack_legend},
    {"materials", "materials and grains, with the cracks", false, true, materials_drawing,
     [](const FigureOptions&, const Frame&, const Histories&, FigureScale&) {}, add_materials},
    {"paths", "ways of the centres of the pieces until then, by their speed, over the obstacles", false, false,
     paths_drawing, add_path_scale, add_path_legend, "m/s"},
    {"", "", false, false, field_drawing, add_field_scale, add_field_legend},
};

}  // namespace

const BodyKind* body_kind(const std::string& show) {
    const auto found = std::ranges::find(body_kinds, body_field(show) ? "" : show, &BodyKind::show);
    return found == std::end(body_kinds) ? nullptr : &*found;
}

std::vector<std::string> body_subjects() {
    std::vector<std::string> names;
    for (const BodyKind& kind : body_kinds)
        if (!kind.show.empty()) names.push_back(kind.show);
    for (const BodyField& field : body_fields()) names.push_back(field.name);
    return names;
}

std::string doc_of_body(const std::string& show) {
    const BodyField* const field = body_field(show);
    return field ? field->quantity + (field->unit.empty() ? "" : " [" + field->unit + "]") + " on the body"
                 : body_kind(show)->doc;
}

Plot body_plot(Box seen, const FigureOptions& options, double below) {
    const Vec2 stretch = stretch_of(seen, options.aspect);
    Plot plot;
    const auto place = [&](double left) {
        const double width = options.page().width - left - (options.panel ? panel_margin : margin_right);
        Vec2 size = stretch.cwiseProduct(seen.extent());
        const Vec2 min(size.y() * min_size / max_height, size.x() * (options.panel ? 0.3 : 1) * min_size / width);
        const Vec2 missing = (min - size).cwiseMax(0), margin = 0.5 * missing.cwiseQuotient(stretch);
        const Box shown{seen.low - margin, seen.high + margin};
        size += missing;
        const double scale = std::min(width / size.x(), max_height / size.y());  // [unit/m]
        plot.area = {left + 0.5 * (width - scale * size.x()), below, scale * size.x(), scale * size.y()};
        const DisplayUnit unit = display_unit(shown.low.cwiseAbs().cwiseMax(shown.high.cwiseAbs()).maxCoeff(), "m");
        const auto axis = [&](const char* name, int i) {
            const std::string factor = stretch[i] == 1 ? "" : ", × " + short_number(stretch[i]);
            return Axis{.title = with_unit(name, unit.unit) + factor,
                        .unit = unit,
                        .low = shown.low[i] * unit.factor,
                        .high = shown.high[i] * unit.factor};
        };
        plot.x = axis("x", 0), plot.y = axis("y", 1);
        plot.fit_ticks(std::clamp(static_cast<int>(plot.area.width / 45), 3, 11),
                       std::clamp(static_cast<int>(plot.area.height / 28), 3, 11));
    };
    place(options.panel ? panel_margin : margin_left);
    if (const double needed = plot.y_label_width() + 28.5; !options.panel && needed > margin_left) place(needed);
    return plot;
}

std::string magnification(const FigureOptions& options, bool obstacles) {
    if (!body_kind(options.show) || options.deform == 1) return "";
    return "displacements × " + short_number(options.deform) +
           (obstacles && options.deform > 1 ? ", so closed gaps overlap" : "");
}

FigureScale body_scale(const FigureOptions& options, const Frame& frame, const Histories& histories) {
    const bool with_paths = body_kind(options.show)->drawing == paths_drawing;
    FigureScale scale{
        .seen = seen_part(options, frame, with_paths ? piece_paths(histories, frame.time) : std::vector<PiecePath>())};
    body_kind(options.show)->add_scale(options, frame, histories, scale);
    return scale;
}

/// Whether the line may cross what is seen.
bool is_seen(const FigureContext::Line& line, const Box& seen) {
    const Vec2 low = line.from.cwiseMin(line.to), high = line.from.cwiseMax(line.to);
    return (low.array() <= seen.high.array()).all() && (high.array() >= seen.low.array()).all();
}

Legend body_legend(const FigureOptions& options, const Frame& frame, const FigureContext& context,
                   const FigureScale& scale) {
    Legend legend;
    body_kind(options.show)->add_legend(options, frame, context, scale, legend);
    for (const double value : options.mark)
        legend.entries.push_back({short_number(value) + " " + legend.bar->unit, isoline_colour, isoline_width});
    if (!options.measured.empty())
        legend.entries.push_back({options.measured_by, measured_colour, 0, 0, measured_marker});
    for (std::size_t k = 0; k < context.collectors.size(); ++k)
        if (is_seen(context.collectors[k], scale.seen))
            legend.entries.push_back({context.collectors[k].name, curve_colour(k + 1), collector_width, 1});
    return legend;
}

DrawnFigure draw_body(const FigureOptions& options, const Frame& frame, const Histories& histories,
                      const FigureContext& context, const std::filesystem::path& file, const FigureScale& scale) {
    const Page page = options.page();
    const double full_width = page.width - margin_left - margin_right;
    const Legend legend = body_legend(options, frame, context, scale);
    const double below = options.panel ? 0 : legend_height(legend, full_width);
    const Plot plot = body_plot(scale.seen, options, options.panel ? panel_margin : below + 36);
    const Area& area = plot.area;
    const bool narrow = area.width < 0.6 * full_width;  // the title then extends over the whole page
    const std::string magnified = magnification(options, frame.n_obstacles() > 0);
    const Title title = fitted_title(options.title.empty() ? context.title : options.title,
                                     "t = " + time_text(frame.time) +
                                         (frame.time >= context.early_end * (1 - 1e-6) ? ", run ended" : "") +
                                         (magnified.empty() ? "" : ", ") + magnified,
                                     narrow ? full_width : area.width);
    const BodyDrawing drawing = body_kind(options.show)->drawing(options, frame, histories, scale);
    std::vector<Vec2> corners;  // on the page
    for (Index c = 0; c < 3 * frame.n_triangles(); ++c)
        corners.push_back(plot.on_page(deformed(frame, c, options.deform)));

    Canvas canvas(file, area.top() + (options.panel ? panel_margin : title.height()), options.width, page);
    canvas.clip(area);
    draw_obstacles(canvas, plot, frame, options.deform);
    for (const auto& [ends, colour] : drawing.paths) {
        std::vector<Vec2> on_page;
        for (const Vec2& x : ends) on_page.push_back(plot.on_page(x));
        canvas.segments(on_page, colour, path_line_width);
    }
    if (drawing.n_parts == 1) canvas.triangles(corners, drawing.triangles, area);
    else canvas.triangles(parts_of(corners, drawing.n_parts), drawing.triangles, area);
    std::vector<Vec2> outline;
    for (const Index c : single_edges(frame)) outline.insert(outline.end(), {corners[c], corners[next_corner(c)]});
    canvas.segments(outline, outline_colour, outline_width);
    for (const Layer& layer : drawing.layers)
        draw_layer(canvas, frame, corners, layer, (options.panel ? 1.8 : 1) * layer.width);  // panels are shown smaller
    for (const double value : options.mark)
        canvas.segments(isoline(frame, body_field(options.show)->at_corner, value, corners), isoline_colour,
                        isoline_width);
    for (std::size_t k = 0; k < context.collectors.size(); ++k) {
        const FigureContext::Line& line = context.collectors[k];
        if (!is_seen(line, scale.seen)) continue;
        const auto ends_at = [&](const Vec2& x) -> Vec2 {
            return plot.on_page({x.x(), std::clamp(x.y(), scale.seen.low.y(), scale.seen.high.y())});
        };
        canvas.line({ends_at(line.from), ends_at(line.to)}, curve_colour(k + 1), collector_width,
                    line_pattern(1, collector_width));
    }
    for (const Vec2& x : options.measured) canvas.marker(measured_marker, plot.on_page(x), measured_colour);
    canvas.unclip();
    if (!options.panel) {
        plot.draw_axes(canvas, false);
        draw_title(canvas, title, narrow ? margin_left : area.left, narrow ? page.width - margin_right : area.right(),
                   area.top());
        draw_legend(canvas, legend, {margin_left, 0, full_width, below});
    }
    return canvas.finish();
}

}  // namespace knap
