#include "app/run/run.hpp"

#include "app/run/checkpoint.hpp"
#include "app/run/continuation.hpp"
#include "app/run/interrupt.hpp"
#include "app/run/model_findings.hpp"
#include "app/run/run_directory.hpp"
#include "app/run/run_json.hpp"
#include "app/run/run_log.hpp"
#include "app/run/run_text.hpp"
#include "app/run/setup.hpp"
#include "app/run/step_loop.hpp"
#include "app/run/step_plan.hpp"
#include "app/run/threads.hpp"
#include "base/error.hpp"
#include "base/stopwatch.hpp"
#include "base/whole_file.hpp"
#include "output/frame.hpp"
#include "record/progress.hpp"
#include "scenario/units.hpp"
#include "scenario/write_scenario.hpp"
#include "stepper/moreau_jean.hpp"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <sstream>
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace knap {
namespace {

double largest_critical_opening(const Scenario& scenario) {
    double largest = 0;
    for (const NamedLaw& law : scenario.laws)
        if (law.law.breakable()) largest = std::max(largest, law.law.delta_c());
    return largest;
}

/// [J] What the weakest interface point takes to break; 0 where none can.
double weakest_point(const Model& model) {
    double least = std::numeric_limits<double>::infinity();
    for (const FanPoint& point : model.fan_points)
        if (const CohesiveLaw& law = model.laws[point.law]; law.breakable() && !point.cracked && law.G_c > 0) least = std::min(least, law.G_c * point.area);
    return std::isinf(least) ? 0 : least;
}

RecorderOptions recorder_options(const Scenario& scenario, const Model& model, const std::filesystem::path& directory, bool goes_on) {
    const double end = scenario.time.end, edge = mean_edge(model.mesh);
    double process_zone = 0, fastest = 0;
    for (const Resolution& r : judge_resolution(scenario, edge)) process_zone = std::max(process_zone, r.process_zone);
    for (const NamedMaterial& material : scenario.materials) fastest = std::max(fastest, material.elastic.dilatational_speed(scenario.plane));
    return {.directory = directory,
            .end = end,
            .frame_every = scenario.output.fields ? scenario.output.every : 0,
            .history_every = scenario.output.history_every,
            .rayleigh_speed = rayleigh_speed(scenario),
            .materials = material_names(scenario),
            .mass = scenario.time.scheme.mass,
            .cracks = crack_options(diagonal(model.mesh.vertices), process_zone, fastest, model.mesh.order),
            .critical_opening = largest_critical_opening(scenario),
            .weakest_point = weakest_point(model),
            .allowed_limits = scenario.allowed_limits,
            .figures = scenario.figures,
            .probes = scenario.probes,
            .breaks = scenario.output.breaks,
            .specimen = scenario.specimen,
            .title = scenario.title.empty() ? scenario.name : scenario.title,
            .goes_on = goes_on};
}

ExitCode exit_code(const RunRecord& record) {
    if (record.status == "interrupted") return exit_interrupted;
    if (record.status == "failed") return exit_failed;
    if (!std::all_of(record.gates.begin(), record.gates.end(), [](const Gate& g) { return g.pass(); })) return exit_failed;
    return std::all_of(record.expect.begin(), record.expect.end(), [](const ExpectResult& e) { return e.pass; }) ? exit_done : exit_expectation;
}

/// What the directory of a run begins with.
FirstFiles first_files(const ReadResult& read) {
    FirstFiles files{{"scenario.toml", read.source.text()}, {"resolved.toml", resolved_for_run(read)}};
    for (const NamedFile& file : read.scenario.files) files.emplace_back(file.name, file.bytes);
    return files;
}

/// What only the mesh can say of [specimen].
void check_specimen(const ReadResult& read, const Model& model) {
    if (!read.scenario.specimen) return;
    try {
        Specimen(model, Reactions(model), *read.scenario.specimen);
    } catch (const UserError& error) {
        throw UserError({read.at("specimen", error.diagnostics.front())});
    }
}

/// The state at t = 0. A body that its interfaces cannot hold there has failed before it began.
State start_of(const Model& model, const Scenario& scenario, MoreauJean& stepper, RunRecord& record) {
    State start = initial_state(model);
    if (!scenario.time.start_in_equilibrium) return start;
    try {
        State loaded = start;
        stepper.start_in_equilibrium(loaded);
        return loaded;
    } catch (const SimulationError& error) {
        record.status = "failed";
        record.reason = error.what();
        return start;
    }
}

/// What came of a run.
void conclude(const Scenario& scenario, const Model& model, const State& now, const Recorder& recorder, const StepControl& control, RunRecord& record) {
    record.steps = now.n_steps;
    record.time = now.time;
    record.counts = recorder.ledger().worst();
    record.counts.linear_solves += control.rejected_steps().linear_solves;
    record.counts.factorisations += control.rejected_steps().factorisations;
    record.smallest_step = control.smallest_taken();
    record.largest_step = control.largest_taken();
    record.n_cutbacks = control.n_cutbacks();
    record.summary = summarise(model, now, recorder, record.rayleigh_speed);
    record.gates = recorder.gates().gates();
    for (const auto& [gate, text] : recorder.gates().said()) record.warnings.push_back(text.substr(0, text.size() - 1));
    if (record.status == "done" && StepControl::has_reached(now, scenario.time.end))
        record.expect = judge_expectations(scenario.expect, record.summary, record.rayleigh_speed);
    record.figures = recorder.figures();
    record.cpu_output = recorder.output_seconds();
    record.cpu_frames = recorder.frame_seconds();
    record.cpu_figures = recorder.figure_seconds();
    record.frame_wait = recorder.frame_wait();
}

}  // namespace

std::string resolved_for_run(const ReadResult& read) {
    if (read.scenario.files.empty()) return resolved_toml(read);
    ReadResult there = read;
    for (const NamedFile& file : read.scenario.files) there.values.set(file.key, Node::of_text(file.name));
    return resolved_toml(there);
}

Model model_of(const ReadResult& read) {
    try {
        Model model = build_model(read.scenario);
        refuse_contradictions(read, model);
        return model;
    } catch (const ShapeError& error) {
        throw UserError({read.at_shape(error)});
    } catch (const EmptySelection& error) {
        const char* list = error.list == EmptySelection::loads ? "load" : error.list == EmptySelection::supports ? "support" : "initial";
        throw UserError({read.at(item(list, error.number) + (error.list == EmptySelection::initial_velocities ? ".box" : ".on"),
                                 error.diagnostics.front())});
    }
}

std::vector<Diagnostic> resolution_warnings(const ReadResult& read, double mean_edge) {
    std::vector<Diagnostic> warnings;
    for (const Resolution& r : judge_resolution(read.scenario, mean_edge)) {
        if (r.n_edges >= 5) continue;
        Diagnostic warning = read.at(read.scenario.given ? "mesh.file" : "mesh.size", {});
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

namespace {

/// [s]
void check_until(double until) {
    if (!(until > 0)) throw UserError("bad-value", "`--until " + shortest(until) + " s` ends the run before it begins", "a time after t = 0, as in 20us");
}

/// [s] A run that goes on does not come back to what lies behind it; where that was the end of its last step, it ends again.
void check_until_is_ahead(double until, const State& now, const std::filesystem::path& directory) {
    if (now.time - now.last_step < until) return;
    throw UserError("until-passed", "the run in `" + directory.string() + "` is at t = " + shortest(now.time) + " s already, beyond --until " + shortest(until) + " s",
                    "give a later --until, or none, to go on; or start it again with --force");
}

/// What is known of a run before its first step.
void describe(const Scenario& scenario, const Model& model, const StepPlan& plan, RunRecord& record) {
    record.triangles = model.mesh.n_triangles();
    record.interfaces = static_cast<Index>(model.interfaces.size());
    record.thickness = model.thickness;
    record.step = plan.limits.largest;
    record.scheme = scenario.time.scheme;
    record.mean_edge = mean_edge(model.mesh);
    record.rayleigh_speed = rayleigh_speed(scenario);
    record.materials = material_names(scenario);
}

/// As text, and as lines of the record.
std::string collect_warnings(const ReadResult& read, const std::vector<Diagnostic>& of_model, RunRecord& record) {
    std::string text;
    for (const auto& warnings : {of_model, read.warnings})
        for (const Diagnostic& warning : warnings) text += format(warning), record.warnings.push_back(warning.message);
    return text;
}

/// What frames and figures take is given back and taken again thirty times a run; if the system had it in between, it would come back page by page and
/// zeroed, which made a third of what a frame costs.
void keep_freed_memory() {
#ifdef __GLIBC__
    mallopt(M_TRIM_THRESHOLD, 1 << 30);
    mallopt(M_MMAP_THRESHOLD, 1 << 25);  // the most that it takes
#endif
}

/// A run that may begin: all that is known before its directory is touched.
struct Prepared {
    const ReadResult& read;
    const RunOptions& options;
    const std::filesystem::path& directory;
    const Model& model;
    const StepPlan& plan;
    MoreauJean& stepper;
    const std::string& warnings;
    const std::string& extension;  // what is to be said of a later end
    const Stopwatch& whole;
};

/// Where an earlier part of the run left off, into `memory`; says so. Nothing is changed where that is refused.
void resume(const Prepared& run, Checkpoints& checkpoints, RunMemory& memory, RunLog& log) {
    std::string said = checkpoints.read(memory) + run.extension;
    check_until_is_ahead(run.options.until, memory.now, run.directory);
    log.cut_to(memory.log_size);
    memory.recorder.open_files();
    said += resumed_text(memory.now) + missing_text(memory.recorder.missing_files());
    std::fputs(said.c_str(), stderr);  // also where progress is not wanted
    log.add(said);
}

/// The run, or the rest of it. Throws OutputError where something cannot be written.
ExitCode carry_out(const Prepared& prepared, RunDirectory& place, RunRecord& record) {
    const Scenario& scenario = prepared.read.scenario;
    const RunOptions& options = prepared.options;
    const std::filesystem::path& directory = prepared.directory;
    const Model& model = prepared.model;
    MoreauJean& stepper = prepared.stepper;
    stepper.give_up_when(InterruptGuard::interrupted);
    const Stopwatch& whole = prepared.whole;
    RunLog& log = place.log();
    if (!place.resumes()) log.add(prepared.warnings + random_sets_text(scenario));

    const Stopwatch preload;
    State now = place.resumes() ? initial_state(model) : start_of(model, scenario, stepper, record);
    if (scenario.time.start_in_equilibrium && !place.resumes()) record.cpu_preload = preload.cpu();
    Recorder recorder(model, now, recorder_options(scenario, model, directory, place.resumes()));
    StepControl control(prepared.plan.limits);
    RunMemory memory{.now = now, .control = control, .recorder = recorder};
    Checkpoints checkpoints(directory, scenario.output.checkpoint_every);
    if (place.resumes()) resume(prepared, checkpoints, memory, log);
    const RunMemory before = memory;  // its times
    record.cpu_model += before.cpu_model;
    record.cpu_preload += before.cpu_preload;
    const std::int64_t steps_before = now.n_steps;
    const double output_before = recorder.output_seconds();
    const double until = std::min(options.until, scenario.time.end);
    Progress progress(options.quiet ? nullptr : stderr, now, until, record.triangles);
    const Stopwatch stepping;
    const auto save = [&] {
        recorder.finish_frames();
        memory.log_size = log.size();
        memory.cpu = before.cpu + whole.cpu(), memory.wall = before.wall + whole.wall();
        memory.cpu_model = record.cpu_model, memory.cpu_preload = record.cpu_preload;
        memory.cpu_steps = before.cpu_steps + stepping.cpu() - (recorder.output_seconds() - output_before);
        checkpoints.write(memory);
    };
    const Stepping run{.scenario = scenario,
                       .model = model,
                       .options = options,
                       .directory = directory,
                       .stepper = stepper,
                       .control = control,
                       .recorder = recorder,
                       .progress = progress,
                       .log = log,
                       .smallest_step = prepared.plan.limits.smallest};
    step_to_end(run, until, checkpoints, save, now, record);
    record.cpu_steps = before.cpu_steps + stepping.cpu() - (recorder.output_seconds() - output_before);
    progress.finish(now, recorder);
    recorder.finish(now, record.status == "failed");
    say_new_warnings(run, now);
    for (const std::string& warning : {missing_text(recorder.missing_files()), not_dumped_text(options.dump_lcp, steps_before, now.n_steps)}) {
        if (warning.empty()) continue;
        std::fputs(warning.c_str(), stderr);
        log.add(warning);
        record.warnings.push_back(warning.substr(0, warning.size() - 1));
    }

    // what came of it
    conclude(scenario, model, now, recorder, control, record);
    record.factor = stepper.factor_size();
    record.wall = before.wall + whole.wall();
    record.cpu = before.cpu + whole.cpu();
    write_whole_file(directory / "run.json", run_json(record));
    const std::string end = end_of_run(record, directory);
    log.add(end);
    if (record.status == "failed") checkpoints.remove();
    else if (StepControl::has_reached(now, scenario.time.end)) checkpoints.keep_for_later_end();
    std::fputs(end.c_str(), stdout);
    return exit_code(record);
}

/// Something could not be written: says so in run.json, if that can be written.
void note_output_failure(const std::filesystem::path& directory, const std::string& what, RunRecord& record) {
    record.status = "failed";
    record.output_failed = true;
    record.reason = what + "; when that is mended, the same command " + (Checkpoints::exist_in(directory) ? "goes on from the last checkpoint" : "starts it again");
    try {
        write_whole_file(directory / "run.json", run_json(record));
    } catch (const OutputError&) {
        // as full as it is, the old one stays
    }
}

}  // namespace

ExitCode run_scenario(const ReadResult& asked, const RunOptions& options) {
    check_until(options.until);
    const std::filesystem::path directory = options.output.empty() ? std::filesystem::path("runs") / asked.scenario.name : options.output;
    RunRecord record{.status = "running", .name = asked.scenario.name, .title = asked.scenario.title, .command = options.command, .seed = asked.scenario.seed};
    const Stopwatch whole;
    record.threads = use_threads(options.threads);
    keep_freed_memory();

    // mesh and model; nothing is written before they are known to be possible
    const Model model = model_of(asked);
    const Continuation continuation = options.force ? Continuation{.read = asked} : continuation_of(asked, model, directory);
    const ReadResult& read = continuation.read;
    const Scenario& scenario = read.scenario;
    check_specimen(read, model);
    refuse_unheld_body(read, model);
    const StepPlan plan = plan_of(read, model, options.until);
    if (!options.dump_lcp.empty()) check_dump(model, scenario.time.scheme);
    MoreauJean stepper(model, scenario.time.scheme);
    record.cpu_model = whole.cpu();
    describe(scenario, model, plan, record);
    const std::string warnings = collect_warnings(read, findings_of_model(read, model, plan), record);
    if (!options.quiet) std::fputs(warnings.c_str(), stderr);

    const InterruptGuard guard;  // what is begun in the directory is ended there
    RunDirectory place(directory, first_files(read), record, options.force, continuation.of_run);
    try {
        return carry_out({read, options, directory, model, plan, stepper, warnings, continuation.said, whole}, place, record);
    } catch (const OutputError& error) {
        note_output_failure(directory, error.what(), record);
        throw OutputError(record.reason);
    }
}

}  // namespace knap
