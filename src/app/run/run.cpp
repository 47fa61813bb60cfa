#include "app/run/run.hpp"

#include "app/check/findings.hpp"
#include "app/run/checkpoint.hpp"
#include "app/run/continuation.hpp"
#include "app/run/report.hpp"
#include "app/run/run_directory.hpp"
#include "app/run/run_text.hpp"
#include "app/run/start_state.hpp"
#include "app/setup/adaptation.hpp"
#include "app/setup/excavations.hpp"
#include "app/setup/process.hpp"
#include "app/setup/setup.hpp"
#include "base/display_unit.hpp"
#include "base/error.hpp"
#include "base/formatted.hpp"
#include "base/stopwatch.hpp"
#include "base/terminal.hpp"
#include "base/whole_file.hpp"
#include "record/progress.hpp"
#include "stepper/moreau_jean.hpp"
#include "stepper/rigid/freeze.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace knap {
namespace {

/// What is fixed during a run. Only an excavation or a refinement replaces the model, and the stepper with it.
struct RunSetup {
    const Scenario& scenario;
    Model& model;
    const StepPlan& plan;
    const RunOptions& options;
    const std::filesystem::path& directory;
    RunOrigin& origin;
};

/// Whether report.html is there while the run goes on.
bool is_watched(const Scenario& scenario, const RunOptions& options) {
    return scenario.output.report && !options.quiet;
}

/// A stepper of the present model, which an interrupt ends.
void renew(std::optional<MoreauJean>& stepper, const Model& model, const SchemeOptions& scheme,
           const StepLimits& limits) {
    stepper.emplace(model, scheme);
    stepper->resolve_islands(limits);
    stepper->give_up_when(InterruptGuard::interrupted);
}

/// The pieces of a state, and how they move.
RunRecord::Pieces pieces_of(const Model& model, State state, const RigidOptions& options) {
    RunRecord::Pieces found;
    const FrozenPieces frozen = freeze(model, state);
    for (const FrozenBody::Piece& piece : frozen.body->pieces) {
        ++found.n[static_cast<std::size_t>(state.piece_state(piece.first_triangle))];
        if (piece.weakest < infinity && !can_break(piece, options))
            ++found.n_never_break, found.mass_never_break += piece.mass;
    }
    return found;
}

/// A run: steps until its end, observed by a recorder, with a record of it all. Every function throws OutputError where
/// a file cannot be written.
class Run {
public:
    Run(const RunSetup& setup, std::optional<MoreauJean>& stepper, Excavations excavations, Adaptation adaptation,
        RunDirectory& place, RunRecord& record, const Stopwatch& clock, const StartState* other)
        : setup_(setup),
          stepper_(stepper),
          excavations_(std::move(excavations)),
          adaptation_(std::move(adaptation)),
          log_(place.log()),
          record_(record),
          clock_(clock),
          now_(other ? other->now
                     : start_of(
                           setup.model, stepper, setup.scenario.time.start_in_equilibrium && !place.resumes(),
                           adaptation_, [this] { renew_stepper(); },
                           SearchProgress(setup.options.quiet ? nullptr : stderr), record)),
          control_(setup.plan.limits),
          recorder_(setup.model, now_,
                    recorder_options(setup.scenario, setup.model, setup.origin.works, setup.directory, place.resumes(),
                                     other != nullptr)),
          checkpoints_(setup.directory, setup.scenario.output.checkpoint_every),
          states_(setup.directory, setup.scenario.output.states) {}

    /// Continues from the last checkpoint. `text`: what else there is to report. A refusal changes nothing.
    void resume(const std::string& text);
    /// Goes on with the energies and cracks of another run; `text`: for the log.
    void start_from(StartState& other, const std::string& text);
    void step_to_end();
    void finish();

private:
    void step();
    void count(const StepReport& report);
    void freeze();
    void excavate();
    void adapt(const std::optional<Vec2>& also = {});
    void replace_model(const auto& replace);
    const SchemeOptions& scheme() const { return setup_.scenario.time.scheme; }
    void renew_stepper() { renew(stepper_, setup_.model, scheme(), setup_.plan.limits); }
    RunMemory memory();
    void save();
    std::vector<std::string> missing_files() const;
    void report_warnings();
    void report(const std::string& warning);
    TimeSpent spent() const;

