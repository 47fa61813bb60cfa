#include "figures/chart.hpp"

#include "figures/cairo_device.hpp"
#include "figures/key.hpp"
#include "figures/ticks.hpp"

#include <vtkAxis.h>
#include <vtkChartXY.h>
#include <vtkContext2D.h>
#include <vtkContextScene.h>
#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkPen.h>
#include <vtkPlot.h>
#include <vtkRect.h>
#include <vtkStringArray.h>
#include <vtkTable.h>
#include <vtkTextProperty.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace knap {

namespace {

constexpr double plot_height = 260, room_right = 16, gap = 12;       // [unit]
constexpr double room_left = 58, room_below = 42, room_above = 14;  // [unit] of type of the usual size, without a title
constexpr double panel_type = 1.8;                                  // of that of a figure by itself
constexpr double highest_key = 900;                                 // [unit]

/// From SI to what VTK draws: the unit shown, or its decimal logarithm.
struct Scale {
    DisplayUnit unit;
    bool logarithmic = false;
    double low = 0, high = 1;  // of the axis, as drawn
    double operator()(double value) const {
        const double shown = value * unit.factor;
        return logarithmic ? (shown > 0 ? std::log10(shown) : std::nan("")) : shown;
    }
    double part(double value) const { return ((*this)(value) - low) / (high - low); }  // 0 .. 1 along the axis
};

/// All values along an axis [SI]; an even axis has 0 on it.
struct Range {
    explicit Range(bool logarithmic) : logarithmic(logarithmic), low(logarithmic ? INFINITY : 0), high(logarithmic ? -INFINITY : 0) {}
    void add(double value) {
        if (!std::isfinite(value) || (logarithmic && value <= 0)) return;
        low = std::min(low, value);
        high = std::max(high, value);
    }
    Scale scale(const std::string& unit) {
        if (logarithmic && !(low <= high)) low = high = 1;
        if (!logarithmic && low == high) high = 1;
        return {.unit = display_unit(std::max(-low, high), unit), .logarithmic = logarithmic};
    }
    bool logarithmic;
    double low, high;
};

/// All that a chart shows, and `more`.
std::array<Range, 2> ranges_of(const Chart& chart, const std::optional<AxisRanges>& more) {
    Range x(chart.x_logarithmic), y(chart.y_logarithmic);
    for (const Curve& curve : chart.curves)
        for (std::size_t i = 0; i < curve.x.size(); ++i) {
            const bool beyond = chart.x_within && (curve.x[i] < (*chart.x_within)[0] || curve.x[i] > (*chart.x_within)[1]);
            x.add(chart.x_within ? std::clamp(curve.x[i], (*chart.x_within)[0], (*chart.x_within)[1]) : curve.x[i]);
            for (const auto* values : {&curve.y, &curve.low, &curve.high})
                if (i < values->size() && !beyond) y.add((*values)[i]);
        }
    for (const Level& level : chart.levels) y.add(1.08 * level.y);
    if (more) x.add(more->x[0]), x.add(more->x[1]), y.add(more->y[0]), y.add(more->y[1]);
    return {x, y};
}

unsigned char byte(double channel) { return static_cast<unsigned char>(std::lround(255 * channel)); }

void set_font(vtkTextProperty* text, double size) {
    text->SetFontSize(static_cast<int>(std::lround(size)));
    text->SetColor(ink.red, ink.green, ink.blue);
    text->SetBold(false);
}

/// As many round ticks as have room beside each other on a length [unit].
Ticks ticks_of(const Scale& scale, int most, double length, double size, bool upright) {
    if (scale.logarithmic) return logarithmic_ticks(scale.low, scale.high);
    for (int n = most;; --n) {
        Ticks ticks = round_ticks(scale.low, scale.high, n);
        double widest = 0;
        for (const std::string& label : ticks.labels) widest = std::max(widest, upright ? size : text_width(label, size));
        if (n <= 2 || widest + 0.6 * size < ticks.step / (scale.high - scale.low) * length) return ticks;
    }
}

/// One axis: round ticks in the unit that is shown, thin lines, light grid.
void set_axis(vtkAxis* axis, const std::string& quantity, const Scale& scale, const Ticks& ticks, double size) {
    vtkNew<vtkDoubleArray> positions;
    vtkNew<vtkStringArray> labels;
    for (std::size_t i = 0; i < ticks.at.size(); ++i) {
        positions->InsertNextValue(ticks.at[i]);
        labels->InsertNextValue(ticks.labels[i]);
    }
    axis->SetBehavior(vtkAxis::FIXED);
    axis->SetRange(scale.low, scale.high);
    axis->SetCustomTickPositions(positions, labels);
    axis->SetTitle(with_unit(quantity, scale.unit.unit));
    axis->SetTickLength(4);
    axis->SetLabelOffset(6);
    axis->GetPen()->SetColorF(ink.red, ink.green, ink.blue);
    axis->GetPen()->SetWidth(0.8f);
    axis->GetGridPen()->SetColorF(0.88, 0.88, 0.88);
    axis->GetGridPen()->SetWidth(0.5f);
    set_font(axis->GetTitleProperties(), size);
    set_font(axis->GetLabelProperties(), size);
}

void add_curve(vtkChartXY* chart, const Curve& curve, const Scale& x_scale, const Scale& y_scale) {
    vtkNew<vtkDoubleArray> x, y;
    x->SetName("x");
    y->SetName("y");
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
        const double x_shown = x_scale(curve.x[i]), y_shown = y_scale(curve.y[i]);
        if (!std::isfinite(x_shown) || !std::isfinite(y_shown)) continue;
        x->InsertNextValue(x_shown);
        y->InsertNextValue(y_shown);
    }
    // VTK draws no axes without a curve, and no curve of less than two points: a point of no length then
    while (x->GetNumberOfTuples() < 2) {
        x->InsertNextValue(x->GetNumberOfTuples() > 0 ? x->GetValue(0) : x_scale.low);
        y->InsertNextValue(y->GetNumberOfTuples() > 0 ? y->GetValue(0) : y_scale.low);
    }
    vtkNew<vtkTable> table;
    table->AddColumn(x);
    table->AddColumn(y);
    vtkPlot* plot = chart->AddPlot(vtkChart::LINE);
    plot->SetInputData(table, 0, 1);
    plot->SetColor(byte(curve.colour.red), byte(curve.colour.green), byte(curve.colour.blue), byte(curve.colour.alpha));
    plot->SetWidth(static_cast<float>(curve.width));
    plot->GetPen()->SetLineType(vtkPen::SOLID_LINE + curve.dash % n_line_patterns);
    plot->SetLabel(curve.label);
}

