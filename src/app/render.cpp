// knap render and knap info: finished runs.
#include "app/commands.hpp"
#include "app/read_run.hpp"
#include "app/run_directory.hpp"
#include "base/error.hpp"
#include "observe/history_csv.hpp"
#include "observe/outputs.hpp"
#include "observe/ticks.hpp"
#include "observe/vtk_series.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdio>
#include <fstream>

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

}  // namespace

ExitCode render_run(const std::filesystem::path& run, const FigureOptions& figure, const std::filesystem::path& output) {
    const Json record = read_run_json(run);
    std::vector<FigureOptions> figures{figure};
    if (figure.show.empty()) figures = read_scenario(run / "resolved.toml").scenario.figures;
    const std::string title = record.value("title", "");
    const FigureContext context{.title = title.empty() ? record.value("name", "") : title,
                                .rayleigh_speed = record.value("rayleigh_speed_m_per_s", 0.0),
                                .materials = record.value("materials", std::vector<std::string>{})};
    const auto read_if_there = [&](const char* name) { return std::filesystem::exists(run / name) ? read_csv(run / name) : History{}; };
    const auto read_lines = [&](const char* name) {
        History history = read_csv(run / name);
        if (history.rows.empty()) throw UserError("damaged-file", "`" + (run / name).string() + "` has no line of numbers");
        return history;
    };
    const Histories histories{.energy = read_lines("energy.csv"),
                              .cracks = read_lines("cracks.csv"),
                              .reactions = read_if_there("reactions.csv"),
                              .probes = read_if_there("probes.csv"),
                              .breaks = read_if_there("breaks.csv"),
                              .stress_strain = read_if_there("stress_strain.csv"),
                              .fragments = read_if_there("fragments.csv")};
    const std::filesystem::path directory = output.empty() ? run / "rendered" : output;
    std::filesystem::create_directories(directory);
    for (const FigureOptions& wanted : figures) {
        std::vector<double> at = wanted.at;
        if (!shows_body(wanted.show)) {
            for (const auto& path : draw_figure(wanted, Frame{}, histories, context, directory)) std::printf("figure:  %s\n", path.string().c_str());
            continue;
        }
        const std::vector<double> times = frame_times(run);
        if (times.empty()) throw UserError("no-frames", "`" + run.string() + "` has no field frames", "run with output.fields = true");
        if (at.empty()) at = {times.back()};
        for (const double time : at) {
            const Frame frame = read_frame(run, nearest_frame(times, time));
            if (std::abs(frame.time - time) > 1e-6 * times.back())
                std::fprintf(stderr, "note: no frame at %.6g s; the nearest is at %.6g s\n", time, frame.time);
            FigureOptions one = wanted;  // named by the time that is drawn, not by the one that was asked for
            if (at.size() > 1) one.at.assign(2, frame.time);
            for (const auto& path : draw_figure(one, frame, histories, context, directory)) std::printf("figure:  %s\n", path.string().c_str());
        }
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
