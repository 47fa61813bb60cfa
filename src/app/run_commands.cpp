// knap render and knap info: finished runs.
#include "app/check/findings.hpp"
#include "app/commands.hpp"
#include "app/run/run_directory.hpp"
#include "base/display_unit.hpp"
#include "base/error.hpp"
#include "base/formatted.hpp"
#include "base/text.hpp"
#include "base/whole_file.hpp"
#include "figures/canvas.hpp"
#include "figures/ticks.hpp"
#include "output/vtk_series.hpp"
#include "record/figure_sequence.hpp"
#include "record/outputs.hpp"
#include "record/run_files.hpp"
#include "record/run_record.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace knap {
namespace {

using Json = nlohmann::ordered_json;

/// The frames nearest to the times of a figure. Throws UserError for a time outside of the run.
std::vector<std::size_t> frames_for(const FigureOptions& figure, const FinishedRun& run) {
    const std::vector<double>& times = run.frame_times;
    if (times.empty())
        throw UserError("no-frames",
                        "`" + run.directory.string() + "` has no field frames, so no `" + figure.show + "`",
                        "run with output.fields = true");
    std::vector<std::size_t> frames;
    if (figure.is_animation()) {
        double next = times.front();
        for (std::size_t k = 0; k < times.size(); ++k) {
            if (times[k] < next * (1 - 1e-6) && k + 1 < times.size()) continue;
            frames.push_back(k);
            next = figure.every > 0 ? figure.every * (std::floor(times[k] / figure.every * (1 + 1e-6)) + 1) : times[k];
        }
        return frames;
    }
    for (const double time : figure.at.empty() ? std::vector{times.back()} : figure.at) {
        const double slack = 1e-6 * times.back();
        if (!(time >= times.front() - slack && time <= times.back() + slack))
            throw UserError("no-frames", "`" + run.directory.string() + "` has no frame at " + time_text(time),
                            "it has " + std::to_string(times.size()) + " from " + time_text(times.front()) + " to " +
                                time_text(times.back()));
        const std::size_t k = nearest_frame(times, time);
        if (std::abs(times[k] - time) > slack)
            std::fprintf(stderr, "note: no frame at %s; the nearest is at %s\n", readable(time, "s", 6).c_str(),
                         readable(times[k], "s", 6).c_str());
        if (std::ranges::find(frames, k) == frames.end()) frames.push_back(k);
    }
    return frames;
}

/// Removes the times of a figure of the scenario that an interrupted run did not reach; without any it is drawn at the
/// last one.
void keep_reached(FigureOptions& figure, const FinishedRun& run) {
    if (run.frame_times.empty()) return;
    const double end = run.frame_times.back();
    if (std::erase_if(figure.at, [&](double time) { return time > end * (1 + 1e-6); }) > 0 && shows_body(figure.show))
        std::fprintf(stderr, "note: `%s` is drawn without its times after %s, where the run ends\n",
                     figure.file.c_str(), time_text(end).c_str());
}

std::vector<std::filesystem::path> draw(const FigureOptions& figure, const FinishedRun& run,
                                        const std::filesystem::path& directory) {
    if (!shows_body(figure.show)) return {draw_figure(figure, Frame{}, run.histories, run.context, directory).file};
    const std::vector<std::size_t> frames = frames_for(figure, run);
    try {
        check_picture_size(figure, Vec2(1, 10));  // no picture is higher
    } catch (const UserError&) {
        check_picture_size(figure, figure.box
                                       ? figure.box->extent()
                                       : bounding_box(read_frame(run.directory, frames.back()).position).extent());
    }
    FigureOptions drawn = figure;  // the file names carry the times of the frames, not the requested ones
    drawn.at.clear();
    if (figure.at.size() > 1)
        for (const std::size_t k : frames) drawn.at.push_back(run.frame_times[k]);
    if (drawn.at.size() == 1) drawn.at.push_back(drawn.at.front());
    FrameReader reader(run.directory);
    return draw_sequence(drawn, reader, frames, run.histories, run.context, directory);
}

/// The unit of a number of the summary; records of old versions do not contain it.
std::string unit_in(const Json& record, const std::string& name) {
    const Json units = record.value("summary_units", Json::object());
    return units.value(name, std::string(unit_of("summary", name)));
}

std::string number_text(const Json& value, const std::string& unit) {
    return value_text(value.is_null() ? NAN : value.get<double>(), unit);
}

/// A line per run, every number of the summary a column; an empty field for what never happened.
void print_table(const Json& all) {
    if (all.empty()) return;
    std::vector<std::string> header{"run", "name", "status", "seed", "triangles", "steps", "cpu [s]"};
    for (const auto& [name, value] : all[0]["summary"].items())
        header.push_back(with_unit(name, unit_in(all[0], name)));
    std::printf("%s\n", joined(header, ",").c_str());
    for (const Json& record : all) {
        std::vector<std::string> line;
        for (const char* key : {"directory", "name", "status"}) line.push_back(record[key].get<std::string>());
        for (const char* key : {"seed", "triangles", "steps", "cpu_s"}) line.push_back(record[key].dump());
        for (const auto& [name, value] : all[0]["summary"].items()) {
            const Json number = record["summary"].value(name, Json(nullptr));
            line.push_back(number.is_null() ? std::string() : number.dump());
        }
        std::printf("%s\n", joined(line, ",").c_str());
    }
}

/// `brief`: without its numbers.
void print_text(const Json& record, bool brief) {
    const auto text = [](const Json& of, const char* key) { return of[key].get<std::string>(); };
    std::printf("%s: %s, %s, version %s, seed %s\n", text(record, "directory").c_str(), text(record, "name").c_str(),
                text(record, "status").c_str(), text(record, "version").c_str(), record["seed"].dump().c_str());
    std::printf("  %d triangles, %lld steps, %s of processor time\n", record["triangles"].get<int>(),
                record["steps"].get<long long>(), readable(record["cpu_s"].get<double>(), "s").c_str());
    if (brief) return;
    for (const auto& [name, value] : record["summary"].items())
        std::printf("  %-24s %s\n", name.c_str(), number_text(value, unit_in(record, name)).c_str());
    for (const Json& gate : record["gates"])
        if (!gate["pass"])
            std::printf("  gate %s VIOLATED: %s\n", text(gate, "name").c_str(),
                        number_text(gate["value"], gate.value("unit", "")).c_str());
    for (const Json& result : record["expect"])
        std::printf("  expect %s %s: %s, %s\n", text(result, "name").c_str(), text(result, "limit").c_str(),
                    number_text(result["value"], result.value("unit", "")).c_str(), result["pass"] ? "ok" : "FAILED");
}

/// The measured points that a scenario has in a figure with these axes.
void take_measured(FigureOptions& figure, const std::vector<FigureOptions>& of_run) {
    const auto same = std::ranges::find_if(of_run, [&](const FigureOptions& one) {
        return !one.measured.empty() && one.show == figure.show && one.over == figure.over;
    });
    if (same != of_run.end()) figure.measured = same->measured, figure.measured_by = same->measured_by;
}

}  // namespace

