// Diagrams of a study: error over cost and over h, or means with their spread over h.
#include "app/convergence.hpp"
#include "app/study.hpp"
#include "observe/chart.hpp"

#include <algorithm>

namespace knap {
namespace {

constexpr int pixels = 1200;
constexpr Colour grey{0.6, 0.6, 0.6};

/// "work_precision_opening_at_16.5_us"
std::string file_name(const std::string& kind, const std::string& quantity) { return kind + "_" + plain_name(quantity); }

/// Along the horizontal axis of what falls with h.
double fineness(const Study& study, std::size_t run) {
    return study.plan.options.refine == Refine::step ? study.results[run].step : study.plan.runs[run].size;
}

Chart empty_chart(const Study& study, const std::string& title, bool over_cost) {
    Chart chart{.title = title, .x_logarithmic = true, .y_logarithmic = true};
    const bool step = study.plan.options.refine == Refine::step;
    chart.x_quantity = over_cost ? "processor time" : step ? "step" : "mesh size";
    chart.x_unit = over_cost || step ? "s" : "m";
    chart.y_quantity = "error";
    return chart;
}

std::string title_of(const Study& study, std::size_t q) {
    return (study.plan.title.empty() ? study.plan.name : study.plan.title) + ": " + study.plan.options.quantities[q].name;
}

void add_line(const Study& study, std::size_t q, std::size_t line, bool over_cost, Chart& chart) {
    Curve curve{.label = study.plan.options.lines[line].name, .colour = curve_colour(line), .dash = curve_dash(line), .marker = marker(line)};
    for (const std::size_t run : study.runs_of(line)) {
        curve.x.push_back(over_cost ? study.results[run].cpu : fineness(study, run));
        curve.y.push_back(study.errors[q].error[run]);
    }
    chart.curves.push_back(std::move(curve));
}

/// What order 1 and order 2 look like, below the smallest error of all.
void add_guides(Chart& chart) {
    double x_low = INFINITY, x_high = 0, y_high = 0;
    for (const Curve& curve : chart.curves)
        for (std::size_t i = 0; i < curve.x.size(); ++i) {
            if (!(curve.y[i] > 0) || !std::isfinite(curve.x[i])) continue;
            x_low = std::min(x_low, curve.x[i]), x_high = std::max(x_high, curve.x[i]), y_high = std::max(y_high, curve.y[i]);
        }
    if (!(x_high > x_low)) return;
    for (const int order : {1, 2})
        chart.curves.push_back({.label = "order " + std::to_string(order),
                                .x = {x_low, x_high},
                                .y = {0.6 * y_high * std::pow(x_low / x_high, order), 0.6 * y_high},
                                .colour = grey,
                                .width = 1,
                                .dash = order == 1 ? 1 : 0});
}

Chart error_chart(const Study& study, std::size_t q, bool over_cost) {
    Chart chart = empty_chart(study, title_of(study, q), over_cost);
    const StudyQuantity& quantity = study.plan.options.quantities[q];
    if (!quantity.scale) chart.y_quantity = study.errors[q].reference != 0 ? "relative error" : "error";
    else chart.y_quantity = "error over its scale";
    for (std::size_t line = 0; line < study.plan.options.lines.size(); ++line) add_line(study, q, line, over_cost, chart);
    if (!over_cost) add_guides(chart);
    return chart;
}

Chart value_chart(const Study& study, std::size_t q) {
    Chart chart = empty_chart(study, title_of(study, q), false);
    const StudyQuantity& quantity = study.plan.options.quantities[q];
    chart.y_logarithmic = false;
    chart.y_quantity = "value";
    chart.y_unit = quantity.unit;
    for (std::size_t line = 0; line < study.plan.options.lines.size(); ++line) {
        Curve curve{.label = study.plan.options.lines[line].name, .colour = curve_colour(line), .dash = curve_dash(line), .marker = marker(line)};
        const std::vector<std::size_t> runs = study.runs_of(line);
        for (std::size_t i = 0; i < runs.size();) {
            std::vector<double> sample;
            const double level = study.plan.runs[runs[i]].level, x = fineness(study, runs[i]);
            for (; i < runs.size() && study.plan.runs[runs[i]].level == level; ++i) sample.push_back(study.results[runs[i]].values[q]);
            const Spread s = spread_of(sample);
            curve.x.push_back(x);
            curve.y.push_back(s.mean);
            curve.low.push_back(s.mean - s.deviation);
            curve.high.push_back(s.mean + s.deviation);
        }
        chart.curves.push_back(std::move(curve));
    }
    if (quantity.exact) chart.levels.push_back({"exact", *quantity.exact});
    return chart;
}

bool has_points(const Chart& chart) {
    return std::any_of(chart.curves.begin(), chart.curves.end(), [](const Curve& c) {
        return std::count_if(c.y.begin(), c.y.end(), [](double y) { return std::isfinite(y); }) > 1;
    });
}

}  // namespace

std::vector<std::filesystem::path> draw_study(const Study& study, const std::filesystem::path& directory) {
    std::filesystem::create_directories(directory);
    std::vector<std::filesystem::path> drawn;
    const auto draw = [&](const Chart& chart, const std::string& name) {
        if (!has_points(chart)) return;
        for (const char* ending : {".png", ".svg"}) drawn.push_back(draw_chart(chart, directory / (name + ending), pixels).file);
    };
    for (std::size_t q = 0; q < study.plan.options.quantities.size(); ++q) {
        const std::string& name = study.plan.options.quantities[q].name;
        if (study.is_statistics()) {
            draw(value_chart(study, q), file_name("statistics", name));
            continue;
        }
        draw(error_chart(study, q, true), file_name("work_precision", name));
        draw(error_chart(study, q, false), file_name("convergence", name));
    }
    return drawn;
}

}  // namespace knap
