#include "figures/figures.hpp"

#include "base/display_unit.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "figures/animation.hpp"
#include "figures/body_figures.hpp"
#include "figures/canvas.hpp"
#include "figures/curve_figures.hpp"

#include <algorithm>
#include <cctype>

namespace knap {
namespace {

/// Data for a figure that is drawn from histories.
struct Source {
    const Histories& histories;
    const FigureOptions& options;
    const FigureContext& context;
};

/// A figure that is drawn from histories. A new one is a row of curve_kinds.
struct CurveKind {
    const char* show;
    const char* doc;
    Chart (*chart)(const Source&);  // null: the rose
    History Histories::*table;
    FigureNeed needs = FigureNeed::nothing;
    bool grows = false;  // a point for every line of the histories, which then have a column `time`
    bool marks = false;  // takes_marks()
};

const CurveKind curve_kinds[] = {
    {"energy", "all terms of the energy balance over time",
     [](const Source& s) { return energy_chart(s.histories.energy); }, &Histories::energy, FigureNeed::nothing, true},
    {"crack_length", "length of the main crack, of all arms and of all broken edges over time",
     [](const Source& s) { return crack_length_chart(s.histories.cracks); }, &Histories::cracks, FigureNeed::nothing,
     true},
    {"crack_speed", "speed of the main tip over time, beside the Rayleigh wave speed",
     [](const Source& s) { return crack_speed_chart(s.histories.cracks, s.context.rayleigh_speed); },
     &Histories::cracks, FigureNeed::nothing, true},
    {"reactions", "forces of driven boundaries and obstacles over their displacement (over = \"time\": over time)",
     [](const Source& s) { return reaction_chart(s.histories.reactions, s.options.over == "time"); },
     &Histories::reactions, FigureNeed::driver, true, true},
    {"probes", "displacement of places, opening and slip of interfaces; of tips alone as probe_tips",
     [](const Source& s) {
         return probe_chart(s.histories.probes, s.options.over == "temperature", s.context.celsius);
     },
     &Histories::probes, FigureNeed::probe_of_motion, true, true},
    {"probe_velocities", "velocity of the places of probes over time",
     [](const Source& s) { return probe_velocity_chart(s.histories.probes); }, &Histories::probes,
     FigureNeed::probe_of_place, true},
    {"probe_stresses", "mean stress of probes over time",
     [](const Source& s) { return probe_stress_chart(s.histories.probes); }, &Histories::probes,
     FigureNeed::probe_of_stress, true},
    {"probe_tips", "stress intensity factors of the tips of probes over time, until something breaks beside them",
     [](const Source& s) { return tip_chart(s.histories.probes); }, &Histories::probes, FigureNeed::probe_of_tip, true},
    {"fluid_pressures", "pressures of the fluids of [[pressure]] over time",
     [](const Source& s) { return fluid_pressure_chart(s.histories.fluids); }, &Histories::fluids, FigureNeed::fluid,
     true},
    {"fluid_volumes", "volumes of the cracks that these fluids fill, and of what was injected, over time",
     [](const Source& s) { return fluid_volume_chart(s.histories.fluids); }, &Histories::fluids, FigureNeed::fluid,
     true},
    {"fluid_lengths", "lengths of the cracks that these fluids fill over time",
     [](const Source& s) { return fluid_length_chart(s.histories.fluids); }, &Histories::fluids, FigureNeed::fluid,
     true},
    {"stress_strain", "stress over strain of a [specimen], with its characteristic stresses",
     [](const Source& s) { return stress_strain_chart(s.histories.stress_strain); }, &Histories::stress_strain,
     FigureNeed::specimen, true},
    {"breaks", "number of broken interfaces over time, in tension and in shear",
     [](const Source& s) {
         const std::vector<double> time = s.histories.energy.column("time");
         return break_chart(s.histories.breaks, time.front(), time.back());
     },
     &Histories::breaks, FigureNeed::breaks},
    {"rose", "directions of broken interfaces", nullptr, &Histories::breaks, FigureNeed::breaks},
    {"fragments", "mass of fragments that passes a sieve, over its size",
     [](const Source& s) { return fragment_size_chart(s.histories.fragments); }, &Histories::fragments,
     FigureNeed::fragments},
};

/// Null for a figure of the body.
const CurveKind* curve_kind(const std::string& show) {
    const auto found = std::ranges::find(curve_kinds, show, &CurveKind::show);
    return found == std::end(curve_kinds) ? nullptr : &*found;
}

/// The curves with the measured points; not for the rose.
Chart chart_of(const CurveKind& kind, const Source& source) {
    Chart chart = kind.chart(source);
    Curve points{.label = source.options.measured_by, .colour = measured_colour, .width = 0, .marker = measured_marker};
    for (const Vec2& x : source.options.measured) {
        points.x.push_back(x.x()), points.y.push_back(x.y());
        if (auto& within = chart.x_within) within = {std::min(within->low, x.x()), std::max(within->high, x.x())};
    }
    if (!points.x.empty()) chart.curves.push_back(points);
    return chart;
}

bool by_colour(const std::string& show) {
    const BodyKind* kind = body_kind(show);
    return kind && kind->by_colour;
}

/// Why a figure cannot be drawn from these histories; null where it can be.
const char* missing(const std::string& show, const std::string& colour, const Histories& histories) {
    const auto unless = [](const History& table, const char* origin) {
        return table.columns.empty() ? origin : nullptr;
    };
    const auto unless_probe = [&](std::initializer_list<const char*> endings, const char* reason) {
        if (histories.probes.columns.empty()) return "probes.csv is written where the scenario has a [[probe]]";
        for (const std::string& column : histories.probes.columns)
            for (const char* ending : endings)
                if (column.ends_with(ending)) return static_cast<const char*>(nullptr);
        return reason;
    };
    switch (need_of_figure(show, colour)) {
        case FigureNeed::nothing:
        case FigureNeed::heat: return nullptr;  // a frame tells whether there is some
        case FigureNeed::driver:
            return unless(histories.reactions,
                          "reactions.csv is written where a load prescribes a motion or there is an obstacle");
        case FigureNeed::probe_of_motion:
            return unless_probe({"_u_x", "_opening", "_K_I"}, "its probes watch stresses, which have no displacement");
        case FigureNeed::probe_of_place:
            return unless_probe({"_v_x"}, "none of its probes watches a place, which would have a velocity");
        case FigureNeed::probe_of_tip: return unless_probe({"_K_I"}, "none of its probes watches a tip");
        case FigureNeed::probe_of_stress: return unless_probe({"_stress_xx"}, "none of its probes watches a stress");
        case FigureNeed::specimen:
            return unless(histories.stress_strain, "stress_strain.csv is written where the scenario has a [specimen]");
        case FigureNeed::fluid:
            return unless(histories.fluids, "fluids.csv is written where the scenario has a [[pressure]]");
        case FigureNeed::breaks: return unless(histories.breaks, "breaks.csv is written with output.breaks = true");
        case FigureNeed::fragments: return unless(histories.fragments, "fragments.csv is written at the end of a run");
    }
    return nullptr;
}

/// Of the rose, whose drawing is fixed.
bool has_fixed_type(const std::string& show) {
    const CurveKind* const kind = curve_kind(show);
    return kind && !kind->chart;
}

void require(bool holds, const char* code, const std::string& message) {
    if (!holds) throw UserError(code, message);
}

void check(const FigureOptions& options) {
    const auto check_word = [](const char* code, const std::string& word, const char* what,
                               const std::vector<std::string>& known) {
        if (std::ranges::count(known, word) == 0)
            throw UserError(code, "`" + word + "` is not " + what, "known: " + joined(known));
    };
    check_word("figure-show", options.show, "a subject of figures", figure_subjects());
    check_word("figure-colour", options.colour, "a quantity that colours cracks", figure_colours());
    check_word("figure-over", options.over, "an abscissa of reactions", figure_abscissas());
    check_type(options);
    require(std::isfinite(options.deform), "figure-deform",
            "displacements cannot be magnified by " + std::to_string(options.deform));
    require(options.aspect >= 1 && options.aspect <= 1000, "figure-aspect",
            "the short side can be magnified by 1 to 1000, not by " + short_number(options.aspect));
    require(options.range.size() != 2 || options.range[0] < options.range[1], "figure-range",
            "the first value of a colour range must be smaller than the second");
    require(!options.box || (options.box->extent().array() > 0).all(), "figure-box",
            "a box is given by its lower left and its upper right corner");
    require(options.mark.empty() || takes_marks(options.show), "figure-mark",
            "marks belong to figures of temperature, probes and reactions");
    require(options.measured.empty() || takes_measured(options.show), "figure-measured",
            "a rose has no axes for measured points");
    require(options.width >= 200 && options.width <= 20000, "figure-width",
            "a figure is 200 to 20000 pixels wide, not " + std::to_string(options.width));
}

OutputError no_memory(const FigureOptions& options) {
    return OutputError("cannot draw `" + options.file + "`: there is not enough memory for a picture that is " +
                       std::to_string(options.width) + " pixels wide; a smaller width needs less");
}

std::filesystem::path file_name(const FigureOptions& options, double time) {
    std::filesystem::path file = options.file;
    if (options.at.size() < 2) return file;
    const double nearest = std::ranges::min(options.at, {}, [&](double at) { return std::abs(at - time); });
    return file.replace_filename(file.stem().string() + "_" + time_text(nearest, true) + file.extension().string());
}

/// A quantity in words, for who does not see it drawn: "stress σ_{xx}" -> "stress sigma xx".
std::string without_symbols(std::string text) {
    static constexpr std::pair<std::string_view, std::string_view> words[] = {
        {"σ", "sigma"}, {"β", "beta"}, {"_{", " "}, {"}", ""}, {"|", ""}};
    for (const auto& [symbol, word] : words)
        for (std::size_t at = 0; (at = text.find(symbol, at)) != text.npos;) text.replace(at, symbol.size(), word);
    return text;
}

}  // namespace

void check_type(const FigureOptions& options) {
    const double points = 72 / 0.0254 * options.paper_width;  // [pt]
    require(points == 0 || (points >= 50 && points <= 5000), "figure-width",
            "a figure on paper is 18 mm to 1.7 m wide, not " + readable(options.paper_width, "m"));
    constexpr double least_width = 200;  // [unit] with room for axes and their numbers
    const Page page = options.page();
    require(page.width >= least_width, "figure-font",
            "labels of " + short_number(page.points * type_size) + " pt leave no room on a page of " +
                readable(options.paper_width > 0 ? options.paper_width : page_width * 0.0254 / 72, "m") + ": at most " +
                short_number(std::floor(10 * page.points * type_size * page.width / least_width) / 10) + " pt");
    require(!has_fixed_type(options.show) || options.font_size == 0, "figure-font",
            "a rose has type by its width; leave font_size out");
}

void check_figure(const FigureOptions& options, const Histories& histories) {
    check(options);
    if (!options.curves.empty()) {
        FigureOptions below = options;
        below.show = options.curves, below.curves.clear(), below.mark.clear(), below.measured.clear();
        if (std::ranges::count(growing_subjects(), options.curves) == 0)
            throw UserError("figure-curves", "`" + options.curves + "` does not grow with the time of an animation",
                            "known: " + joined(growing_subjects()));
        check_figure(below, histories);
    }
    const char* reason = missing(options.show, options.colour, histories);
    if (!reason && options.over == "temperature" &&
        need_of_figure(options.show, options.colour) == FigureNeed::probe_of_motion &&
        std::ranges::none_of(histories.probes.columns, [](const auto& column) { return column.ends_with("_T"); }))
        reason = "no probe of a place has a temperature, which needs [heat]";
    if (!reason) return;
    std::vector<std::string> possible;
    for (const std::string& subject : figure_subjects())
        if (!missing(subject, FigureOptions{}.colour, histories) && (subject != options.show || by_colour(subject)))
            possible.push_back(subject);
    const std::string what = options.show + (by_colour(options.show) ? " by " + options.colour : "");
    throw UserError("nothing-to-show", "the run has no data for a figure of `" + what + "`",
                    std::string(reason) + "; it has " + joined(possible));
}

std::vector<std::string> figure_subjects() {
    std::vector<std::string> names = body_subjects();
    for (const CurveKind& kind : curve_kinds) names.emplace_back(kind.show);
    return names;
}

std::vector<std::pair<std::string, std::string>> described_subjects() {
    std::vector<std::pair<std::string, std::string>> found;
    for (const std::string& name : body_subjects()) found.emplace_back(name, without_symbols(doc_of_body(name)));
    for (const CurveKind& kind : curve_kinds) found.emplace_back(kind.show, kind.doc);
    return found;
}

std::vector<std::string> figure_colours() {
    std::vector<std::string> names;
    for (const CrackColour& colour : crack_colours()) names.push_back(colour.name);
    return names;
}

std::vector<std::string> figure_abscissas() { return {"displacement", "time", "temperature"}; }

std::vector<std::string> growing_subjects() {
    std::vector<std::string> names;
    for (const CurveKind& kind : curve_kinds)
        if (kind.grows) names.emplace_back(kind.show);
    return names;
}

bool FigureOptions::is_animation() const { return knap::is_animation(file); }

Page FigureOptions::page() const {
    constexpr double on_paper = 8;  // [pt]
    if (panel || (paper_width == 0 && font_size == 0)) return {};
    const double width = paper_width > 0 ? 72 / 0.0254 * paper_width : page_width;  // [pt]
    if (has_fixed_type(show)) return {.points = width / page_width};
    const double points = (font_size > 0 ? font_size : on_paper) / type_size;
    return {.width = width / points, .points = points};
}

std::vector<IdleKey> idle_keys(const FigureOptions& options) {
    const FigureOptions usual;
    const bool body = shows_body(options.show), moves = options.is_animation();
    const std::string type = std::filesystem::path(options.file).extension().string();
    const bool on_paper = type == ".svg" || type == ".pdf";
    std::vector<IdleKey> keys;
    const auto unless = [&](bool has_effect, const char* key, bool is_usual, const char* owner, const char* cure = "") {
        if (!has_effect) keys.push_back({key, owner, cure, is_usual});
    };
    const char* const animated = "a file that ends in .webp";
    unless(moves, "every", options.every == usual.every, "an animation", animated);
    unless(moves, "speed", options.speed == usual.speed, "an animation", animated);
    unless(moves, "curves", options.curves.empty(), "an animation", animated);
    unless(!moves, "at", options.at.empty(), "pictures", "every = ... for the times of an animation");
    unless(!moves, "panel", !options.panel, "pictures", "another figure for the sheet");
    unless(body || moves, "at", options.at.empty(), "figures of the body");
    unless(body, "box", !options.box, "figures of the body");
    unless(body, "deform", options.deform == usual.deform, "figures of the body");
    unless(body, "aspect", options.aspect == usual.aspect, "figures of the body");
    unless(body, "range", options.range.empty(), "the colours of the body");
    unless(by_colour(options.show), "colour", options.colour == usual.colour, "figures of cracks");
    unless(options.show == "reactions" || options.show == "probes", "over", options.over == usual.over,
           "figures of reactions and probes");
    unless(on_paper, "paper_width", options.paper_width == 0, ".svg and .pdf files", "width, in pixels");
    unless(!on_paper, "width", options.width == usual.width, "files of pixels",
           "of .svg and .pdf files paper_width = \"84 mm\", or `knap render --width 84mm`");
    return keys;
}

std::string words_of(const FigureOptions& options) {
    const CurveKind* const curve = curve_kind(options.show);
    std::string text = curve ? curve->doc : doc_of_body(options.show);
    if (by_colour(options.show)) text += ", coloured by " + crack_colour(options.colour).quantity;
    text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
    return without_symbols(text);
}

std::string caption_of(const FigureOptions& options, const std::filesystem::path& file, double end) {
    const std::filesystem::path own = options.file;
    const std::string name = file.stem().string(), stem = own.stem().string();
    if (file.extension() != own.extension() || !name.starts_with(stem)) return "";
    const std::string after = name.substr(stem.size());  // "_40us"
    if (!after.empty() && (options.at.size() < 2 || after[0] != '_')) return "";
    std::string text = words_of(options);
    if (options.is_animation()) text += ", moving";
    else if (!after.empty()) text += ", t = " + after.substr(1);
    else if (shows_body(options.show))
        text += ", t = " + time_text(options.at.empty() ? end : std::min(options.at[0], end));
    return (options.title.empty() ? "" : options.title + ": ") + text;
}

bool shows_body(const std::string& subject) { return body_kind(subject) != nullptr; }

bool has_few_colours(const std::string& subject) {
    const BodyKind* kind = body_kind(subject);
    return kind && kind->few_colours;
}

bool takes_marks(const std::string& subject) {
    if (const CurveKind* kind = curve_kind(subject)) return kind->marks;
    const BodyField* field = body_field(subject);
    return field && field->at_corner;
}

bool takes_measured(const std::string& subject) {
    const CurveKind* kind = curve_kind(subject);
    return !kind || kind->chart;
}

FigureNeed need_of_figure(const std::string& show, const std::string& colour) {
    if (const CurveKind* kind = curve_kind(show)) return kind->needs;
    if (const BodyField* field = body_field(show)) return field->needs;
    const auto found = std::ranges::find(crack_colours(), colour, &CrackColour::name);
    const bool by_table = by_colour(show) && found != crack_colours().end() && !found->column.empty();
    return by_table ? FigureNeed::breaks : FigureNeed::nothing;
}

std::string_view unit_of_figure(const std::string& show, const std::string& colour) {
    if (const BodyField* field = body_field(show)) return field->unit;
    for (const CrackColour& known : crack_colours())
        if (by_colour(show) && known.name == colour) return known.unit;
    if (const BodyKind* kind = body_kind(show)) return kind->unit;
    return "";
}

Vec2 picture_size(const FigureOptions& options, const Vec2& extent) {
    constexpr double title = 40, legend = 60, chart = 330;  // [unit] usual ones
    double height = chart;
    if (shows_body(options.show)) {
        height =
            body_plot({Vec2::Zero(), extent.cwiseMax(1e-6 * extent.maxCoeff())}, options, legend).area.top() + title;
        if (!options.curves.empty()) height += chart;
    }
    const double width = options.page().width;
    return options.width / width * Vec2(width, height);
}

double longest_side(const FigureOptions& options) {
    const std::string type = std::filesystem::path(options.file).extension().string();
    if (type == ".svg" || type == ".pdf") return infinity;
    return type == ".webp" ? 16383 : 32767;  // of the format; of Cairo
}

/// Bytes a pixel, as measured: page and body; an animation keeps several pictures to compare them.
double drawing_memory(const FigureOptions& options, const Vec2& extent) {
    const Vec2 size = picture_size(options, extent);
    return (options.is_animation() ? 48 : 12) * size.x() * size.y();
}

bool waits_for_the_end(const FigureOptions& options) {
    return shows_body(options.show) && (options.at.size() > 1 || options.panel || options.is_animation());
}

FigureScale joined(const FigureScale& a, const FigureScale& b) {
    return {.seen = {a.seen.low.cwiseMin(b.seen.low), a.seen.high.cwiseMax(b.seen.high)},
            .values = joined(a.values, b.values),
            .damaged = a.damaged || b.damaged,
            .precracks = a.precracks || b.precracks};
}

FigureScale scale_of(const FigureOptions& options, const Frame& frame, const Histories& histories,
                     const FigureContext& context) {
    check_figure(options, histories);
    if (shows_body(options.show)) return body_scale(options, frame, histories);
    const CurveKind& kind = *curve_kind(options.show);
    return kind.chart ? FigureScale{.seen = axis_ranges(chart_of(kind, {histories, options, context}))} : FigureScale{};
}

Legend panel_legend(const FigureOptions& options, const Frame& frame, const Histories& histories,
                    const FigureContext& context, const FigureScale& scale) {
    if (shows_body(options.show)) return body_legend(options, frame, context, scale);
    const CurveKind& kind = *curve_kind(options.show);
    return kind.chart ? Legend{.entries = entries_of(chart_of(kind, {histories, options, context}))} : Legend{};
}

DrawnFigure draw_figure(const FigureOptions& options, const Frame& frame, const Histories& histories,
                        const FigureContext& context, const std::filesystem::path& directory,
                        const FigureScale* common) try {
    check_figure(options, histories);
    if (shows_body(options.show))
        return draw_body(options, frame, histories, context, directory / file_name(options, frame.time),
                         common ? *common : body_scale(options, frame, histories));
    const std::string title = options.title.empty() ? context.title : options.title;
    const CurveKind& kind = *curve_kind(options.show);
    if (!kind.chart) return draw_rose(histories.breaks, title, directory / options.file, options.width, options.page());
    Chart chart = chart_of(kind, {histories, options, context});
    if (!title.empty()) chart.title = title;
    chart.marks = options.mark;
    ChartPlace place{.axes = {}, .panel = options.panel, .page = options.page()};
    if (common) place.axes = common->seen;
    return draw_chart(chart, directory / options.file, options.width, place);
} catch (const std::bad_alloc&) {
    throw no_memory(options);
}

DrawnFigure draw_picture(const FigureOptions& options, const Frame& frame, const Histories& histories,
                         const FigureContext& context, const FigureScale& common) try {
    check_figure(options, histories);
    DrawnFigure drawn = draw_body(options, frame, histories, context, "", common);
    if (options.curves.empty()) return drawn;
    const CurveKind& kind = *curve_kind(options.curves);
    const std::vector<double> times = (histories.*kind.table).column("time");
    const auto n = std::ranges::upper_bound(times, frame.time * (1 + 1e-9)) - times.begin();
    const DrawnFigure below = draw_chart(kind.chart({histories, options, context}), "", options.width,
                                         {.page = options.page(), .n_points = static_cast<std::size_t>(n)});
    drawn.image = stacked(drawn.image, below.image);
    return drawn;
} catch (const std::bad_alloc&) {
    throw no_memory(options);
}

}  // namespace knap