ExitCode render_run(const std::filesystem::path& run, const FigureOptions& figure,
                    const std::filesystem::path& output) {
    const FinishedRun finished = read_finished_run(run);
    std::vector<FigureOptions> figures{figure};
    if (std::error_code none; figure.show.empty() || std::filesystem::exists(run / "resolved.toml", none)) {
        const std::vector<FigureOptions> of_run = read_scenario(run / "resolved.toml").scenario.figures;
        if (figure.show.empty()) figures = of_run;
        else take_measured(figures[0], of_run);
    }
    for (const FigureOptions& one : figures) check_figure(one, finished.histories);
    const std::filesystem::path directory = output.empty() ? run / "rendered" : output;
    const bool made = std::filesystem::create_directories(directory);
    if (figure.show.empty())
        for (FigureOptions& one : figures) keep_reached(one, finished);
    try {
        for (const FigureOptions& one : figures)
            for (const auto& path : draw(one, finished, directory)) std::printf("figure:  %s\n", path.string().c_str());
    } catch (...) {
        std::error_code not_empty;
        if (made) std::filesystem::remove(directory, not_empty);  // where nothing was drawn
        throw;
    }
    return exit_done;
}

ExitCode show_runs(const std::vector<std::filesystem::path>& runs, RunFormat format) {
    Json all = Json::array();
    std::vector<std::filesystem::path> found;
    std::string tables;  // of studies and sweeps
    for (const auto& run : runs) {
        const auto inside = earlier_record(run).is_of_a_run ? std::vector<std::filesystem::path>() : runs_in(run);
        if (inside.empty()) found.push_back(run);
        found.insert(found.end(), inside.begin(), inside.end());
        for (const char* table : {"study.md", "sweep.md"})
            if (std::error_code none; !inside.empty() && std::filesystem::exists(run / table, none))
                tables += read_given_file(run / table, "no-run") + "\n";
    }
    for (const auto& run : found) {
        all.push_back(read_run_json(run));
        all.back()["directory"] = run.string();
        if (const Json& status = all.back()["status"];
            (status == "running" || status == "starting") && !has_process(run))
            all.back()["status"] = "killed";
    }
    if (format == RunFormat::csv) print_table(all);
    else if (format == RunFormat::json)
        std::printf("%s\n", (found.size() == 1 && found == runs ? all[0] : all)
                                .dump(2, ' ', false, Json::error_handler_t::replace)
                                .c_str());
    if (format != RunFormat::text) return exit_done;
    std::printf("%s", tables.c_str());
    for (const Json& record : all) print_text(record, found != runs);
    return exit_done;
}

}  // namespace knap
