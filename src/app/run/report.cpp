#include "app/run/report.hpp"

#include "app/run/checkpoint.hpp"
#include "app/run/run_text.hpp"
#include "base/error.hpp"
#include "base/formatted.hpp"
#include "base/stopwatch.hpp"
#include "base/text.hpp"
#include "base/whole_file.hpp"
#include "figures/animation.hpp"
#include "figures/ticks.hpp"
#include "output/vtk_series.hpp"
#include "record/html.hpp"
#include "record/outputs.hpp"
#include "record/run_files.hpp"
#include "record/version.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace knap {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t min_pictures = 3, max_pictures = 24;
constexpr double share = 0.04;              // of the processor time of the run, for more than the fewest pictures
constexpr std::size_t max_bytes = 700'000;  // of all pictures
constexpr int picture_width = 640;          // [pixel]

/// "0.3 mm"
std::string with_prefix(double value, std::string_view unit) { return shown_text(value, unit, 5); }

// ---- parts of the page

std::string warnings_of(const RunRecord& record) {
    std::vector<std::string> bad, warnings = record.warnings;
    if (record.status != "done") bad.push_back("the run is " + record.status + " at t = " + time_text(record.time));
    if (!record.reason.empty()) bad.push_back(record.reason);
    for (const Gate& gate : record.gates)
        if (gate.level == GateLevel::violated)
            bad.push_back(std::string(gate.name) + ": " + std::string(gate.meaning) + ": " +
                          value_text(gate.value, gate.unit, 4) + ", limit " + value_text(gate.limit, gate.unit, 4) +
                          ". " + std::string(gate.cure));
    for (const ExpectResult& result : record.expect)
        if (!result.pass) bad.push_back(result.name + " = " + result.shown_value + ", expected " + result.shown_limit);
    return html_section("Warnings", html_list(bad, "bad") + html_list(warnings, "warn"));
}

std::string layers_text(const NamedMaterial& material) {
    const auto& across = material.elastic.bedding;
    if (!across) return "";
    const std::string angle = material.layer_angle ? "the angle `" + material.layer_angle->text + "`"
                                                   : value_text(across->angle / degree, "deg", 4);
    return "; layers at " + angle + " to x, across them E = " + with_prefix(across->E, "Pa") +
           ", nu = " + value_text(across->nu, "") + ", G = " + with_prefix(across->G, "Pa");
}

std::string computed(const Scenario& scenario, const RunRecord& record) {
    std::vector<HtmlRow> rows;
    for (const NamedMaterial& m : scenario.materials)
        rows.push_back({"material " + m.name,
                        "E = " + with_prefix(m.elastic.E, "Pa") + ", nu = " + value_text(m.elastic.nu, "") +
                            ", density " + value_text(m.elastic.density, "kg/m3") + "; waves: dilatational " +
                            value_text(m.elastic.dilatational_speed(scenario.plane), "m/s", 4) + ", shear " +
                            value_text(m.elastic.shear_speed(scenario.plane), "m/s", 4) + ", Rayleigh " +
                            value_text(m.elastic.rayleigh_speed(scenario.plane), "m/s", 4) + layers_text(m)});
    for (const NamedLaw& named : scenario.laws) {
        const CohesiveLaw& law = named.law;
        std::string text = law.breakable() ? "strength " + with_prefix(law.sigma_c, "Pa") + ", fracture energy " +
                                                 value_text(law.G_c, "J/m2", 5) + ", critical opening " +
                                                 with_prefix(law.delta_c(), "m") + ", shear over tensile strength " +
                                                 value_text(law.gamma, "", 4)
                                           : "does not break";
        rows.push_back({"interface " + named.name,
                        text + ", friction " + (law.over_pressure ? "over pressure" : value_text(law.friction, "", 4)) +
                            ", restitution " + value_text(law.restitution, "", 4)});
    }
    rows.push_back({"mesh", formatted("%d triangles of order %d, %d interfaces, mean edge ", record.triangles,
                                      scenario.order, record.interfaces) +
                                with_prefix(record.mean_edge, "m") + "; thickness " +
                                value_text(record.thickness, "m") + ", plane " +
                                (scenario.plane == PlaneModel::strain ? "strain" : "stress")});
    rows.push_back({"scheme", scheme_text(scenario.time, scenario.works().viscosity)});
    rows.push_back(
        {"time", time_text(record.time) + " in " + formatted("%lld steps of ", static_cast<long long>(record.steps)) +
                     with_prefix(record.smallest_step, "s") + " to " + with_prefix(record.largest_step, "s")});
    return html_table({}, rows);
}

