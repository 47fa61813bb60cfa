#include "figures/chart.hpp"

#include "figures/plot.hpp"

#include <algorithm>

namespace knap {
namespace {

constexpr double plot_height = 260, max_chart_height = 900, narrow_page = 450, chart_margin_right = 16,
                 chart_gap = 12;  // [unit]

/// Points on all curves of the page, closer together than letters.
std::vector<Vec2> sampled(const std::vector<std::vector<Vec2>>& lines, double step) {
    std::vector<Vec2> points;
    for (const std::vector<Vec2>& line : lines)
        for (std::size_t i = 0; i < line.size(); ++i) {
            const double length = i == 0 ? 0 : (line[i] - line[i - 1]).norm();
            if (length < page_width)
                for (double s = step; s < length; s += step)
                    points.push_back(line[i - 1] + s / length * (line[i] - line[i - 1]));
            points.push_back(line[i]);
        }
    return points;
}

/// Dashed lines with names. A name stands above its line or below, at the preferred side or the other: where it touches
/// no other name and hides the fewest points of curves. One without such a place is left out.
void draw_levels(Canvas& canvas, const Plot& plot, const std::vector<Level>& levels, const std::vector<Vec2>& curves) {
    const double size = plot.size, height = 1.1 * size;
    const Area& area = plot.area;
    const auto y_of = [&](const Level& level) { return area.bottom + area.height * plot.y.fraction(level.y); };
    for (const Level& level : levels)
        canvas.line({{area.left, y_of(level)}, {area.right(), y_of(level)}}, ink, 0.8, {5, 3});
    std::vector<Area> taken;
    for (const Level& level : levels) {
        const double y = y_of(level), width = text_width(level.label, size);
        std::optional<Area> best;
        std::ptrdiff_t min_hidden = 0;
        for (const bool right : {level.name_right, !level.name_right})
            for (const double bottom : {y + 3, y - 3 - height}) {
                const Area place{right ? area.right() - 4 - width : area.left + 8, bottom, width, height};
                if (place.bottom < area.bottom || place.top() > area.top()) continue;
                if (std::ranges::any_of(taken, [&](const Area& t) { return t.overlaps(place); })) continue;
                const auto hidden = std::ranges::count_if(curves, [&](const Vec2& p) {
                    return place.overlaps({p.x() - 2, p.y() - 1, 4, 2});
                });
                if (!best || hidden < min_hidden) best = place, min_hidden = hidden;
            }
        if (!best) continue;
        const double left = best->left - 2, end = best->right() + 2;
        canvas.fill({{left, best->bottom}, {end, best->bottom}, {end, best->top()}, {left, best->top()}},
                    {1, 1, 1, 0.8});
        canvas.text({best->left, best->bottom + 0.25 * size}, level.label, {.size = size});
        taken.push_back(*best);
    }
}

/// Error bars and markers.
void draw_points(Canvas& canvas, const Plot& plot, const Curve& curve) {
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
        const Vec2 at = plot.on_page({curve.x[i], curve.y[i]});
        if (!at.allFinite()) continue;
        if (i < curve.low.size()) {
            const Vec2 low = plot.on_page({curve.x[i], curve.low[i]}), a = low.allFinite() ? low : at,
                       b = plot.on_page({curve.x[i], curve.high[i]}), cap(3, 0);
            if (b.allFinite()) canvas.segments({a, b, a - cap, a + cap, b - cap, b + cap}, curve.colour, 1);
        }
        canvas.marker(curve.marker, at, curve.colour);
    }
}

}  // namespace

Box axis_ranges(const Chart& chart) {
    Box range{Vec2::Zero(), Vec2::Zero()};
    const auto begin_empty = [&](int axis) { range.low[axis] = INFINITY, range.high[axis] = -INFINITY; };
    if (chart.x_logarithmic || !chart.x_with_zero) begin_empty(0);
    if (chart.y_logarithmic || !chart.y_with_zero) begin_empty(1);
    const auto add = [&](int axis, double value) {
        if (!std::isfinite(value) || ((axis == 0 ? chart.x_logarithmic : chart.y_logarithmic) && value <= 0)) return;
        range.low[axis] = std::min(range.low[axis], value);
        range.high[axis] = std::max(range.high[axis], value);
    };
    const Limits within = chart.x_within.value_or(Limits{-INFINITY, INFINITY});
    for (const Curve& curve : chart.curves)
        for (std::size_t i = 0; i < curve.x.size(); ++i) {
            const double x = std::clamp(curve.x[i], within.low, within.high);
            add(0, x);
            for (const auto* values : {&curve.y, &curve.low, &curve.high})
                if (i < values->size() && !(x != curve.x[i])) add(1, (*values)[i]);
        }
    for (const Level& level : chart.levels) add(1, 1.08 * level.y);
    for (const double x : chart.marks) add(0, x);
    return range;
}