    RunSetup setup_;
    std::optional<MoreauJean>& stepper_;
    Excavations excavations_;
    Adaptation adaptation_;
    AppendedFile& log_;
    RunRecord& record_;
    const Stopwatch& clock_;
    State now_, next_ = now_;
    StepControl control_;
    Recorder recorder_;
    Checkpoints checkpoints_;
    KeptStates states_;
    RunMemory memory_{// its times: of the earlier parts
                      .origin = setup_.origin,
                      .now = now_,
                      .control = control_,
                      .recorder = recorder_,
                      .excavations = excavations_,
                      .adaptation = adaptation_,
                      .triangle_steps = triangle_steps_};
    Stopwatch stepping_;
    std::int64_t first_step_ = now_.n_steps;
    std::int64_t triangle_steps_ = 0;
    double earlier_output_ = recorder_.time().cpu;  // [s]
    double until_ = std::min(setup_.options.until, setup_.scenario.time.end);
    bool tells_damping_ = true;
    bool depends_on_end_ = false;  // the following steps are not those of a longer run, and are not saved
    std::optional<Progress> progress_;
    std::optional<LiveReport> live_;        // none with --quiet
    std::vector<std::string> lost_of_log_;  // in an earlier part of the run

    /// The simulated time is over, or the body is at rest.
    bool is_complete() const { return StepControl::has_reached(now_, setup_.scenario.time.end) || recorder_.at_rest(); }
};

void Run::resume(const std::string& text) {
    const std::string warning = checkpoints_.read(memory_);
    if (now_.time - now_.last_step >= setup_.options.until)  // its last step may have ended there
        throw UserError("until-passed",
                        "the run in `" + setup_.directory.string() + "` is already at t = " + shortest(now_.time) +
                            " s, beyond --until " + shortest(setup_.options.until) + " s",
                        "give a later --until, or none, to continue; or start it again with --force");
    excavations_.repeat(setup_.model);
    adaptation_.repeat(setup_.model);
    fit_laws(setup_.model, now_);
    next_ = now_;  // its nodes are those of the present model
    tells_damping_ = damping_text(scheme(), setup_.model, now_, 0).empty();
    renew_stepper();
    recorder_.model_changed();
    if (log_.size() < memory_.log_size) lost_of_log_ = {"log.txt has lost its end"};
    log_.truncate(memory_.log_size);
    recorder_.open_files();
    states_.skip_to(now_);
    first_step_ = now_.n_steps;
    earlier_output_ = recorder_.time().cpu;
    const std::string report = warning + text +
                               "resumed: continues from the checkpoint at t = " + readable(now_.time, "s", 9) +
                               ", step " + std::to_string(now_.n_steps) + "\n" + missing_text(missing_files());
    std::fputs(report.c_str(), stderr);  // also with --quiet
    log_.add(report);
}

void Run::start_from(StartState& other, const std::string& text) {
    control_.start_from(other.control, now_);
    other.reader.read_energies_and_cracks(recorder_);
    recorder_.set_back(other.time);
    other.complete(recorder_);
    const std::string report =
        text + formatted("starts from `%s` at its t = %s, step %lld; the time counts from 0 again\n",
                         setup_.scenario.time.start_run.c_str(), readable(other.time, "s", 9).c_str(),
                         static_cast<long long>(other.n_steps));
    std::fputs(report.c_str(), stderr);
    log_.add(report);
    recorder_.begin(now_);
}

/// By all parts of the run so far.
TimeSpent Run::spent() const {
    const TimeSpent& earlier = memory_.spent;
    return {.cpu = earlier.cpu + clock_.cpu(),
            .wall = earlier.wall + clock_.wall(),
            .model = earlier.model + record_.spent.model,
            .preload = earlier.preload + record_.spent.preload,
            .steps = earlier.steps + stepping_.cpu() - (recorder_.time().cpu - earlier_output_)};
}

/// Memory for a checkpoint of this moment.
RunMemory Run::memory() {
    recorder_.flush_files();
    flush_to_disk(setup_.directory / "log.txt");
    RunMemory memory = memory_;
    memory.log_size = log_.size(), memory.spent = spent();
    return memory;
}

void Run::save() { checkpoints_.write(memory()); }

/// Files that are lost or damaged.
std::vector<std::string> Run::missing_files() const {
    std::vector<std::string> files = recorder_.missing_files();
    for (const auto& more : {states_.missing(), lost_of_log_}) files.insert(files.end(), more.begin(), more.end());
    return files;
}

void Run::report(const std::string& warning) {
    if (!warning.empty()) progress_->print(warning), log_.add(warning);
}

void Run::report_warnings() {  // each gate warns once in a run
    for (const Gate* gate : recorder_.gates().new_warnings()) {
        const std::string text = warning_text(*gate, now_);
        report(text);
        recorder_.gates().warned(*gate, text);
    }
}

/// `replace` gives the run another model and the state of it; frames of the present one are written before.
void Run::replace_model(const auto& replace) {
    recorder_.finish_frames();
    stepper_.reset();
    replace();
    next_ = now_;
    renew_stepper();
}

/// The next step is tried as one of rigid pieces, a leapfrog. With bulk = "auto" what stands deforms in large steps.
void Run::freeze() {
    if (now_.has_end_velocities()) {
        if (scheme().bulk == BulkScheme::automatic) return;
        begin_leapfrog(now_);
    }
    now_.motion = Motion::rigid;
}

/// A trial step of the whole body shows the forces that the region exerts on the rest.
void Run::excavate() {
    double h = stepper_->step_size(now_, control_.next(now_));
    for (StepReport trial = stepper_->step(now_, h, next_); trial.rejection != Rejection::none;
         trial = stepper_->step(now_, h, next_))
        if (h *= 0.5; h < setup_.plan.limits.smallest)
            throw SimulationError("no step from t = " + readable(now_.time, "s", 9) +
                                  ", where a region is to vanish: see its place " + place_text(trial.where));
    ExcavationEnergies energies;
    report(excavations_.prepare(setup_.model, *stepper_, now_, next_, h));
    const SchemeOptions of_trial = stepper_->options_of(now_, h);
    replace_model([&] { log_.add(excavations_.perform(next_, of_trial, setup_.model, now_, energies)); });
    recorder_.after_excavation(energies);
}

/// Refines the mesh where that is due, or where a step would break it at a coarse place.
void Run::adapt(const std::optional<Vec2>& also) {
    const Stopwatch watch;
    if (std::optional<RefinedMesh> mesh = adaptation_.look(setup_.model, now_, also))
        replace_model([&] {
            next_ = {}, return_freed_memory();  // two models need memory
            AdaptedModel refined = adaptation_.refine(setup_.model, now_, std::move(*mesh), also);
            setup_.model = std::move(refined.model), now_ = std::move(refined.state);
            log_.add(probes_text(recorder_.after_adaptation(now_, refined.numbers, refined.energies)));
        });
    adaptation_.took(watch.cpu());
    report(adaptation_.take_warning());
}

/// One attempt of a step: the state advances, or stays where the step is cut back. Throws SimulationError where the run
/// cannot continue.
void Run::step() {
    double h = stepper_->step_size(now_, control_.next(now_));
    if (stepper_->is_implicit(now_)) h = excavations_.step_size(now_, h);
    const StepReport report = stepper_->step(now_, h, next_);
    if (report.rejection == Rejection::too_coarse) return adapt(report.where);
    if (const std::optional<Cutback> cut = control_.judge(now_, h, report)) {
        const Vec2 where = place_of(*cut, setup_.model, now_, next_);
        log_.add(cutback_text(*cut, where, setup_.scenario.time.end));
        if (control_.is_stuck())
            throw SimulationError(stuck_text(*cut, where, control_.smallest_step(now_, cut->reason)));
        if (cut->changes_to_explicit) begin_leapfrog(now_);
        if (const auto thawed = cut->thaws ? stepper_->thaw(now_, next_) : std::nullopt) count(*thawed);
        return;
    }
    if (setup_.options.dump_lcp.contains(next_.n_steps))
        log_.add(dump_lcp(setup_.model, now_, h, scheme(), setup_.directory / "lcp"));
    if (next_.frozen && !now_.frozen) log_.add(rigid_text(now_.time, next_.rigid_pieces.size()));
    count(report);
    if (!control_.ends_explicit_stage(now_)) return;
    const StepReport closing = stepper_->close_leapfrog(now_, next_);
    if (closing.rejection != Rejection::none) return control_.stay_explicit(now_);
    control_.begin_implicit_stage(next_, closing);
    log_.add(quiet_text(next_.time));
    count(closing);
}

/// The step to the next state has been taken.
void Run::count(const StepReport& report) {
    std::swap(now_, next_);
    const std::string of_damping = tells_damping_ ? damping_text(scheme(), setup_.model, now_, next_.time) : "";
    if (!of_damping.empty()) log_.add(of_damping), tells_damping_ = false;
    adaptation_.after_step(setup_.model);
    triangle_steps_ += setup_.model.mesh.n_triangles();
    recorder_.after_step(now_, report);
    progress_->after_step(now_, recorder_, setup_.model.mesh.n_triangles());
    if (live_ && live_->is_due())
        live_->write(progress_->line(now_, recorder_), now_.time / until_, setup_.model, now_, record_, recorder_);
    report_warnings();
    if (states_.is_due(now_)) states_.write(memory());
    const GateKeeper& gates = recorder_.gates();
    if (!gates.pass())
        throw SimulationError(violated_text(gates.gates(), now_, place_of_largest_speed(setup_.model, now_)));
    if (!depends_on_end_ && checkpoints_.due()) save();
}

void Run::step_to_end() {
    progress_.emplace(setup_.options.quiet ? nullptr : stderr, now_, until_);
    if (is_watched(setup_.scenario, setup_.options)) live_.emplace(setup_.scenario, setup_.directory);
    stepping_ = Stopwatch();
    if (setup_.scenario.time.start_in_equilibrium && now_.n_steps == 0) report(start_damage_text(setup_.model, now_));
    states_.skip_to(now_);
    try {
        while (record_.status == "running" && !StepControl::has_reached(now_, until_) && !recorder_.at_rest()) {
            if (InterruptGuard::interrupted()) {
                record_.status = "interrupted";
                break;
            }
            if (control_.may_freeze(now_)) freeze();
            if (!depends_on_end_ && control_.depends_on_end(now_)) {  // from here the finished run can be extended
                depends_on_end_ = true;
                try {
                    save();
                } catch (const OutputError& error) {
                    log_.add(
                        std::string("warning[checkpoint]: no checkpoint of the end, this run cannot be extended: ") +
                        error.what() + "\n");
                }
            }
            try {
                while (excavations_.is_due(now_)) excavate();
                if (adaptation_.is_due(now_)) adapt();
                step();
            } catch (const StepGivenUp&) {
                continue;  // interrupted
            }
        }
        if (!StepControl::has_reached(now_, setup_.scenario.time.end) && record_.status != "failed" && !depends_on_end_)
            save();  // before the lines of an early end are written
    } catch (const OutputError&) {
        throw;
    } catch (const SimulationError& error) {
        record_.status = "failed";
        record_.reason = error.what();
    }
    if (record_.status == "running") record_.status = "done";
}

/// Last outputs and the record.
void Run::finish() {
    const double stepping_time = spent().steps;
    progress_->finish(now_, recorder_);
    const double time_end = setup_.scenario.time.end;
    const bool over = StepControl::has_reached(now_, time_end), complete = is_complete();
    if (complete && !over) record_.ended = "rest";
    recorder_.finish(now_, record_.status == "failed" || !record_.ended.empty());
    report_warnings();
    record_.summary = summarise(setup_.model, now_, recorder_);
    for (const std::string& warning :
         {missing_text(missing_files()), not_dumped_text(setup_.options.dump_lcp, first_step_, now_.n_steps),
          over && recorder_.rest() && !recorder_.at_rest() ? not_at_rest_text(time_end) : "",
          complete ? not_failed_text(setup_.scenario, record_.summary, recorder_.n_breaks()) : ""}) {
        report(warning);
        if (!warning.empty()) record_.warnings.push_back(warning.substr(0, warning.size() - 1));
    }
    for (const auto& [gate, text] : recorder_.gates().warnings())
        record_.warnings.push_back(text.substr(0, text.size() - 1));
    record_.steps = now_.n_steps, record_.time = now_.time, record_.factor = stepper_->factor_size();
    record_.set_counts(recorder_.ledger().worst(), control_);
    record_.triangles = setup_.model.mesh.n_triangles(), record_.triangle_steps = triangle_steps_;
    record_.interfaces = static_cast<Index>(setup_.model.interfaces.size());
    if (const double size = setup_.scenario.adapt.size; setup_.scenario.adapt.active()) {
        const double n = n_triangles_of(recorder_.deformation().body_area(), size), steps = now_.n_steps;
        record_.adaptation = adaptation_.counts(setup_.model, now_);
        record_.adaptation_gain = adaptation_.stays_coarse() ? NAN : n * steps / triangle_steps_;
    }
    if (scheme().rigid.active()) {
        record_.pieces = pieces_of(setup_.model, now_, scheme().rigid);
        record_.pieces->thawed_time = control_.thawed_time();
    }
    record_.gates = recorder_.gates().gates();
    if (record_.status == "done" && complete)
        record_.expect = judge_expectations(setup_.scenario.expect, record_.summary, record_.rayleigh_speed);
    if (record_.status == "failed") record_.n_not_judged = setup_.scenario.expect.size();
    record_.figures = recorder_.figures(), record_.probes = recorder_.probes().subjects();
    record_.output = recorder_.time();
    record_.spent = spent(), record_.spent.steps = stepping_time;
    write_whole_file(setup_.directory / "run.json", run_json(record_), true);
    const std::string end = end_of_run(record_, setup_.directory);
    log_.add(end);
    if (record_.status == "failed") checkpoints_.remove();
    else if (complete) checkpoints_.keep_for_later_end();
    print_messages(end, stdout);
    if (!setup_.scenario.output.report) return;
    write_report(setup_.scenario, record_, recorder_, setup_.directory);
    std::printf("report:  %s\n", (setup_.directory / "report.html").c_str());
}

ExitCode exit_code(const RunRecord& record) {
    if (record.status == "interrupted") return exit_interrupted;
    if (record.status == "failed" || !std::ranges::all_of(record.gates, &Gate::pass)) return exit_failed;
    return std::ranges::all_of(record.expect, &ExpectResult::pass) ? exit_done : exit_expectation;
}

}  // namespace