/// VTK draws axes, grid and curves with the corners of the axes on `area`.
void draw_plot(Canvas& canvas, vtkChartXY* plot, const Area& area) {
    plot->SetLayoutStrategy(vtkChart::AXES_TO_RECT);
    plot->SetSize(vtkRectf(area.left, area.bottom, area.width, area.height));
    plot->SetRenderEmpty(true);
    vtkNew<vtkContextScene> scene;
    scene->SetGeometry(static_cast<int>(page_width), static_cast<int>(std::lround(canvas.height())));
    scene->AddItem(plot);
    vtkNew<CairoDevice> device;
    device->draw_on(canvas);
    vtkNew<vtkContext2D> context;
    context->Begin(device);
    scene->Paint(context);
    context->End();
}

bool overlap(const Area& a, const Area& b) { return a.left < b.right() && b.left < a.right() && a.bottom < b.top() && b.bottom < a.top(); }

/// Where curves run on the page, at steps shorter than a letter.
std::vector<Vec2> trails(const Chart& chart, const Area& area, const Scale& x, const Scale& y, double step) {
    std::vector<Vec2> points;
    for (const Curve& curve : chart.curves)
        for (std::size_t i = 0; i < curve.x.size(); ++i) {
            const Vec2 at(area.left + area.width * x.part(curve.x[i]), area.bottom + area.height * y.part(curve.y[i]));
            if (!at.allFinite()) continue;
            if (i > 0 && !points.empty() && (at - points.back()).norm() < page_width)
                while ((at - points.back()).norm() > step) points.push_back(points.back() + step * (at - points.back()).normalized());
            points.push_back(at);
        }
    return points;
}

