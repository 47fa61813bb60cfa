#include "observe/chart.hpp"

#include "observe/cairo_device.hpp"
#include "observe/key.hpp"
#include "observe/ticks.hpp"

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
#include <cmath>

namespace knap {

namespace {

constexpr double page_height = 330, room_left = 58, room_right = 16, room_below = 42, room_above = 28, gap = 12;  // [unit]

struct Range {
    double low = 0, high = 0;
    void add(double value) {
        if (!std::isfinite(value)) return;
        low = std::min(low, value);
        high = std::max(high, value);
    }
    double largest() const { return std::max(-low, high); }
};

unsigned char byte(double channel) { return static_cast<unsigned char>(std::lround(255 * channel)); }

void set_font(vtkTextProperty* text) {
    text->SetFontSize(static_cast<int>(type_size));
    text->SetColor(ink.red, ink.green, ink.blue);
    text->SetBold(false);
}

/// One axis: round ticks in the unit that is shown, thin lines, light grid.
void set_axis(vtkAxis* axis, const std::string& title, double low, double high, int n_ticks) {
    const Ticks ticks = round_ticks(low, high, n_ticks);
    vtkNew<vtkDoubleArray> positions;
    vtkNew<vtkStringArray> labels;
    for (std::size_t i = 0; i < ticks.at.size(); ++i) {
        positions->InsertNextValue(ticks.at[i]);
        labels->InsertNextValue(ticks.labels[i]);
    }
    axis->SetBehavior(vtkAxis::FIXED);
    axis->SetRange(low, high);
    axis->SetCustomTickPositions(positions, labels);
    axis->SetTitle(title);
    axis->SetTickLength(4);
    axis->SetLabelOffset(6);
    axis->GetPen()->SetColorF(ink.red, ink.green, ink.blue);
    axis->GetPen()->SetWidth(0.8f);
    axis->GetGridPen()->SetColorF(0.88, 0.88, 0.88);
    axis->GetGridPen()->SetWidth(0.5f);
    set_font(axis->GetTitleProperties());
    set_font(axis->GetLabelProperties());
}

void add_curve(vtkChartXY* chart, const Curve& curve, double x_factor, double y_factor) {
    vtkNew<vtkDoubleArray> x, y;
    x->SetName("x");
    y->SetName("y");
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
        if (!std::isfinite(curve.x[i]) || !std::isfinite(curve.y[i])) continue;
        x->InsertNextValue(curve.x[i] * x_factor);
        y->InsertNextValue(curve.y[i] * y_factor);
    }
    // VTK draws no axes without a curve, and no curve of less than two points: a point of no length then
    while (x->GetNumberOfTuples() < 2) {
        x->InsertNextValue(x->GetNumberOfTuples() > 0 ? x->GetValue(0) : 0);
        y->InsertNextValue(y->GetNumberOfTuples() > 0 ? y->GetValue(0) : 0);
    }
    vtkNew<vtkTable> table;
    table->AddColumn(x);
    table->AddColumn(y);
    vtkPlot* plot = chart->AddPlot(vtkChart::LINE);
    plot->SetInputData(table, 0, 1);
    plot->SetColor(byte(curve.colour.red), byte(curve.colour.green), byte(curve.colour.blue), byte(curve.colour.alpha));
    plot->SetWidth(static_cast<float>(curve.width));
    plot->GetPen()->SetLineType(curve.dashed ? vtkPen::DASH_LINE : vtkPen::SOLID_LINE);
    plot->SetLabel(curve.label);
}

/// What VTK's own legend would say, beside the chart and so never over a curve.
std::vector<KeyEntry> key_of(const Chart& chart) {
    std::vector<KeyEntry> entries;
    if (chart.curves.size() > 1)
        for (const Curve& curve : chart.curves) entries.push_back({curve.label, curve.colour, curve.width, curve.dashed});
    return entries;
}

/// VTK draws axes, grid and curves with the corners of the axes on `area`.
void draw_plot(Canvas& canvas, vtkChartXY* plot, const Area& area) {
    plot->SetLayoutStrategy(vtkChart::AXES_TO_RECT);
    plot->SetSize(vtkRectf(area.left, area.bottom, area.width, area.height));
    plot->SetRenderEmpty(true);
    vtkNew<vtkContextScene> scene;
    scene->SetGeometry(static_cast<int>(page_width), static_cast<int>(page_height));
    scene->AddItem(plot);
    vtkNew<CairoDevice> device;
    device->draw_on(canvas);
    vtkNew<vtkContext2D> context;
    context->Begin(device);
    scene->Paint(context);
    context->End();
}

void draw_levels(Canvas& canvas, vtkChartXY* chart, const std::vector<Level>& levels, double y_factor) {
    vtkAxis* x = chart->GetAxis(vtkAxis::BOTTOM);
    vtkAxis* y = chart->GetAxis(vtkAxis::LEFT);
    const double left = x->GetPoint1()[0], right = x->GetPoint2()[0], bottom = y->GetPoint1()[1], top = y->GetPoint2()[1];
    for (const Level& level : levels) {
        const double at = bottom + (top - bottom) * (level.y * y_factor - y->GetMinimum()) / (y->GetMaximum() - y->GetMinimum());
        canvas.line({{left, at}, {right, at}}, ink, 0.8, {5, 3});
        canvas.text({left + 8, at + 4}, level.label, {.size = type_size});
    }
}

}  // namespace

