#include "app/run/finished_run.hpp"

#include "app/run/read_run.hpp"
#include "base/error.hpp"
#include "output/history_csv.hpp"
#include "output/vtk_series.hpp"

#include <nlohmann/json.hpp>

namespace knap {

FinishedRun read_finished_run(const std::filesystem::path& run) {
    const nlohmann::ordered_json record = read_run_json(run);
    const std::string title = record.value("title", "");
    const auto read_if_there = [&](const char* name) { return std::filesystem::exists(run / name) ? read_csv(run / name) : History{}; };
    const auto read_lines = [&](const char* name) {
        History history = read_csv(run / name);
        if (history.rows.empty()) throw UserError("damaged-file", "`" + (run / name).string() + "` has no line of numbers");
        return history;
    };
    return {.directory = run,
            .histories = {.energy = read_lines("energy.csv"),
                          .cracks = read_lines("cracks.csv"),
                          .reactions = read_if_there("reactions.csv"),
                          .probes = read_if_there("probes.csv"),
                          .breaks = read_if_there("breaks.csv"),
                          .stress_strain = read_if_there("stress_strain.csv"),
                          .fragments = read_if_there("fragments.csv")},
            .context = {.title = title.empty() ? record.value("name", "") : title,
                        .rayleigh_speed = record.value("rayleigh_speed_m_per_s", 0.0),
                        .materials = record.value("materials", std::vector<std::string>{})},
            .frame_times = std::filesystem::exists(run / "run.pvd") ? frame_times(run) : std::vector<double>{}};
}

}  // namespace knap