std::vector<LegendEntry> entries_of(const Chart& chart) {
    std::vector<LegendEntry> entries;
    if (chart.curves.size() > 1)
        for (const Curve& curve : chart.curves)
            if (!curve.label.empty())
                entries.push_back({curve.label, curve.colour, curve.width, curve.dash, curve.marker});
    return entries;
}

DrawnFigure draw_chart(const Chart& chart, const std::filesystem::path& file, int pixels, const ChartPlace& place) {
    Box range = axis_ranges(chart);
    if (place.axes) range = {range.low.cwiseMin(place.axes->low), range.high.cwiseMax(place.axes->high)};
    const double larger = place.panel ? 1.8 : 1;  // panels are shown smaller
    Plot plot{
        .x = fitted_axis(chart.x_quantity, chart.x_unit, chart.x_logarithmic, {range.low.x(), range.high.x()}, false),
        .y = fitted_axis(chart.y_quantity, chart.y_unit, chart.y_logarithmic, {range.low.y(), range.high.y()}, true),
        .size = larger * type_size};

    const std::vector<LegendEntry> entries = place.panel ? std::vector<LegendEntry>() : entries_of(chart);
    const bool legend_below = place.page.width < narrow_page;
    const double width = place.page.width, row = width - 2 * chart_margin_right,
                 legend_width = entries.empty() || legend_below ? 0 : entries_width(entries) + chart_gap,
                 below = entries.empty() || !legend_below ? 0 : legend_height({.entries = entries}, row),
                 beside = legend_below ? 0 : entries_height(entries, legend_width - chart_gap);
    plot.area = {0, 42 * larger + below, width, std::max(plot_height, std::min(beside, max_chart_height))};
    const int max_x = place.panel || legend_below ? 5 : 9, max_y = place.panel ? 5 : 8;
    plot.fit_ticks(max_x, max_y);
    plot.area.left = std::max(58 * larger, plot.y_label_width() + 2.6 * plot.size);
    plot.area.width = width - plot.area.left - chart_margin_right - legend_width;
    plot.fit_ticks(max_x, max_y);
    const Title title = fitted_title(chart.title, "", width - plot.area.left - chart_margin_right);

    Canvas canvas(file, plot.area.top() + (place.panel ? 14 : title.height()), pixels, place.page);
    plot.draw_axes(canvas, true);
    std::vector<std::vector<Vec2>> lines;
    canvas.clip({plot.area.left - 1, plot.area.bottom - 1, plot.area.width + 2, plot.area.height + 2});
    for (const double x : chart.marks)
        if (const double at = plot.area.left + plot.area.width * plot.x.fraction(x); std::isfinite(at))
            canvas.line({{at, plot.area.bottom}, {at, plot.area.top()}}, ink, 0.8, {5, 3});
    for (const Curve& curve : chart.curves) {
        std::vector<Vec2>& line = lines.emplace_back();
        std::size_t n_drawn = 0;
        for (std::size_t i = 0; i < curve.x.size(); ++i) {
            if (i == place.n_points) n_drawn = line.size();
            if (const Vec2 at = plot.on_page({curve.x[i], curve.y[i]}); at.allFinite())
                line.push_back(at.cwiseMax(-1e5).cwiseMin(1e5));  // coordinates of Cairo are limited
        }
        if (place.n_points >= curve.x.size()) n_drawn = line.size();
        canvas.line({line.begin(), line.begin() + static_cast<std::ptrdiff_t>(n_drawn)}, curve.colour, curve.width,
                    line_pattern(curve.dash, curve.width));
    }
    canvas.unclip();
    for (const Curve& curve : chart.curves) draw_points(canvas, plot, curve);
    if (below > 0) draw_legend(canvas, {.entries = entries}, {chart_margin_right, 0, row, below});
    else
        draw_entries(canvas, entries,
                     {plot.area.right() + chart_gap, plot.area.bottom, legend_width - chart_gap, plot.area.height});
    if (!place.panel) draw_title(canvas, title, plot.area.left, width - chart_margin_right, plot.area.top());
    if (!chart.levels.empty()) draw_levels(canvas, plot, chart.levels, sampled(lines, 0.4 * plot.size));
    return canvas.finish();
}

}  // namespace knap
