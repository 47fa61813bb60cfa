#include "app/sweep.hpp"

#include "app/finished_run.hpp"
#include "app/version.hpp"
#include "base/error.hpp"
#include "base/whole_file.hpp"
#include "observe/contact_sheet.hpp"
#include "observe/vtk_series.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

namespace knap {
namespace {

namespace fs = std::filesystem;

/// A column for every seed, or about as wide as high.
std::size_t n_columns(const SweepPlan& plan) {
    const std::size_t n = plan.runs.size();
    if (plan.n_seeds > 1 && plan.n_seeds <= 8 && !plan.keys.empty()) return plan.n_seeds;
    if (plan.n_seeds == 1 && !plan.keys.empty() && plan.keys.back().values.size() <= 6) return plan.keys.back().values.size();
    return std::clamp<std::size_t>(static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(n)))), 1, 12);
}

/// What the panel of a run is drawn from; none where it has nothing to show, as one that failed before its end.
std::optional<FinishedRun> panel_source(const fs::path& directory, const FigureOptions& sheet) {
    try {
        FinishedRun run = read_finished_run(directory);
        check_figure(sheet, run.histories);
        if (shows_body(sheet.show) && run.frame_times.empty()) return {};
        return run;
    } catch (const UserError&) {
        return {};
    }
}

/// Draws the panels of all runs again, with the ranges of all, and the sheet of them.
fs::path draw_sheet(const SweepPlan& plan, const fs::path& directory) {
    FigureOptions sheet = plan.sheet;
    sheet.at.clear();
    const bool body = shows_body(sheet.show);
    const auto frame_of = [&](const FinishedRun& run) { return body ? read_frame(run.directory, run.frame_times.size() - 1) : Frame{}; };
    const auto directory_of = [&](const SweepRun& run) { return directory / "runs" / run.name; };
    FigureScale common;
    for (const SweepRun& run : plan.runs)
        if (const auto source = panel_source(directory_of(run), sheet)) common = joined(common, scale_of(sheet, frame_of(*source), source->histories, source->context));
    Legend legend;
    std::string aside;
    std::vector<Tile> tiles;
    for (const SweepRun& run : plan.runs) {
        tiles.push_back({directory_of(run) / "figures" / sheet.file, plan.caption(run)});
        const auto source = panel_source(directory_of(run), sheet);
        if (!source) continue;
        const Frame frame = frame_of(*source);
        fs::create_directories(tiles.back().picture.parent_path());
        draw_figure(sheet, frame, source->histories, source->context, tiles.back().picture.parent_path(), &common);
        aside = magnification(sheet, frame.n_obstacles() > 0);
        join(legend, panel_legend(sheet, frame, source->histories, source->context, common));
    }
    const std::size_t columns = std::min(n_columns(plan), tiles.size());
    const int pixels = std::clamp<int>(static_cast<int>(420 * columns), 1200, 6000);
    return draw_contact_sheet(tiles, columns, plan.title.empty() ? plan.name : plan.title, directory / "sweep.png", pixels, legend, aside).file;
}

/// A scenario's file seen from a directory; a built-in name stays one.
std::string seen_from(const fs::path& directory, const std::string& scenario) {
    std::error_code error;
    return fs::exists(scenario, error) ? fs::proximate(scenario, directory).string() : scenario;
}

/// The command that runs this program again, from anywhere.
std::string program(const std::string& typed) { return typed.find('/') == std::string::npos ? typed : fs::absolute(typed).lexically_normal().string(); }

ExitCode emit(const SweepPlan& plan, const std::vector<const BatchRun*>& to_do, const std::string& scenario, const std::vector<std::string>& overrides,
              const SweepCommand& command, const fs::path& directory) {
    const std::string there = seen_from(directory, scenario), knap = program(command.command.empty() ? "knap" : command.command.front());
    std::vector<std::vector<std::string>> jobs;
    for (const BatchRun* run : to_do) {
        jobs.push_back({knap});
        append_arguments(there, *run, "runs", command.batch.force, jobs.back());
    }
    std::vector<std::string> collect{knap, "sweep", there, "-q", "-o", "."};
    for (const std::string& set : overrides) collect.insert(collect.end(), {"-s", set});
    const std::string how = emit_jobs(command.emit, jobs, collect, plan.name, directory);
    std::printf("%zu of %zu runs are to be done; ", to_do.size(), plan.runs.size());
    if (!jobs.empty()) std::printf("in %s:  %s\nthen ", directory.string().c_str(), how.c_str());
    std::printf("the same command without --emit makes table and contact sheet\n");
    return exit_done;
}

}  // namespace

ExitCode sweep_scenario(const std::string& scenario, const std::vector<std::string>& overrides, const SweepCommand& command) {
    const SweepPlan plan = plan_sweep(scenario, overrides);
    const fs::path directory = command.batch.output.empty() ? fs::path("sweeps") / plan.name : command.batch.output;
    std::string record = "# knap sweep " + quoted_for_shell(scenario);
    for (const std::string& set : overrides) record += " -s " + quoted_for_shell(set);
    record += "\n";
    const DirectoryLock lock = take_batch_directory(directory, "sweep");
    const auto to_do = runs_to_do(batch_of(plan.runs), directory / "runs", command.batch.force);
    begin_batch(directory, "sweep", record);
    if (!command.emit.empty()) return emit(plan, to_do, scenario, overrides, command, directory);
    if (!do_runs(scenario, to_do, directory / "runs", command.batch)) return exit_interrupted;
    std::vector<RunResult> results;
    for (const SweepRun& run : plan.runs) results.push_back(read_result(directory / "runs" / run.name, plan.quantities));
    const std::string text = sweep_text(plan, results);
    write_whole_file(directory / "sweep.txt", text);
    write_whole_file(directory / "sweep.csv", sweep_csv(plan, results));
    if (plan.has_seeds) write_whole_file(directory / "statistics.csv", sweep_statistics_csv(plan, results));
    std::fputs(text.c_str(), stdout);
    std::printf("\nsweep:   %s\nfigure:  %s\n", directory.string().c_str(), draw_sheet(plan, directory).string().c_str());
    return exit_code_of(results);
}

}  // namespace knap