/// Where the name of a level touches no other one and hides least of the curves: above its line or below, at the side that it wants or the other.
void name_level(Canvas& canvas, const Area& area, const Level& level, double at, double size, const std::vector<Vec2>& curves, std::vector<Area>& taken) {
    const double width = text_width(level.label, size), height = 1.1 * size;
    std::optional<Area> best;
    std::ptrdiff_t least = 0;
    for (const bool other_side : {false, true})
        for (const bool below : {false, true}) {
            const bool right = level.name_right != other_side;
            const Area place{right ? area.right() - 4 - width : area.left + 8, below ? at - 3 - height : at + 3, width, height};
            const bool free = std::none_of(taken.begin(), taken.end(), [&](const Area& t) { return overlap(t, place); });
            if (!free || place.bottom < area.bottom || place.top() > area.top()) continue;
            const auto hidden = std::count_if(curves.begin(), curves.end(), [&](const Vec2& p) { return overlap(place, {p.x() - 2, p.y() - 1, 4, 2}); });
            if (best && hidden >= least) continue;
            best = place, least = hidden;
        }
    if (!best) return;
    const double left = best->left - 2, end = best->right() + 2;
    canvas.fill({{left, best->bottom}, {end, best->bottom}, {end, best->top()}, {left, best->top()}}, {1, 1, 1, 0.8});
    canvas.text({best->left, best->bottom + 0.25 * size}, level.label, {.size = size});
    taken.push_back(*best);
}

void draw_levels(Canvas& canvas, const Area& area, const std::vector<Level>& levels, const Scale& y_scale, double size, const std::vector<Vec2>& curves) {
    std::vector<Area> taken;
    for (const Level& level : levels) {
        const double at = area.bottom + area.height * y_scale.part(level.y);
        canvas.line({{area.left, at}, {area.right(), at}}, ink, 0.8, {5, 3});
    }
    for (const Level& level : levels) name_level(canvas, area, level, area.bottom + area.height * y_scale.part(level.y), size, curves, taken);
}

/// Bars and markers, which lie over all curves.
void draw_points(Canvas& canvas, const Area& area, const Curve& curve, const Scale& x_scale, const Scale& y_scale) {
    const auto place = [&](double x, double y) { return Vec2(area.left + area.width * x_scale.part(x), area.bottom + area.height * y_scale.part(y)); };
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
        if (!std::isfinite(x_scale(curve.x[i])) || !std::isfinite(y_scale(curve.y[i]))) continue;
        if (i < curve.low.size() && std::isfinite(y_scale(curve.high[i]))) {
            const double least = std::isfinite(y_scale(curve.low[i])) ? curve.low[i] : curve.y[i];
            const Vec2 a = place(curve.x[i], least), b = place(curve.x[i], curve.high[i]), cap(3, 0);
            canvas.segments({a, b, a - cap, a + cap, b - cap, b + cap}, curve.colour, 1);
        }
        draw_marker(canvas, curve.marker, place(curve.x[i], curve.y[i]), curve.colour);
    }
}

/// Short ticks at 2, 3, ... 9 times the powers of ten.
void draw_minor_ticks(Canvas& canvas, const Area& area, const Scale& scale, bool along_x) {
    if (!scale.logarithmic) return;
    for (double exponent = std::floor(scale.low); exponent < scale.high; ++exponent)
        for (int digit = 2; digit <= 9; ++digit) {
            const double part = (exponent + std::log10(digit) - scale.low) / (scale.high - scale.low);
            if (part <= 0 || part >= 1) continue;
            const Vec2 at = along_x ? Vec2(area.left + part * area.width, area.bottom) : Vec2(area.left, area.bottom + part * area.height);
            canvas.line({at, at + (along_x ? Vec2(0, 3) : Vec2(3, 0))}, ink, 0.6);
        }
}

