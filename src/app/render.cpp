// knap render and knap info: finished runs.
#include "app/commands.hpp"
#include "app/run/finished_run.hpp"
#include "app/run/read_run.hpp"
#include "app/run/run_directory.hpp"
#include "base/error.hpp"
#include "figures/canvas.hpp"
#include "figures/ticks.hpp"
#include "output/vtk_series.hpp"
#include "record/outputs.hpp"
#include "record/sequence.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace knap {
namespace {

using Json = nlohmann::ordered_json;

/// Of a number of the summary; of an old run, which does not say, as it is now.
std::string unit_in(const Json& record, const std::string& name) {
    if (record.contains("summary_units") && record["summary_units"].contains(name)) return record["summary_units"].value(name, "");
    return std::string(unit_of("summary", name));
}

/// The value of a gate or an expectation, with its unit.
std::string with_value(const Json& judged) {
    return value_text(judged["value"].is_null() ? NAN : judged["value"].get<double>(), judged.value("unit", ""));
}

/// The frames nearest to the times that a figure asks for. Throws UserError for a time that the run has not reached.
FrameList frames_for(const FigureOptions& figure, const FinishedRun& run) {
    const std::vector<double>& times = run.frame_times;
    if (times.empty()) throw UserError("no-frames", "`" + run.directory.string() + "` has no field frames, so no `" + figure.show + "`", "run with output.fields = true");
    FrameList list{.run = run.directory};
    for (const double time : figure.at.empty() ? std::vector{times.back()} : figure.at) {
        const double slack = 1e-6 * times.back();
        if (!(time >= times.front() - slack && time <= times.back() + slack))
            throw UserError("no-frames", "`" + run.directory.string() + "` has no frame at " + time_text(time),
                            "it has " + std::to_string(times.size()) + " from " + time_text(times.front()) + " to " + time_text(times.back()));
        const std::size_t k = nearest_frame(times, time);
        if (std::abs(times[k] - time) > slack) std::fprintf(stderr, "note: no frame at %.6g s; the nearest is at %.6g s\n", time, times[k]);
        if (std::find(list.frames.begin(), list.frames.end(), k) == list.frames.end()) list.frames.push_back(k);
    }
    return list;
}

/// A figure of the scenario, as the run drew it: without times that it has not reached; with none left, at the last one.
void keep_reached(FigureOptions& figure, const FinishedRun& run) {
    if (run.frame_times.empty()) return;
    const auto erased = std::erase_if(figure.at, [&](double time) { return time > run.frame_times.back() * (1 + 1e-6); });
    if (erased > 0 && shows_body(figure.show))
        std::fprintf(stderr, "note: `%s` without times after %s, where the run ends\n", figure.file.c_str(), time_text(run.frame_times.back()).c_str());
}

std::vector<std::filesystem::path> draw(const FigureOptions& figure, const FinishedRun& run, const std::filesystem::path& directory) {
    check_figure(figure, run.histories);
    if (!shows_body(figure.show)) return {draw_figure(figure, Frame{}, run.histories, run.context, directory).file};
    const FrameList list = frames_for(figure, run);
    FigureOptions drawn = figure;  // named by the times that are drawn, not by those that were asked for
    drawn.at.clear();
    if (figure.at.size() > 1)
        for (const std::size_t k : list.frames) drawn.at.push_back(run.frame_times[k]);
    if (figure.at.size() > 1 && drawn.at.size() == 1) drawn.at.push_back(drawn.at.front());
    return draw_frames(drawn, list, run.histories, run.context, directory, scale_of(drawn, list, run.histories, run.context));
}

}  // namespace

ExitCode render_run(const std::filesystem::path& run, const FigureOptions& figure, const std::filesystem::path& output) {
    const FinishedRun finished = read_finished_run(run);
    std::vector<FigureOptions> figures{figure};
    if (figure.show.empty()) figures = read_scenario(run / "resolved.toml").scenario.figures;
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
        if (made) std::filesystem::remove(directory, not_empty);  // nothing was drawn
        throw;
    }
    return exit_done;
}

namespace {

void print_table(const Json& all) {
    // one line a run, every number of the summary a column; empty for what never happened
    if (all.empty()) return;
    std::string header = "run,name,status,seed,triangles,steps,cpu [s]";
    for (const auto& item : all[0]["summary"].items()) header += "," + with_unit(item.key(), unit_in(all[0], item.key()));
    std::printf("%s\n", header.c_str());
    for (const Json& record : all) {
        std::string line = record["directory"].get<std::string>() + "," + record.value("name", "") + "," + record.value("status", "");
        for (const char* key : {"seed", "triangles", "steps", "cpu_s"}) line += "," + record[key].dump();
        for (const auto& item : all[0]["summary"].items()) {
            const Json value = record["summary"].value(item.key(), Json(nullptr));
            line += "," + (value.is_null() ? std::string() : value.dump());
        }
        std::printf("%s\n", line.c_str());
    }
}

}  // namespace

ExitCode show_runs(const std::vector<std::filesystem::path>& runs, RunFormat format) {
    Json all = Json::array();
    for (const auto& run : runs) {
        Json record = read_run_json(run);
        record["directory"] = run.string();
        all.push_back(record);
    }
    if (format == RunFormat::csv) {
        print_table(all);
        return exit_done;
    }
    if (format == RunFormat::json) {
        std::printf("%s\n", (runs.size() == 1 ? all[0] : all).dump(2, ' ', false, Json::error_handler_t::replace).c_str());
        return exit_done;
    }
    for (const Json& record : all) {
        std::printf("%s: %s, %s, version %s, seed %lld\n", record["directory"].get<std::string>().c_str(), record.value("name", "").c_str(),
                    record.value("status", "").c_str(), record.value("version", "").c_str(), record.value("seed", 0LL));
        std::printf("  %d triangles, %lld steps, %.1f s of processor time\n", record.value("triangles", 0),
                    static_cast<long long>(record.value("steps", 0LL)), record.value("cpu_s", 0.0));
        for (const auto& [name, value] : record["summary"].items())
            std::printf("  %-24s %s\n", name.c_str(), value_text(value.is_null() ? NAN : value.get<double>(), unit_in(record, name)).c_str());
        for (const Json& gate : record["gates"])
            if (!gate.value("pass", false)) std::printf("  gate %s VIOLATED: %s\n", gate.value("name", "").c_str(), with_value(gate).c_str());
        for (const Json& result : record["expect"])
            std::printf("  expect %s %s: %s, %s\n", result.value("name", "").c_str(), result.value("limit", "").c_str(), with_value(result).c_str(),
                        result.value("pass", false) ? "ok" : "FAILED");
    }
    return exit_done;
}

}  // namespace knap