std::string number_rows(const RunRecord& record) {
    std::vector<HtmlRow> rows;
    for (const auto& [name, value] : record.summary.values) {
        const Output* output = find_output("summary", name);
        rows.push_back({name, output ? with_prefix(value, output->unit) : value_text(value, ""),
                        output ? std::string(output->doc) : ""});
    }
    return html_table({"number", "value", "meaning"}, rows);
}

std::string gates(const RunRecord& record) {
    std::vector<HtmlRow> rows;
    for (const Gate& gate : record.gates)
        rows.push_back({std::string(gate.meaning), value_text(gate.value, gate.unit, 4),
                        std::isinf(gate.limit) ? "none" : value_text(gate.limit, gate.unit, 4),
                        gate.pass() ? std::string(name_of(gate.level)) : "VIOLATED"});
    return html_table({"check", "value", "limit", ""}, rows);
}

std::string expectations(const RunRecord& record) {
    std::vector<HtmlRow> rows;
    for (const ExpectResult& result : record.expect)
        rows.push_back({result.name, result.shown_value, result.shown_limit, result.pass ? "ok" : "FAILED"});
    return html_table({"number", "value", "expected", ""}, rows);
}

std::string origin(const RunRecord& record) {
    std::string versions;
    for (const auto& [name, number] : libraries()) versions += ", " + name + " " + number;
    return html_table(
        {}, {{"command", command_line(record.command)},
             {"program", "knap " + version() + " (" + git_hash() + (git_dirty() ? ", with uncommitted changes" : "") +
                             "), " + compiler() + versions},
             {"seed", std::to_string(record.seed)},
             {"threads", std::to_string(record.threads)},
             {"processor time", value_text(record.spent.cpu, "s", 3)}});
}

// ---- frames

/// Numbers from 0 to n - 1 so that each prefix is spread evenly: the ends, the middle, the quarters.
std::vector<std::size_t> from_coarse_to_fine(std::size_t n) {
    std::vector<std::size_t> order{n - 1, 0};
    for (std::size_t parts = 2; order.size() < n && parts < 4 * n; parts *= 2)
        for (std::size_t k = 1; k < parts; k += 2)
            if (const std::size_t i = (k * (n - 1) + parts / 2) / parts; std::ranges::count(order, i) == 0)
                order.push_back(i);
    return order;
}

/// What the first figure of the body shows, else cracks.
FigureOptions frame_options(const Recorder& recorder) {
    FigureOptions options;
    const auto first =
        std::ranges::find_if(recorder.options().figures, [](const FigureOptions& f) { return shows_body(f.show); });
    if (first != recorder.options().figures.end()) options = *first;
    options.width = picture_width, options.panel = false, options.curves.clear(), options.file = "frames.webp";
    options.paper_width = 0, options.font_size = 0;
    return options;
}

/// The colours are those of the last frame. `watch`: runs since the report began.
std::string frames(const RunRecord& record, const Recorder& recorder, const fs::path& directory,
                   const Stopwatch& watch) {
    std::vector<double> times;
    try {
        times = frame_times(directory);
    } catch (const UserError&) {
        // no frames, or their list is damaged
    }
    if (times.empty()) return "";
    const FigureOptions options = frame_options(recorder);
    const FigureContext& context = recorder.options().context;
    const Histories& histories = recorder.histories();
    std::map<std::size_t, std::pair<std::string, std::string>> pictures;
    std::optional<FigureScale> scale;
    std::size_t size = 0;
    for (const std::size_t k : from_coarse_to_fine(times.size())) {
        const bool enough = pictures.size() >= min_pictures;
        if (pictures.size() >= max_pictures || size > max_bytes || (enough && watch.cpu() > share * record.spent.cpu))
            break;
        try {
            const Frame frame = read_frame(directory, k);
            if (!scale) scale = scale_of(options, frame, histories, context);
            const std::string bytes = webp_of(draw_picture(options, frame, histories, context, *scale).image);
            size += bytes.size();
            pictures[k] = {bytes, words_of(options) + ", t = " + time_text(frame.time)};
        } catch (const UserError&) {
            continue;  // a frame that was deleted or damaged
        }
    }
    std::vector<std::pair<std::string, std::string>> list;
    for (auto& [k, picture] : pictures) list.push_back(std::move(picture));
    return html_slider(list);
}

