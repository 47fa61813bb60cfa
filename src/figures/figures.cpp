#include "figures/figures.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "figures/body_figures.hpp"
#include "figures/crack_colours.hpp"
#include "figures/curve_figures.hpp"
#include "figures/rock_figures.hpp"
#include "figures/ticks.hpp"

#include <algorithm>
#include <cmath>

namespace knap {

namespace {

bool among(const std::vector<std::string>& words, const std::string& word) { return std::find(words.begin(), words.end(), word) != words.end(); }

void check(const FigureOptions& options) {
    if (!among(figure_subjects(), options.show))
        throw UserError("figure-show", "`" + options.show + "` is nothing a figure can show", "known: " + joined(figure_subjects()));
    crack_colour(options.colour);
    if (!among(figure_abscissas(), options.over))
        throw UserError("figure-over", "reactions cannot be drawn over `" + options.over + "`", "known: " + joined(figure_abscissas()));
    if (!std::isfinite(options.deform)) throw UserError("figure-deform", "displacements cannot be drawn " + std::to_string(options.deform) + " times as large");
    if (!(options.aspect >= 1 && options.aspect <= 1000))
        throw UserError("figure-aspect", "the short side can be drawn 1 to 1000 times larger than the long one, not " + short_number(options.aspect));
    if (options.range.size() == 2 && !(options.range[0] < options.range[1])) throw UserError("figure-range", "a colour range must ascend");
    if (options.box && !(options.box->low.array() < options.box->high.array()).all()) throw UserError("figure-box", "a box is given by its lower left and its upper right corner");
    if (options.width < 200 || options.width > 20000)
        throw UserError("figure-width", "a figure is 200 to 20000 pixels wide, not " + std::to_string(options.width));
}

/// With several times asked for, the one nearest to the frame's is put before the ending.
std::filesystem::path file_name(const FigureOptions& options, double time) {
    std::filesystem::path file = options.file;
    if (options.at.size() < 2) return file;
    const double asked = *std::min_element(options.at.begin(), options.at.end(),
                                           [&](double a, double b) { return std::abs(a - time) < std::abs(b - time); });
    return file.replace_filename(file.stem().string() + "_" + time_text(asked, true) + file.extension().string());
}

/// A figure that is drawn from histories. A new one is a row of curve_kinds.
struct CurveKind {
    const char* show;
    Chart (*chart)(const FigureOptions&, const Histories&, const FigureContext&);  // null: draw_rose
    History Histories::*table = nullptr;  // null: every run has it
    const char* origin = "";              // of the table, for a run without it
};

constexpr const char* origin_of_probes = "probes.csv is written where the scenario has a [[probe]]";
constexpr const char* origin_of_breaks = "breaks.csv is written with output.breaks = true";

using Options = FigureOptions;
using Context = FigureContext;
const CurveKind curve_kinds[] = {
    {"energy", [](const Options&, const Histories& h, const Context&) { return energy_chart(h.energy); }},
    {"crack_length", [](const Options&, const Histories& h, const Context&) { return crack_length_chart(h.cracks); }},
    {"crack_speed",
     [](const Options&, const Histories& h, const Context& context) { return crack_speed_chart(h.cracks, context.rayleigh_speed); }},
    {"reactions",
     [](const Options& options, const Histories& h, const Context&) { return reaction_chart(h.reactions, options.over == "time"); },
     &Histories::reactions, "reactions.csv is written where a load prescribes a motion or there is an obstacle"},
    {"probes", [](const Options&, const Histories& h, const Context&) { return probe_chart(h.probes); }, &Histories::probes,
     origin_of_probes},
    {"probe_velocities", [](const Options&, const Histories& h, const Context&) { return probe_velocity_chart(h.probes); },
     &Histories::probes, origin_of_probes},
    {"stress_strain", [](const Options&, const Histories& h, const Context&) { return stress_strain_chart(h.stress_strain); },
     &Histories::stress_strain, "stress_strain.csv is written where the scenario has a [specimen]"},
    {"breaks",
     [](const Options&, const Histories& h, const Context&) {
         const std::vector<double> time = h.energy.column("time");
         return break_chart(h.breaks, time.front(), time.back());
     },
     &Histories::breaks, origin_of_breaks},
    {"rose", nullptr, &Histories::breaks, origin_of_breaks},
    {"fragments", [](const Options&, const Histories& h, const Context&) { return fragment_size_chart(h.fragments); },
     &Histories::fragments, "fragments.csv is written at the end of a run"},
};

/// Null for a picture of the body.
const CurveKind* curve_kind(const std::string& show) {
    const auto found = std::ranges::find(curve_kinds, show, &CurveKind::show);
    return found == std::end(curve_kinds) ? nullptr : &*found;
}

Chart chart_of(const FigureOptions& options, const Histories& histories, const FigureContext& context) {
    return curve_kind(options.show)->chart(options, histories, context);
}

/// Which table a figure is drawn from, and where that comes from; null where every run has what it needs.
struct Source {
    const History* table = nullptr;
    const char* note = "";
};

Source source_of(const std::string& show, const std::string& colour, const Histories& histories) {
    if (show == "cracks" && crack_colour(colour).needs_breaks) return {&histories.breaks, origin_of_breaks};
    const CurveKind* kind = curve_kind(show);
    return kind && kind->table ? Source{&(histories.*kind->table), kind->origin} : Source{};
}

}  // namespace

void check_figure(const FigureOptions& options, const Histories& histories) {
    check(options);
    const Source source = source_of(options.show, options.colour, histories);
    const std::string what = options.show == "cracks" ? "cracks by " + options.colour : options.show;
    const auto refuse = [&](const std::string& why) {
        std::vector<std::string> there;
        for (const std::string& subject : figure_subjects())
            if (subject == options.show && subject != "cracks") continue;
            else if (const Source other = source_of(subject, "opening", histories); other.table == nullptr || !other.table->columns.empty()) there.push_back(subject);
        throw UserError("nothing-to-show", "the run has nothing that `" + what + "` could show", why + "; it has " + joined(there));
    };
    if (source.table != nullptr && source.table->columns.empty()) refuse(source.note);
    if (options.show != "probe_velocities") return;
    const std::vector<std::string>& columns = histories.probes.columns;
    if (std::none_of(columns.begin(), columns.end(), [](const std::string& name) { return name.ends_with("_v_x"); })) refuse("its probes watch interfaces, which have no velocity");
}

std::vector<std::string> figure_fields() {
    std::vector<std::string> names;
    for (const BodyField& field : body_fields()) names.push_back(field.name);
    return names;
}

std::vector<std::string> figure_subjects() {
    std::vector<std::string> names{"cracks", "materials"};
    for (const std::string& field : figure_fields()) names.push_back(field);
    for (const CurveKind& kind : curve_kinds) names.emplace_back(kind.show);
    return names;
}

std::vector<std::string> figure_colours() {
    std::vector<std::string> names;
    for (const CrackColour& colour : crack_colours()) names.push_back(colour.name);
    return names;
}

std::vector<std::string> figure_abscissas() { return {"displacement", "time"}; }

bool shows_body(const std::string& subject) {
    const auto is_subject = [&](const BodyField& field) { return field.name == subject; };
    return subject == "cracks" || subject == "materials" || std::any_of(body_fields().begin(), body_fields().end(), is_subject);
}

bool needs_breaks(const std::string& show, const std::string& colour) {
    if (show == "cracks") return among(figure_colours(), colour) && crack_colour(colour).needs_breaks;
    const CurveKind* kind = curve_kind(show);
    return kind && kind->table == &Histories::breaks;
}

std::string_view unit_of_figure(const std::string& show, const std::string& colour) {
    if (show == "cracks") return among(figure_colours(), colour) ? std::string_view(crack_colour(colour).unit) : "";
    for (const BodyField& field : body_fields())
        if (field.name == show) return field.unit;
    return "";
}

std::string magnification(const FigureOptions& options, bool obstacles) {
    if (!shows_body(options.show) || options.deform == 1) return "";
    return "displacements × " + short_number(options.deform) + (obstacles ? ", so closed gaps overlap" : "");
}

bool waits_for_the_end(const FigureOptions& options) { return shows_body(options.show) && (options.at.size() > 1 || options.panel); }

FigureScale joined(const FigureScale& a, const FigureScale& b) {
    return {.seen = {a.seen.low.cwiseMin(b.seen.low), a.seen.high.cwiseMax(b.seen.high)},
            .values = joined(a.values, b.values),
            .damaged = a.damaged || b.damaged,
            .precracks = a.precracks || b.precracks};
}

FigureScale scale_of(const FigureOptions& options, const Frame& frame, const Histories& histories, const FigureContext& context) {
    check_figure(options, histories);
    if (shows_body(options.show)) return body_scale(options, frame, &histories.breaks);
    if (options.show == "rose") return {};
    const AxisRanges axes = axis_ranges(chart_of(options, histories, context));
    return {.seen = {{axes.x[0], axes.y[0]}, {axes.x[1], axes.y[1]}}};
}

Legend panel_legend(const FigureOptions& options, const Frame& frame, const Histories& histories, const FigureContext& context, const FigureScale& scale) {
    if (shows_body(options.show)) return body_legend(options, frame, context.materials, scale);
    return options.show == "rose" ? Legend{} : Legend{.key = key_of(chart_of(options, histories, context))};
}

std::filesystem::path draw_figure(const FigureOptions& options, const Frame& frame, const Histories& histories, const FigureContext& context,
                                  const std::filesystem::path& directory, const FigureScale* common) {
    check_figure(options, histories);
    const std::string title = options.title.empty() ? context.title : options.title;
    if (shows_body(options.show)) {
        const std::filesystem::path file = directory / file_name(options, frame.time);
        const BodyExtras extras{.scale = common, .breaks = &histories.breaks};
        if (options.show == "materials") return draw_materials(options, frame, context.materials, title, file, extras).file;
        return (options.show == "cracks" ? draw_cracks : draw_field)(options, frame, title, file, extras).file;
    }
    if (options.show == "rose") return draw_rose(histories.breaks, title, directory / options.file, options.width).file;
    Chart chart = chart_of(options, histories, context);
    if (!title.empty()) chart.title = title;
    ChartPlace place{.panel = options.panel};
    if (common != nullptr) place.axes = {{common->seen.low.x(), common->seen.high.x()}, {common->seen.low.y(), common->seen.high.y()}};
    return draw_chart(chart, directory / options.file, options.width, place).file;
}

}  // namespace knap
