// Figures of a study: errors over cost and over h, or means with their deviations over both. Of a sweep: a contact
// sheet; its trajectories are in trajectories.cpp.
#include "app/ensemble/ensemble.hpp"
#include "base/display_unit.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "figures/body_figures.hpp"
#include "figures/chart.hpp"
#include "figures/contact_sheet.hpp"
#include "output/vtk_series.hpp"
#include "record/run_files.hpp"

#include <algorithm>
#include <regex>
#include <set>

namespace knap {
namespace {

namespace fs = std::filesystem;

// ---- study

/// Lines of order 1 and 2 below the largest error.
void add_guides(Chart& chart) {
    double x = INFINITY, end = 0, y = 0;
    for (const Curve& curve : chart.curves)
        for (std::size_t i = 0; i < curve.x.size(); ++i)
            if (curve.y[i] > 0 && std::isfinite(curve.x[i]))
                x = std::min(x, curve.x[i]), end = std::max(end, curve.x[i]), y = std::max(y, 0.6 * curve.y[i]);
    for (const int order : {1, 2})
        if (end > x)
            chart.curves.push_back({.label = "order " + std::to_string(order),
                                    .x = {x, end},
                                    .y = {y * std::pow(x / end, order), y},
                                    .colour = {0.6, 0.6, 0.6},
                                    .width = 1,
                                    .dash = order == 1 ? 1 : 0});
}

/// Errors of a quantity over processor time or over the step or mesh size; or its means with deviations over them.
Chart chart_of(const Ensemble& study, std::size_t q, bool over_cost) {
    const StudyQuantity& quantity = study.quantities[q];
    const bool errors = !study.errors.empty(), step = study.study.refine == Refine::step;
    const std::regex symbol("\\b([A-Za-z])_([A-Za-z])\\b");  // G_c
    Chart chart{.title = (study.title.empty() ? study.name : study.title) + ": " +
                         std::regex_replace(quantity.name, symbol, "$1_{$2}"),
                .x_quantity = over_cost ? "processor time"
                              : step    ? "step"
                                        : "mesh size",
                .x_unit = over_cost || step ? "s" : "m",
                .y_quantity = "value",
                .y_unit = errors ? "" : quantity.unit,
                .x_logarithmic = true,
                .y_logarithmic = errors};
    if (errors)
        chart.y_quantity = quantity.scale             ? "error relative to the scale"
                           : study.errors[q].relative ? "relative error"
                                                      : "error";
    for (std::size_t line = 0; line < study.study.lines.size(); ++line) {
        Curve curve{.label = study.study.lines[line].name,
                    .colour = curve_colour(line),
                    .dash = curve_dash(line),
                    .marker = marker(line)};
        for (const std::size_t v : study.variants_of(line)) {
            const EnsembleRun& run = study.runs_of(v)[0];
            const Spread s = study.spread(v, q);
            const double cpu = study.spread(v, [](const EnsembleRun& each) { return each.result.cpu; }).mean;
            curve.x.push_back(over_cost ? cpu : step ? run.result.step : run.mesh_size);
            curve.y.push_back(errors ? study.errors[q].error[v] : s.mean);
            if (!errors) curve.low.push_back(s.mean - s.deviation), curve.high.push_back(s.mean + s.deviation);
        }
        chart.curves.push_back(std::move(curve));
    }
    if (errors && !over_cost) add_guides(chart);
    if (!errors && quantity.exact) chart.levels.push_back({"exact", *quantity.exact});
    return chart;
}

/// PNG and SVG of each quantity, where a curve has two points at least.
std::vector<CaptionedFigure> draw_study(const Ensemble& study, const fs::path& figures) {
    std::vector<CaptionedFigure> drawn;
    const auto draw = [&](const Chart& chart, const char* kind, std::size_t q, const char* caption) {
        const auto is_finite = [](double y) { return std::isfinite(y); };
        if (std::ranges::none_of(chart.curves,
                                 [&](const Curve& c) { return std::ranges::count_if(c.y, is_finite) > 1; }))
            return;
        const std::string& name = study.quantities[q].name;
        for (const char* ending : {".png", ".svg"})
            drawn.push_back(
                {draw_chart(chart, figures / (kind + plain_name(name) + ending), 1200).file, caption + name});
    };
    const bool errors = !study.errors.empty();
    for (std::size_t q = 0; q < study.quantities.size(); ++q) {
        const Chart over_time = chart_of(study, q, true), over_step = chart_of(study, q, false);
        if (errors) {
            draw(over_time, "work_precision_", q, "Error over processor time: ");
            draw(over_step, "convergence_", q, "Error over the refined step or mesh: ");
            continue;
        }
        if (study.study.lines.size() > 1)
            draw(over_time, "statistics_over_time_", q, "Mean and standard deviation over seeds, by processor time: ");
        draw(over_step, "statistics_", q, "Mean and standard deviation over seeds, by the refined step or mesh: ");
    }
    return drawn;
}

// ---- sweep

/// A column for every seed or value of the last key where these are few; otherwise a square sheet.
std::size_t n_columns(const Ensemble& sweep) {
    std::set<std::string> last_values;
    for (const Variant& variant : sweep.variants)
        if (!variant.values.empty()) last_values.insert(variant.values.back());
    const bool seeds = sweep.n_seeds > 1;
    const std::size_t n = sweep.keys.empty() ? 0 : seeds ? sweep.n_seeds : last_values.size();
    if (n > 0 && n <= (seeds ? 8 : 6)) return std::min(n, sweep.runs.size());
    const double root = std::ceil(std::sqrt(static_cast<double>(sweep.runs.size())));
    return std::clamp<std::size_t>(static_cast<std::size_t>(root), 1, 12);
}

struct PanelSource {
    FinishedRun run;
    Frame frame;
};

/// Nothing where the run has nothing to show, as one that failed before its end.
std::optional<PanelSource> panel_source(const fs::path& directory, const FigureOptions& sheet) {
    try {
        PanelSource source{read_finished_run(directory), {}};
        check_figure(sheet, source.run.histories);
        if (!shows_body(sheet.show)) return source;
        if (source.run.frame_times.empty()) return {};
        source.frame = read_frame(directory, source.run.frame_times.size() - 1);
        return source;
    } catch (const UserError&) {
        return {};
    }
}

/// Draws the panels of all runs again, with common ranges, and the sheet of them.
fs::path draw_sheet(const Ensemble& sweep, const fs::path& directory) {
    const FigureOptions& sheet = sweep.sheet;
    const auto run_directory = [&](const EnsembleRun& run) { return directory / "runs" / run.name; };
    FigureScale common;
    for (const EnsembleRun& run : sweep.runs)
        if (const auto source = panel_source(run_directory(run), sheet))
            common = joined(common, scale_of(sheet, source->frame, source->run.histories, source->run.context));
    Legend legend;
    std::string magnified;
    std::vector<Tile> tiles;
    for (const EnsembleRun& run : sweep.runs) {
        const fs::path figures = run_directory(run) / "figures";
        tiles.push_back({figures / sheet.file, sweep.caption(run)});
        const auto source = panel_source(run_directory(run), sheet);
        if (!source) continue;
        fs::create_directories(figures);
        draw_figure(sheet, source->frame, source->run.histories, source->run.context, figures, &common);
        magnified = magnification(sheet, source->frame.n_obstacles() > 0);
        legend = joined(legend, panel_legend(sheet, source->frame, source->run.histories, source->run.context, common));
    }
    const int width = std::clamp<int>(static_cast<int>(420 * n_columns(sweep)), 1200, 6000);
    return draw_contact_sheet(tiles, n_columns(sweep), sweep.title.empty() ? sweep.name : sweep.title,
                              directory / "sweep.png", width, legend, magnified)
        .file;
}

/// A round factor of displacements, with which they are a part of the body that can be seen, and no more.
double visible_magnification(double displacement, double diagonal) {
    constexpr double seen = 0.05;
    const double wanted = seen * diagonal / displacement;
    if (!(wanted > 0 && std::isfinite(wanted))) return 1;
    const double power = std::pow(10, std::floor(std::log10(wanted))), digit = wanted / power;
    return (digit >= 5 ? 5 : digit >= 2 ? 2 : 1) * power;
}

double largest_displacement(const Frame& frame) {
    double largest = 0;
    for (const Vec2& u : frame.displacement) largest = std::max(largest, u.norm());
    return largest;
}

/// The run that does not stand at the smallest factor, of two the one that moved, where it had moved too far for one
/// that stands: what falls further does so without new contacts, if there is no [contact].
std::vector<CaptionedFigure> draw_mechanism(const Ensemble& safety, const fs::path& directory) {
    const EnsembleRun* mechanism = nullptr;
    for (const EnsembleRun& run : safety.runs)
        if (safety.variants[run.variant].level == safety.safety->high && run.result.steps > 0) mechanism = &run;
    if (mechanism == nullptr) return {};
    const fs::path of_run = directory / "runs" / mechanism->name;
    const auto source = panel_source(of_run, safety.sheet);
    if (!source) return {};
    Frame frame = source->frame;
    for (std::size_t i = 1; i + 1 < source->run.frame_times.size(); ++i)
        if (Frame earlier = read_frame(of_run, i); largest_displacement(earlier) > safety.safety->options.runaway) {
            frame = std::move(earlier);
            break;
        }
    FigureOptions sheet = safety.sheet;
    const double moved = largest_displacement(frame);
    if (sheet.deform == 1) sheet.deform = visible_magnification(moved, safety.safety->diagonal);
    if (sheet.range.empty()) sheet.range = {0, moved};  // what moves as one has one colour
    return {{draw_figure(sheet, frame, source->run.histories, source->run.context, directory / "figures").file,
             "The mechanism of " + mechanism->name + ", which has moved by " + readable(moved, "m") + " at " +
                 readable(frame.time, "s") + "; displacements × " + shortest(sheet.deform)}};
}

}  // namespace

std::vector<CaptionedFigure> draw_ensemble(const Ensemble& ensemble, const fs::path& directory) {
    const fs::path figures = directory / "figures";
    if (ensemble.is_study() || ensemble.trajectories || ensemble.safety) fs::create_directories(figures);
    if (ensemble.safety) return draw_mechanism(ensemble, directory);
    if (ensemble.is_study()) return draw_study(ensemble, figures);
    std::vector<CaptionedFigure> drawn;
    if (!ensemble.sheet.show.empty())
        drawn.push_back({draw_sheet(ensemble, directory), "The last state of every run, with one range of colours"});
    if (ensemble.trajectories)
        for (CaptionedFigure& figure : draw_trajectories(ensemble, directory / "runs", figures))
            drawn.push_back(std::move(figure));
    return drawn;
}

}  // namespace knap