/// Even axis: a last step that ends just before a round number still gets the number.
void fit_x(Scale& x, const Range& range) {
    x.low = x(range.low), x.high = x(range.high);
    const double rounded = round_range(x.low, x.high, 9)[1];
    if (rounded - x.high < 0.02 * (x.high - x.low)) x.high = rounded;
}

void fit(Scale& scale, const Range& range) {
    const double low = scale(range.low), high = scale(range.high);
    // what reaches a little below zero gets a little room there, not a whole step
    constexpr double little = 0.05;
    const bool hardly_negative = !scale.logarithmic && low < 0 && -low < little * high;
    const auto limits = scale.logarithmic ? logarithmic_range(low, high) : round_range(hardly_negative ? 0 : low, high, 8);
    scale.low = hardly_negative ? 1.5 * low : limits[0], scale.high = limits[1];
}

}  // namespace

Colour curve_colour(std::size_t i) {
    constexpr std::array<Colour, 6> colours{{{0, 0.447, 0.698}, {0.835, 0.369, 0}, {0, 0.62, 0.451}, {0.902, 0.624, 0}, {0.8, 0.475, 0.655}, {0.337, 0.706, 0.914}}};
    return colours[i % colours.size()];
}

AxisRanges axis_ranges(const Chart& chart) {
    const auto [x, y] = ranges_of(chart, {});
    return {.x = {x.low, x.high}, .y = {y.low, y.high}};
}

std::vector<KeyEntry> key_of(const Chart& chart) {
    std::vector<KeyEntry> entries;
    if (chart.curves.size() > 1)
        for (const Curve& curve : chart.curves) entries.push_back({curve.label, curve.colour, curve.width, curve.dash, curve.marker});
    return entries;
}

DrawnFigure draw_chart(const Chart& chart, const std::filesystem::path& file, int pixels, const ChartPlace& place) {
    auto [x_range, y_range] = ranges_of(chart, place.axes);
    Scale x = x_range.scale(chart.x_unit), y = y_range.scale(chart.y_unit);
    chart.x_logarithmic ? fit(x, x_range) : fit_x(x, x_range);
    fit(y, y_range);

    const double larger = place.panel ? panel_type : 1, size = larger * type_size;
    const std::vector<KeyEntry> key = place.panel ? std::vector<KeyEntry>() : key_of(chart);
    const double beside = key.empty() ? 0 : key_width(key) + gap;
    const double height = std::max(plot_height, std::min(key_height(key, beside - gap), highest_key));
    const Ticks y_ticks = ticks_of(y, place.panel ? 5 : 8, height, size, true);
    double left = larger * room_left;
    for (const std::string& label : y_ticks.labels) left = std::max(left, text_width(label, size) + 2.6 * size);
    Area area{left, larger * room_below, page_width - left - room_right - beside, height};
    const Ticks x_ticks = ticks_of(x, place.panel ? 5 : 9, area.width, size, false);
    const Title title = fitted_title(chart.title, "", page_width - left - room_right);

    vtkNew<vtkChartXY> plot;
    set_axis(plot->GetAxis(vtkAxis::BOTTOM), chart.x_quantity, x, x_ticks, size);
    set_axis(plot->GetAxis(vtkAxis::LEFT), chart.y_quantity, y, y_ticks, size);
    for (const Curve& curve : chart.curves) add_curve(plot, curve, x, y);

    Canvas canvas(file, area.top() + (place.panel ? room_above : title.height()), pixels);
    draw_plot(canvas, plot, area);
    draw_minor_ticks(canvas, area, x, true);
    draw_minor_ticks(canvas, area, y, false);
    for (const Curve& curve : chart.curves) draw_points(canvas, area, curve, x, y);
    draw_key(canvas, key, {area.right() + gap, area.bottom, beside - gap, area.height});
    if (!place.panel) draw_title(canvas, title, area.left, page_width - room_right, area.top());
    if (!chart.levels.empty()) draw_levels(canvas, area, chart.levels, y, size, trails(chart, area, x, y, 0.4 * size));
    canvas.finish();
    return {file, canvas.height(), canvas.texts()};
}

}  // namespace knap
