#include "app/run.hpp"

#include "app/run_directory.hpp"
#include "app/run_json.hpp"
#include "app/setup.hpp"
#include "app/threads.hpp"
#include "base/stopwatch.hpp"
#include "observe/fragments.hpp"
#include "observe/progress.hpp"
#include "scenario/write_scenario.hpp"
#include "stepper/moreau_jean.hpp"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <sstream>

namespace knap {
namespace {

volatile std::sig_atomic_t interrupted = 0;

/// Ctrl-C and SIGTERM end the run after the step under way; a second one kills as usual.
class InterruptGuard {
public:
    InterruptGuard() {
        interrupted = 0;
        for (const int which : {SIGINT, SIGTERM}) std::signal(which, [](int signal) { interrupted = 1, std::signal(signal, SIG_DFL); });
    }
    ~InterruptGuard() {
        for (const int which : {SIGINT, SIGTERM}) std::signal(which, SIG_DFL);
    }
};

RecorderOptions recorder_options(const Scenario& scenario, const Model& model, const std::filesystem::path& directory) {
    const double end = scenario.time.end, edge = mean_edge(model.mesh);
    double process_zone = 0;
    for (const Resolution& r : judge_resolution(scenario, edge)) process_zone = std::max(process_zone, r.process_zone);
    return {.directory = directory,
            .end = end,
            .frame_every = !scenario.output.fields ? 0 : scenario.output.every > 0 ? scenario.output.every : end / 40,
            .history_every = scenario.output.history_every > 0 ? scenario.output.history_every : end / 400,
            .rayleigh_speed = rayleigh_speed(scenario),
            .cracks = crack_options(edge, process_zone),
            .figures = scenario.figures,
            .probes = scenario.probes,
            .title = scenario.title.empty() ? scenario.name : scenario.title};
}

double largest_critical_opening(const Scenario& scenario) {
    double largest = 0;
    for (const NamedLaw& law : scenario.laws)
        if (law.law.breakable()) largest = std::max(largest, law.law.delta_c());
    return largest;
}

template <class... Values>
void add_line(std::string& text, const char* format, Values... values) {
    char line[512];
    std::snprintf(line, sizeof line, format, values...);
    text += line;
}

/// What a run found, for people.
std::string end_of_run(const RunRecord& record, const std::filesystem::path& directory) {
    std::string text;
    add_line(text, "%s: %s at t = %.6g s after %lld steps of %.4g s; %d triangles, %d interfaces; %.1f s (%.1f s of processor time)\n",
             record.name.c_str(), record.status.c_str(), record.time, static_cast<long long>(record.steps), record.step, record.triangles,
             record.interfaces, record.wall, record.cpu);
    if (!record.reason.empty()) text += "  reason: " + record.reason + "\n";
    for (const auto& [name, value] : record.summary.values) add_line(text, "  %-24s %.6g\n", name.c_str(), value);
    for (const Gate& gate : record.gates)
        add_line(text, "  gate   %-20s %-12.4g limit %-12.4g %s\n", gate.name.c_str(), gate.value, gate.limit, gate.pass ? "ok" : "VIOLATED");
    for (const ExpectResult& result : record.expect)
        add_line(text, "  expect %-20s %-12.6g %-24s %s\n", result.name.c_str(), result.value, result.limit.c_str(), result.pass ? "ok" : "FAILED");
    text += "run:     " + directory.string() + "\n";
    for (const auto& figure : record.figures) text += "figure:  " + figure.string() + "\n";
    return text;
}

/// The resolved scenario as it stands in a run directory, where a mesh that was read is `mesh.msh`.
std::string resolved_beside_mesh(const ReadResult& read) {
    if (!read.scenario.given) return resolved_toml(read);
    ReadResult there = read;
    there.values.replace("mesh.file", "mesh.file", Node::of_text("mesh.msh"));
    return resolved_toml(there);
}

ExitCode exit_code(const RunRecord& record) {
    if (record.status == "interrupted") return exit_interrupted;
    if (record.status == "failed") return exit_failed;
    if (!std::all_of(record.gates.begin(), record.gates.end(), [](const Gate& g) { return g.pass; })) return exit_failed;
    return std::all_of(record.expect.begin(), record.expect.end(), [](const ExpectResult& e) { return e.pass; }) ? exit_done : exit_expectation;
}

}  // namespace

Model model_of(const ReadResult& read) {
    try {
        return build_model(read.scenario);
    } catch (const ShapeError& error) {
        throw UserError({locate(read, error)});
    }
}

StepPlan plan_of(const ReadResult& read, double stable_step, double until) {
    try {
        return plan_steps(read.scenario, stable_step, until);
    } catch (const UserError& error) {
        Diagnostic placed = locate(read, "time.step");
        placed.code = error.diagnostics.front().code;
        placed.message = error.diagnostics.front().message;
        placed.note = error.diagnostics.front().note;
        throw UserError({placed});
    }
}

std::vector<Diagnostic> resolution_warnings(const ReadResult& read, double mean_edge) {
    std::vector<Diagnostic> warnings;
    for (const Resolution& r : judge_resolution(read.scenario, finest_edge(read.scenario, mean_edge))) {
        if (r.n_edges >= 5) continue;
        Diagnostic warning = locate(read, "mesh.size");
        warning.severity = Diagnostic::Severity::warning;
        warning.code = "resolution";
        char text[240];
        std::snprintf(text, sizeof text, "the process zone of `%s` (%.3g m for a crack at rest) is covered by %.1f edges; crack speed and branching will depend on the mesh",
                      r.material.c_str(), r.process_zone, r.n_edges);
        warning.message = text;
        std::snprintf(text, sizeof text, "help: use a size of at most %.2g m where cracks run, or accept it as a coarse-grain study", r.process_zone / 5);
        warning.note = text;
        warnings.push_back(warning);
    }
    return warnings;
}

ExitCode run_scenario(const ReadResult& read, const RunOptions& options) {
    const Scenario& scenario = read.scenario;
    const std::filesystem::path directory = options.output.empty() ? std::filesystem::path("runs") / scenario.name : options.output;
    const Stopwatch whole;
    RunRecord record{.status = "running", .name = scenario.name, .title = scenario.title, .command = options.command, .seed = scenario.seed};
    record.threads = use_threads(options.threads);

    // mesh and model; nothing is written before they are known to be possible
    const Model model = model_of(read);
    MoreauJean stepper(model);
    const StepPlan plan = plan_of(read, stepper.stable_step(), options.until);
    record.cpu_model = whole.cpu();
    record.triangles = model.mesh.n_triangles();
    record.interfaces = static_cast<Index>(model.interfaces.size());
    record.step = plan.step;
    record.mean_edge = mean_edge(model.mesh);
    record.rayleigh_speed = rayleigh_speed(scenario);

    make_run_directory(directory, options.force);
    write_whole_file(directory / "scenario.toml", read.source.text());
    write_whole_file(directory / "resolved.toml", resolved_beside_mesh(read));
    if (scenario.given) write_whole_file(directory / "mesh.msh", scenario.given->bytes);
    std::ostringstream log;
    for (const Diagnostic& warning : resolution_warnings(read, record.mean_edge)) log << format(warning), record.warnings.push_back(warning.message);
    for (const Diagnostic& warning : read.warnings) log << format(warning), record.warnings.push_back(warning.message);
    if (!options.quiet) std::fputs(log.str().c_str(), stderr);
    write_whole_file(directory / "log.txt", log.str());
    write_whole_file(directory / "run.json", run_json(record));

    // the run
    State now = initial_state(model), next = now;
    Recorder recorder(model, now, recorder_options(scenario, model, directory));
    Progress progress(options.quiet ? nullptr : stderr, plan.step * static_cast<double>(plan.n_steps), record.triangles);
    const InterruptGuard guard;
    const Stopwatch stepping;
    record.status = "done";
    try {
        while (now.n_steps < plan.n_steps) {
            if (interrupted) {
                record.status = "interrupted";
                break;
            }
            const StepReport report = stepper.step(now, plan.step, next);
            std::swap(now, next);
            recorder.after_step(now, report);
            progress.after_step(now, recorder);
        }
    } catch (const SimulationError& error) {
        record.status = "failed";
        record.reason = error.what();
    }
    record.cpu_steps = stepping.cpu() - recorder.output_seconds();
    progress.finish(now, recorder);
    recorder.finish(now);

    // what came of it
    std::ofstream fragments(directory / "fragments.csv");
    write_fragments(fragments, find_fragments(model, now));
    record.steps = now.n_steps;
    record.time = now.time;
    record.counts = recorder.ledger().worst();
    record.summary = summarise(model, now, recorder, record.rayleigh_speed);
    record.gates = recorder.ledger().gates(largest_critical_opening(scenario), diagonal(model.mesh.vertices));
    if (record.status == "done" && now.time >= scenario.time.end * (1 - 1e-9))
        record.expect = judge_expectations(scenario.expect, record.summary, record.rayleigh_speed);
    record.figures = recorder.figures();
    record.cpu_output = recorder.output_seconds();
    record.wall = whole.wall();
    record.cpu = whole.cpu();
    write_whole_file(directory / "run.json", run_json(record));
    const std::string end = end_of_run(record, directory);
    log << end;
    write_whole_file(directory / "log.txt", log.str());
    std::fputs(end.c_str(), stdout);
    return exit_code(record);
}

}  // namespace knap