ExitCode run_scenario(ReadResult requested, const RunOptions& options) {
    if (!(options.until > 0))
        throw UserError("bad-value", "`--until " + shortest(options.until) + " s` ends the run before it starts",
                        "use a time after t = 0, as in 20us");
    const std::filesystem::path directory =
        options.output.empty() ? std::filesystem::path("runs") / requested.scenario.name : options.output;
    const Stopwatch clock;
    const int n_threads = use_threads(options.threads);
    keep_freed_memory();

    // but a page for who waits, nothing is written before mesh and model are known to be possible
    RunDirectory place(directory);
    RunRecord record{.name = requested.scenario.name, .title = requested.scenario.title, .command = options.command};
    const auto page = [&](const char* state) {
        return is_watched(requested.scenario, options)
                   ? starting_page(requested.scenario, requested.source.text(), record, state)
                   : "";
    };
    if (const std::string first = page("makes its mesh"); !first.empty()) place.announce(first, record);
    Model model = model_of(requested);
    const Continuation continuation =
        options.force ? Continuation{.read = requested} : continuation_of(requested, model, directory);
    const ReadResult& read = continuation.read;
    const Scenario& scenario = read.scenario;
    const std::vector<Diagnostic> of_obstacles = check_model(read, model);
    RunOrigin origin = origin_of(read);
    Excavations excavations(plan_excavations(read, model));
    const StepPlan plan = plan_of(read, model, options.until);
    AdaptOptions adapt = scenario.adapt;
    adapt.smallest_step = plan.stable_step;
    Adaptation adaptation(adapt, model_input(scenario));
    adaptation.guard(model);
    if (!options.dump_lcp.empty()) check_dump(model, scenario.time.scheme);
    std::optional<MoreauJean> stepper;
    renew(stepper, model, scenario.time.scheme, plan.limits);
    record = record_of(scenario, model, plan);
    record.command = options.command, record.threads = n_threads, record.spent.model = clock.cpu();
    std::string warnings;
    for (const auto& found : {findings_of_model(read, model, plan), of_obstacles, read.warnings})
        for (const Diagnostic& warning : found) {
            warnings += format(warning), record.warnings.push_back(warning.message);
            if (!options.quiet || warning.code == "no-contact") print_messages(format(warning));
        }
    FirstFiles files{{"scenario.toml", read.source.text()}, {"resolved.toml", resolved_for_run(read)}};
    for (const NamedFile& file : scenario.files) files.emplace_back(file.name, file.bytes);

    const InterruptGuard guard;  // from here on the run ends with complete files
    place.start(files, record, options.force, continuation.first_files_of_shorter, page("before its first step"));
    try {
        if (!place.resumes())
            place.log().add(warnings + placed_sets_text(scenario, model.mesh) + probes_text(model, scenario.probes));
        std::optional<StartState> other;
        if (const NamedFile* file = scenario.start_file(); file != nullptr && !place.resumes()) {
            other.emplace(file->bytes, origin, scenario, model, excavations, adaptation);
            renew(stepper, model, scenario.time.scheme, plan.limits);
        }
        Run run({scenario, model, plan, options, directory, origin}, stepper, std::move(excavations),
                std::move(adaptation), place, record, clock, other ? &*other : nullptr);
        if (other) run.start_from(*other, jumps_text(read, model, *other, plan.limits.largest));
        if (place.resumes()) run.resume(continuation.text);
        run.step_to_end();
        run.finish();
        place.log().close();
        return exit_code(record);
    } catch (const std::bad_alloc&) {
        record.status = "failed", record.reason = "out of memory: increase mesh.size";
        write_whole_file(directory / "run.json", run_json(record), true);
        throw;
    } catch (const OutputError& error) {
        record.status = "failed", record.output_failed = true;
        record.reason = std::string(error.what()) + "; once this is repaired, the same command " +
                        (Checkpoints::exist_in(directory) ? "continues from the last checkpoint" : "starts it again");
        try {
            write_whole_file(directory / "run.json", run_json(record), true);
        } catch (const OutputError&) {
            // the disk is still full: the old one stays
        }
        throw OutputError(record.reason);
    }
}

}  // namespace knap