std::string title_of(const Scenario& scenario) { return scenario.title.empty() ? scenario.name : scenario.title; }

/// The file as it is: what `-s` changed is in the command.
std::string scenario_text(const std::string& toml, const RunRecord& record) {
    return "<details><summary>Scenario</summary><p>Run by: " + html_text(command_line(record.command)) + "</p>\n<pre>" +
           html_text(toml) + "</pre></details>\n";
}

/// `state`: progress and picture.
std::string live_page(const Scenario& scenario, const std::string& toml, const RunRecord& record,
                      const std::string& state) {
    return html_page(
        title_of(scenario), question_of(toml),
        state + html_section("Warnings", html_list(record.warnings, "warn")) + scenario_text(toml, record));
}

}  // namespace

std::string quoted_for_shell(const std::string& word) {
    const auto plain = [](char c) { return is_plain(c) || std::string_view("+=,/:%@").find(c) != std::string::npos; };
    if (!word.empty() && std::ranges::all_of(word, plain)) return word;
    std::string quoted = "'";
    for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return quoted + "'";
}

std::string command_line(const std::vector<std::string>& words) {
    std::vector<std::string> quoted;
    for (const std::string& word : words) quoted.push_back(quoted_for_shell(word));
    return joined(quoted, " ");
}

void write_report(const Scenario& scenario, const RunRecord& record, const Recorder& recorder,
                  const fs::path& directory) {
    const Stopwatch watch;
    const auto caption = [&](const fs::path& file) {
        for (const FigureOptions& figure : recorder.options().figures)
            if (const std::string words = caption_of(figure, file, record.time); !words.empty()) return words;
        return std::string();
    };
    const std::string text = read_whole_file(directory / "scenario.toml"),
                      figures = html_figures(record.figures, caption);
    const std::string body =
        warnings_of(record) + html_section("Frames", frames(record, recorder, directory, watch)) +
        html_section("Figures", figures) + html_section("What was computed", computed(scenario, record)) +
        html_section("Expected results", expectations(record)) + html_section("Results", number_rows(record)) +
        html_section("Is the run valid?", gates(record)) + html_section("How to repeat it", origin(record)) +
        scenario_text(text, record);
    write_whole_file(directory / "report.html", html_page(title_of(scenario), question_of(text), body));
}

std::string starting_page(const Scenario& scenario, const std::string& toml, const RunRecord& record,
                          const std::string& state) {
    return live_page(scenario, toml, record,
                     html_live("run", state, "starts it again", LiveReport::shortest_period, 0));
}

void LiveReport::draw(const Model& model, const State& now, const Recorder& recorder) {
    const double begin = Stopwatch::seconds(CLOCK_THREAD_CPUTIME_ID);
    FigureOptions options = frame_options(recorder);
    options.curves = "energy";
    const FigureContext& context = recorder.options().context;
    const Histories& histories = recorder.histories();
    try {
        const Frame frame = make_frame(model, now, false);
        const FigureScale scale = scale_of(options, frame, histories, context);
        picture_ = html_picture(webp_of(draw_picture(options, frame, histories, context, scale).image),
                                words_of(options) + "; below it the energies over time, t = " + time_text(now.time));
    } catch (const UserError&) {
        // what only the end of a run has
    }
    next_picture_ = clock_.wall() + (Stopwatch::seconds(CLOCK_THREAD_CPUTIME_ID) - begin) / share_of_live;
}

void LiveReport::write(const std::string& state, double part, const Model& model, const State& now,
                       const RunRecord& record, const Recorder& recorder) {
    if (clock_.wall() >= next_picture_) draw(model, now, recorder);
    const std::string text = read_whole_file(directory_ / "scenario.toml"),
                      again = Checkpoints::exist_in(directory_) ? "continues it" : "starts it again";
    try {
        write_whole_file(
            directory_ / "report.html",
            live_page(scenario_, text, record, html_live("run", state, again, shortest_period, part) + picture_));
    } catch (const OutputError&) {
        // a full disk ends the run where its results are written, not here
    }
    next_ = clock_.wall() + shortest_period;
}

}  // namespace knap
