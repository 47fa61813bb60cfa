#include "record/run_files.hpp"

#include "base/error.hpp"
#include "output/history_csv.hpp"
#include "output/vtk_series.hpp"
#include "record/run_record.hpp"

#include <nlohmann/json.hpp>

namespace knap {

FinishedRun read_finished_run(const std::filesystem::path& run) {
    const nlohmann::ordered_json record = read_run_json(run);
    Histories histories;
    for (const HistoryFile& file : history_files) {
        const bool is_needed = file.table == &Histories::energy || file.table == &Histories::cracks;
        if (!file.drawn || (!is_needed && !std::filesystem::exists(run / file.name))) continue;
        histories.*file.table = read_csv(run / file.name);
        if (is_needed && (histories.*file.table).rows.empty())
            throw UserError("damaged-file", "`" + (run / file.name).string() + "` has no line of numbers");
    }
    // what can throw stands before the aggregate: GCC 12 destroys members of a nested one that it has not made yet
    std::vector<double> times;
    if (std::filesystem::exists(run / "run.pvd")) times = frame_times(run);
    const std::string title = record["title"];
    std::vector<FigureContext::Line> collectors;
    for (const nlohmann::ordered_json& line : record.value("collectors", nlohmann::ordered_json::array())) {
        const auto end = [&](const char* key, double beyond) {
            return line.value("x_m", nlohmann::ordered_json()).is_number() ? Vec2(line["x_m"], beyond)
                                                                           : Vec2(line[key][0], line[key][1]);
        };
        collectors.push_back({line["name"], end("from_m", -infinity), end("to_m", infinity)});
    }
    FigureContext context{.title = title.empty() ? record["name"].get<std::string>() : title,
                          .rayleigh_speed = record["rayleigh_speed_m_per_s"],
                          .materials = record["materials"],
                          .celsius = record.value("temperature_unit", "") == "C",
                          .collectors = std::move(collectors)};
    return {.directory = run,
            .histories = std::move(histories),
            .context = std::move(context),
            .frame_times = std::move(times)};
}

}  // namespace knap