DrawnFigure draw_chart(const Chart& chart, const std::filesystem::path& file, int pixels) {
    Range x_range, y_range;
    for (const Curve& curve : chart.curves) {
        for (const double x : curve.x) x_range.add(x);
        for (const double y : curve.y) y_range.add(y);
    }
    for (const Level& level : chart.levels) y_range.add(1.08 * level.y);
    if (x_range.high == x_range.low) x_range.high = 1;
    if (y_range.high == y_range.low) y_range.high = 1;
    const DisplayUnit x_unit = display_unit(x_range.largest(), chart.x_unit), y_unit = display_unit(y_range.largest(), chart.y_unit);

    // a last step that ends just before a round number still gets the number
    const double x_low = x_range.low * x_unit.factor;
    double x_high = x_range.high * x_unit.factor;
    const double rounded = round_range(x_low, x_high, 9)[1];
    if (rounded - x_high < 0.02 * (x_high - x_low)) x_high = rounded;

    vtkNew<vtkChartXY> plot;
    set_axis(plot->GetAxis(vtkAxis::BOTTOM), with_unit(chart.x_quantity, x_unit.unit), x_low, x_high, 9);
    const auto y_limits = round_range(y_range.low * y_unit.factor, y_range.high * y_unit.factor, 8);
    set_axis(plot->GetAxis(vtkAxis::LEFT), with_unit(chart.y_quantity, y_unit.unit), y_limits[0], y_limits[1], 8);
    for (const Curve& curve : chart.curves) add_curve(plot, curve, x_unit.factor, y_unit.factor);

    Canvas canvas(file, page_height, pixels);
    const std::vector<KeyEntry> key = key_of(chart);
    const double beside = key.empty() ? 0 : key_width(canvas, key) + gap;
    const Area area{room_left, room_below, page_width - room_left - room_right - beside, page_height - room_below - room_above};
    draw_plot(canvas, plot, area);
    draw_key(canvas, key, {area.right() + gap, area.bottom, beside, area.height});
    canvas.text({area.left, area.top() + 9}, canvas.fitted(chart.title, title_size, page_width - room_left - room_right, true),
                {.size = title_size, .bold = true});
    draw_levels(canvas, plot, chart.levels, y_unit.factor);
    canvas.finish();
    return {file, canvas.height(), canvas.texts()};
}

}  // namespace knap
