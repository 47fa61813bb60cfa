// Each run is a process of its own: it has its own processor time and memory, and several run at the same time.
#include "app/ensemble/ensemble.hpp"
#include "app/run/checkpoint.hpp"
#include "app/run/report.hpp"
#include "app/run/run_directory.hpp"
#include "app/setup/process.hpp"
#include "base/child_process.hpp"
#include "base/display_unit.hpp"
#include "base/error.hpp"
#include "base/formatted.hpp"
#include "base/stopwatch.hpp"
#include "base/text.hpp"
#include "base/whole_file.hpp"
#include "record/html.hpp"
#include "record/progress.hpp"
#include "record/version.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>
#include <map>
#include <span>

namespace knap {
namespace {

namespace fs = std::filesystem;
using Texts = std::vector<std::string>;

constexpr int live_period = 3;  // [s] between two reports while runs go on

/// Blocks SIGINT, SIGTERM, SIGHUP and SIGCHLD (a run has ended) and fetches them one by one.
class HeldSignals {
public:
    HeldSignals() {
        std::signal(SIGCHLD, SIG_DFL);
        sigemptyset(&held_);
        for (const int which : {SIGINT, SIGTERM, SIGHUP, SIGCHLD})
            if (!is_ignored(which)) sigaddset(&held_, which);  // blocking would end the ignoring
        sigprocmask(SIG_BLOCK, &held_, &before_);
    }
    /// After an interrupt further ones are ignored while the program ends.
    ~HeldSignals() {
        if (interrupted_)
            for (const int which : {SIGINT, SIGTERM, SIGHUP}) std::signal(which, SIG_IGN);
        sigprocmask(SIG_SETMASK, &before_, nullptr);
    }
    /// Waits for a signal, some seconds at most; true for the first interrupt.
    bool next_interrupts() {
        constexpr timespec most{.tv_sec = live_period, .tv_nsec = 0};
        const int which = sigtimedwait(&held_, nullptr, &most);  // -1: none came
        const bool first = which > 0 && which != SIGCHLD && !interrupted_;
        interrupted_ = interrupted_ || first;
        return first;
    }
    bool interrupted() const { return interrupted_; }
    const sigset_t& before() const { return before_; }

private:
    sigset_t held_, before_;
    bool interrupted_ = false;
};

/// The words of the command line of a run in a directory of `runs`.
Texts command_of(const std::string& program, const std::string& scenario, const EnsembleRun& run, const fs::path& runs,
                 bool force) {
    Texts words{program, "run", scenario, "-j", "1", "-q", "-o", (runs / run.name).string()};
    if (force) words.emplace_back("--force");
    for (const std::string& set : run.overrides) words.insert(words.end(), {"-s", set});
    return words;
}

/// Starts a run, with its messages in <run>.log. An interrupted run goes on from its checkpoint if this program can
/// read it.
pid_t start(const std::string& scenario, const EnsembleRun& run, const fs::path& runs, bool force,
            const sigset_t& signals) {
    const bool anew = force || !Checkpoints::problem_in(runs / run.name, false).empty();
    const fs::path path = runs / (run.name + ".log");
    // O_NONBLOCK: a pipe without a reader is an error, not a long wait
    const int log = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_NONBLOCK | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (log < 0) throw OutputError("cannot write " + path.string() + ": " + error_text(errno));
    const pid_t batch = getpid();
    const auto prepare = [&] {
        // when the batch ends, even by SIGKILL, the run ends as by Ctrl-C: otherwise it would keep its directory locked
        if (prctl(PR_SET_PDEATHSIG, SIGTERM) != 0 || getppid() != batch) return false;
        return sigprocmask(SIG_SETMASK, &signals, nullptr) == 0;
    };
    const pid_t child =
        start_process("/proc/self/exe", command_of("knap", scenario, run, runs, anew), -1, log, prepare);
    close(log);
    if (child < 0) throw SimulationError(std::string("cannot start a run: ") + std::strerror(errno));
    return child;
}

/// "done, 343 steps, 0.5 s" or the failure; `ended`: status of its process from waitpid().
std::string outcome(const RunResult& result, int ended, bool interrupted) {
    if (interrupted && result.status == "refused") return "not started";
    if (result.is_under_way())
        return WIFSIGNALED(ended) ? "killed by signal " + std::to_string(WTERMSIG(ended)) : "failed: " + result.reason;
    if (result.status != "done" && result.status != "interrupted") return result.trouble();
    char text[100];
    std::snprintf(text, sizeof text, "%s, %.0f steps, %s", result.status.c_str(), result.steps,
                  readable(result.cpu, "s").c_str());
    return text;
}

void make_directory(const fs::path& directory) {
    std::error_code error;
    if (fs::create_directories(directory, error); error)
        throw UserError("cannot-write", "cannot create `" + directory.string() + "`: " + error.message());
}

/// Creates the directory of an ensemble, or takes an earlier one (with a <kind>.toml), for this process alone.
DirectoryLock take_directory(const fs::path& directory, const std::string& kind) {
    std::error_code error;
    if (!holds_only(directory, {kind + ".toml.part"}) && !fs::exists(directory / (kind + ".toml"), error))
        throw UserError("not-a-" + kind,
                        "`" + directory.string() + "` was not made by knap " + kind + " (it has no " + kind +
                            ".toml) and is left unchanged",
                        "choose another directory with --output");
    make_directory(directory);
    return DirectoryLock(directory);
}

/// The runs that are not finished in `runs`; by `force` all. Throws UserError where a directory has another run, unless
/// `force`, or no run at all.
std::vector<const EnsembleRun*> runs_to_do(std::span<const EnsembleRun> all, const fs::path& runs, bool force) {
    std::vector<const EnsembleRun*> to_do;
    for (const EnsembleRun& run : all) {
        if (!run.refusal.empty()) continue;
        const fs::path there = runs / run.name;
        const EarlierRecord record = earlier_record(there);
        const bool exists = !never_began(there, record),
                   same = exists && is_file_of(there / "resolved.toml", run.resolved);
        if (exists && !same && !record.is_of_a_run)
            throw UserError(
                "not-a-run",
                "`" + there.string() + "` was not made by knap (it has no run.json of a run); nothing was run",
                "choose another directory with --output, or delete this one by hand");
        if (exists && !same && !force)
            throw UserError("runs-exist", "`" + there.string() + "` has a run of another scenario; nothing was run",
                            "choose another directory with --output, or replace the old runs with --force");
        // a failed run would fail again, unless it could not write its output
        const bool finished = same && (record.status == "done" || (record.status == "failed" && !record.output_failed));
        if (!finished || force) to_do.push_back(&run);
    }
    return to_do;
}

/// Whether the run is still to be done, or to be continued.
bool is_to_go(const EnsembleRun& run) { return run.is_left() || run.result.status == "interrupted"; }

std::string title_of(const Ensemble& ensemble) { return ensemble.title.empty() ? ensemble.name : ensemble.title; }

/// "10 of 12 runs are done, 0 failed, 2 to go"
std::string state_of(const Ensemble& ensemble) {
    const auto count = [&](const auto& is) { return std::ranges::count_if(ensemble.runs, is); };
    const auto n = std::ssize(ensemble.runs), n_left = count(is_to_go), n_done = count(&EnsembleRun::is_done);
    return formatted("%td of %td runs are done, %td failed, %td to go", n_done, n, n - n_done - n_left, n_left);
}

/// report.html before the end: `head`, and the results so far.
void write_early_report(const Ensemble& ensemble, const std::string& head, const fs::path& directory) try {
    const bool none = std::ranges::all_of(ensemble.runs, is_to_go);
    write_whole_file(
        directory / "report.html",
        html_page(title_of(ensemble), ensemble.question,
                  head + html_section("Results so far", none ? "" : html_of_markdown(overview(ensemble)))));
} catch (const OutputError&) {
    // a full disk ends the ensemble where its results are written, not here
}

struct Running {
    const EnsembleRun* run;
    double since;  // [s]
};

/// How long the runs of a batch take, from the processor times of those that have ended: a run costs as much as
/// triangles times steps,
///
///     t ~ h^-3        (h: size of its mesh).
class Durations {
public:
    void add(const EnsembleRun& run) {
        if (std::isfinite(run.result.cpu)) cpu_ += run.result.cpu, work_ += work_of(run);
    }
    /// ", about 5 min left", or "" before the first run has ended. `now` [s] is on the clock of Running::since.
    std::string left(const std::vector<const EnsembleRun*>& to_do, const std::map<pid_t, Running>& running, double now,
                     int n_at_once) const {
        double sum = 0, longest = 0;
        for (const EnsembleRun* run : to_do) {
            if (work_ == 0 || !run->is_left()) continue;
            double left = cpu_ * work_of(*run) / work_;
            for (const auto& [child, other] : running)
                if (other.run == run) left = std::max(left - (now - other.since), 0.0);
            sum += left, longest = std::max(longest, left);
        }
        return work_ == 0 ? "" : ", about " + left_text(std::max(sum / n_at_once, longest));
    }

private:
    static double work_of(const EnsembleRun& run) { return run.mesh_size > 0 ? std::pow(run.mesh_size, -3) : 1; }
    double cpu_ = 0, work_ = 0;
};

/// Reads the result of each run that ends. False when interrupted. Meanwhile report.html says how many runs are done.
bool do_runs(Ensemble& ensemble, const std::string& scenario, const std::vector<const EnsembleRun*>& to_do,
             const fs::path& directory, const BatchOptions& options) {
    const fs::path runs = directory / "runs";
    HeldSignals signals;
    std::map<pid_t, Running> running;
    std::size_t n_started = 0, n_done = 0;
    Durations durations;
    const Stopwatch watch;
    double next_report = 0;  // [s]
    const auto may_start = [&] { return n_started < to_do.size() && !signals.interrupted(); };
    while (!running.empty() || may_start()) {
        if (may_start() && running.size() < static_cast<std::size_t>(options.n_at_once)) {
            const EnsembleRun* run = to_do[n_started++];
            running[start(scenario, *run, runs, options.force, signals.before())] = {run, watch.wall()};
            continue;
        }
        if (ensemble.report && !options.quiet && watch.wall() >= next_report) {
            Texts names;
            for (const auto& [child, under_way] : running) names.push_back(under_way.run->name);
            const double part = static_cast<double>(std::ranges::count_if(ensemble.runs, is_to_go)) /
                                static_cast<double>(ensemble.runs.size());
            const std::string state = state_of(ensemble) +
                                      durations.left(to_do, running, watch.wall(), options.n_at_once) + "; now " +
                                      joined(names);
            write_early_report(ensemble, html_live(ensemble.kind, state, "continues it", live_period, 1 - part),
                               directory);
            next_report = watch.wall() + live_period;
        }
        if (signals.next_interrupts())  // the runs receive Ctrl-C themselves, but perhaps not SIGTERM
            for (const auto& [child, under_way] : running) kill(child, SIGTERM);
        int status = 0;
        for (pid_t ended; (ended = waitpid(-1, &status, WNOHANG)) > 0;) {
            const auto found = running.find(ended);
            if (found == running.end()) continue;
            const EnsembleRun& run = *found->second.run;
            RunResult& result = ensemble.runs[static_cast<std::size_t>(&run - ensemble.runs.data())].result;
            result = read_result(runs / run.name, ensemble.quantities);
            durations.add(run);
            ++n_done;
            if (!options.quiet)
                std::fprintf(stderr, "run %zu of %zu: %s: %s\n", n_done, to_do.size(), run.name.c_str(),
                             outcome(result, status, signals.interrupted()).c_str());
            running.erase(found);
        }
    }
    if (signals.interrupted()) std::fprintf(stderr, "interrupted; the same command continues\n");
    return !signals.interrupted();
}

/// How to make an ensemble again, or to go on with it.
std::string repetition(const Texts& command) {
    return html_table({},
                      {{"command", command_line(command)}, {"program", "knap " + version() + " (" + git_hash() + ")"}});
}

/// report.html of an ensemble that was interrupted: what is done, and the command that goes on.
void write_interrupted_report(const Ensemble& ensemble, const Texts& command, const fs::path& directory) {
    const std::string state =
        "This " + ensemble.kind + " was interrupted: " + state_of(ensemble) + ". The same command continues it.";
    write_early_report(ensemble, html_list({state}, "bad") + html_section("How to continue it", repetition(command)),
                       directory);
}

/// report.html, with the way to the reports of its runs.
void write_report(const Ensemble& ensemble, const std::vector<CaptionedFigure>& figures, const std::string& overview,
                  const Texts& command, const fs::path& directory) {
    Texts troubles;
    std::string runs;
    for (const EnsembleRun& run : ensemble.runs) {
        if (const std::string trouble = run.result.trouble(); !trouble.empty())
            troubles.push_back(run.name + ": " + trouble);
        const std::string name = html_text(run.name);
        if (std::error_code none; !fs::exists(directory / "runs" / run.name / "report.html", none)) continue;
        runs += "<li><a href=\"runs/" + name + "/report.html\">" + name + "</a> " + html_text(run.result.status) +
                "</li>\n";
    }
    std::vector<fs::path> files;
    for (const CaptionedFigure& figure : figures)
        if (figure.file.extension() != ".svg") files.push_back(figure.file);  // the same as the .png
    const auto caption_of = [&](const fs::path& file) {
        return std::ranges::find(figures, file, &CaptionedFigure::file)->caption;
    };
    write_whole_file(
        directory / "report.html",
        html_page(title_of(ensemble), ensemble.question,
                  html_section("Warnings", html_list(troubles, "bad")) +
                      html_section("Results", html_of_markdown(overview)) +
                      html_section("Figures", html_figures(files, caption_of)) +
                      (runs.empty() ? "" : html_section("Runs", "<ul>\n" + runs + "</ul>\n")) +
                      html_section("How to repeat it",
                                   html_table({}, {{"command", command_line(command)},
                                                   {"program", "knap " + version() + " (" + git_hash() + ")"}}))));
}

}  // namespace

ExitCode run_ensemble(Ensemble ensemble, const std::string& scenario, const BatchOptions& options) {
    const std::string& kind = ensemble.kind;
    const fs::path usual = ensemble.safety       ? fs::path("studies") / (ensemble.name + "_safety")
                           : ensemble.is_study() ? fs::path("studies") / ensemble.name
                                                 : fs::path("sweeps") / ensemble.name,
                   directory = options.output.empty() ? usual : options.output;
    const fs::path runs = directory / "runs";
    if (ensemble.safety && (options.print_commands || !options.emit.empty()))
        throw UserError("exclusive-options", "the runs of --safety follow from one another and cannot be listed before",
                        "knap study --safety -j 3, in one job");
    const DirectoryLock lock = take_directory(directory, kind);
    auto to_do = runs_to_do(ensemble.runs, runs, options.force);
    write_whole_file(directory / (kind + ".toml"), ensemble.record);  // first: it marks the directory
    make_directory(runs);
    if (options.print_commands || !options.emit.empty()) {
        Texts commands;
        for (const EnsembleRun* run : to_do)
            commands.push_back(command_line(command_of(options.program, scenario, *run, runs, options.force)));
        const bool script = !options.emit.empty();
        if (!to_do.empty())
            std::printf("%s\n", script ? slurm_script(ensemble, scenario, to_do, commands, runs, options).c_str()
                                       : joined(commands, "\n").c_str());
        std::fprintf(stderr, "%zu of %zu runs are to be done; afterwards %s makes tables and figures\n", to_do.size(),
                     ensemble.runs.size(), script ? "its last job" : "the same command without --print-commands");
        return exit_done;
    }
    for (std::size_t n_done = 0;;) {
        for (EnsembleRun& run : std::span(ensemble.runs).subspan(n_done)) {
            if (std::ranges::find(to_do, &run) != to_do.end()) {
                run.result = {.values = std::vector<double>(ensemble.quantities.size(), NAN)};
                continue;
            }
            run.result = read_result(runs / run.name, ensemble.quantities);
            if (!run.refusal.empty()) run.result.reason = run.refusal;
        }
        if (!do_runs(ensemble, scenario, to_do, directory, options)) {
            if (ensemble.report) write_interrupted_report(ensemble, options.command, directory);
            return exit_interrupted;
        }
        n_done = ensemble.runs.size();
        if (!ensemble.safety || !continue_search(ensemble, scenario, options.n_at_once)) break;
        to_do = runs_to_do(std::span(ensemble.runs).subspan(n_done), runs, options.force);
    }
    if (ensemble.is_study() && ensemble.n_seeds == 0) judge_errors(ensemble);
    const std::string text = (ensemble.safety ? safety_text(ensemble) : "") + overview(ensemble) +
                             (ensemble.collectors.empty() ? "" : passages_table(ensemble, runs));
    write_whole_file(directory / (kind + ".md"), text);
    write_whole_file(directory / (kind + ".csv"), runs_csv(ensemble));
    if (!ensemble.collectors.empty()) write_whole_file(directory / "passages.csv", passages_csv(ensemble, runs));
    if (ensemble.has_statistics()) write_whole_file(directory / "statistics.csv", statistics_csv(ensemble));
    std::printf("%s%-9s%s\n", text.c_str(), (kind + ":").c_str(), directory.c_str());
    const std::vector<CaptionedFigure> figures = draw_ensemble(ensemble, directory);
    for (const CaptionedFigure& figure : figures) std::printf("figure:  %s\n", figure.file.c_str());
    if (ensemble.report) {
        write_report(ensemble, figures, text, options.command, directory);
        std::printf("report:  %s\n", (directory / "report.html").c_str());
    }
    if (ensemble.safety) return ensemble.safety->failure.empty() ? exit_done : exit_failed;
    const auto successful = [](const EnsembleRun& run) { return run.result.trouble().empty(); };
    return std::ranges::all_of(ensemble.runs, successful) ? exit_done : exit_failed;
}

}  // namespace knap
