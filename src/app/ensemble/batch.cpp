// Each run is a process of its own: its processor time and memory are its own, and several go side by side.
#include "app/ensemble/ensemble.hpp"
#include "app/run/checkpoint.hpp"
#include "app/run/interrupt.hpp"
#include "app/run/run_directory.hpp"
#include "app/run/run_json.hpp"
#include "base/error.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <map>

namespace knap {
namespace {

namespace fs = std::filesystem;

/// Blocks SIGINT, SIGTERM, SIGHUP and SIGCHLD (a run ended); they are fetched one by one.
class HeldSignals {
public:
    HeldSignals() {
        std::signal(SIGCHLD, SIG_DFL);
        sigemptyset(&held_);
        for (const int which : {SIGINT, SIGTERM, SIGCHLD}) sigaddset(&held_, which);
        if (!ignores_hangup()) sigaddset(&held_, SIGHUP);  // a blocked signal is not ignored
        sigprocmask(SIG_BLOCK, &held_, &before_);
    }
    /// Further interrupts after the first one are ignored while the program ends.
    ~HeldSignals() {
        if (interrupted_)
            for (const int which : {SIGINT, SIGTERM, SIGHUP}) std::signal(which, SIG_IGN);
        sigprocmask(SIG_SETMASK, &before_, nullptr);
    }
    /// Waits for a signal; true for the first interrupt.
    bool next_interrupts() {
        const int which = sigwaitinfo(&held_, nullptr);  // -1: none of them
        const bool first = which > 0 && which != SIGCHLD && !interrupted_;
        interrupted_ = interrupted_ || first;
        return first;
    }
    bool interrupted() const { return interrupted_; }
    const sigset_t& before() const { return before_; }  // for the runs

private:
    sigset_t held_, before_;
    bool interrupted_ = false;
};

/// Starts a run with its messages in <run>.log. An interrupted one goes on from its checkpoint, if this program can.
pid_t start(const std::string& scenario, const EnsembleRun& run, const fs::path& directory, bool force,
            const sigset_t& signals) {
    std::vector<std::string> words =
        command_of("knap", scenario, run, directory, force || !Checkpoints::usable_in(directory / run.name));
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const fs::path path = directory / (run.name + ".log");
    const int log = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_NONBLOCK | O_CLOEXEC,
                         0666);  // does not wait for the reader of a pipe
    if (log < 0) throw OutputError("cannot write " + path.string() + ": " + std::strerror(errno));
    const pid_t batch = getpid(), child = fork();
    if (child == 0) {
        // when the batch is gone, even by SIGKILL, the run ends as by Ctrl-C: an orphan would keep its directory from
        // the next batch
        if (prctl(PR_SET_PDEATHSIG, SIGTERM) != 0 || getppid() != batch) _exit(127);
        sigprocmask(SIG_SETMASK, &signals, nullptr);
        if (dup2(log, STDOUT_FILENO) >= 0 && dup2(log, STDERR_FILENO) >= 0) execv("/proc/self/exe", arguments.data());
        _exit(127);
    }
    close(log);
    if (child < 0) throw SimulationError(std::string("cannot start a run: ") + std::strerror(errno));
    return child;
}

/// "done, 343 steps, 0.5 s" or why not; `ended`: status of its process, as of wait().
std::string outcome(const fs::path& run, int ended, bool interrupted) {
    if (interrupted && !fs::exists(run / "run.json")) return "not begun";
    const RunResult result = read_result(run, {});
    if (result.is_under_way())
        return WIFSIGNALED(ended) ? "killed by signal " + std::to_string(WTERMSIG(ended)) : "failed: " + result.reason;
    if (result.status != "done" && result.status != "interrupted") return result.trouble();
    char text[100];
    std::snprintf(text, sizeof text, "%s, %.0f steps, %.3g s", result.status.c_str(), result.steps, result.cpu);
    return text;
}

}  // namespace

DirectoryLock take_directory(const fs::path& directory, const std::string& kind) {
    std::error_code error;
    if (!holds_only(directory, {kind + ".toml.part"}) && !fs::exists(directory / (kind + ".toml"), error))
        throw UserError("not-a-" + kind,
                        "`" + directory.string() + "` was not made by knap " + kind + " (no " + kind +
                            ".toml), so it is left alone",
                        "choose another directory with --output");
    if (fs::create_directories(directory, error); error)
        throw UserError("cannot-write", "cannot make `" + directory.string() + "`: " + error.message());
    return DirectoryLock(directory);
}

std::vector<const EnsembleRun*> runs_to_do(const std::vector<EnsembleRun>& runs, const fs::path& directory,
                                           bool force) {
    std::vector<const EnsembleRun*> to_do;
    for (const EnsembleRun& run : runs) {
        const fs::path there = directory / run.name;
        const EarlierRecord record = earlier_record(there);
        const bool begun = !never_began(there, record),
                   same = begun && is_file_of(there / "resolved.toml", run.resolved);
        if (begun && !same && !record.is_of_a_run)
            throw UserError(
                "not-a-run",
                "`" + there.string() + "` was not made by knap (it has no run.json of a run), nothing was run",
                "choose another directory with --output, or delete this one by hand");
        if (begun && !same && !force)
            throw UserError("runs-exist",
                            "`" + there.string() + "` is not one of these runs as they are now, nothing was run",
                            "choose another directory with --output, or replace the old runs with --force");
        // a failure would only be repeated
        const bool finished = same && (record.status == "done" || (record.status == "failed" && !record.output_failed));
        if (!finished || force) to_do.push_back(&run);
    }
    return to_do;
}

std::vector<std::string> command_of(const std::string& program, const std::string& scenario, const EnsembleRun& run,
                                    const fs::path& place, bool force) {
    std::vector<std::string> words{program, "run", scenario, "-j", "1", "-q", "-o", (place / run.name).string()};
    if (force) words.emplace_back("--force");
    for (const std::string& set : run.overrides) words.insert(words.end(), {"-s", set});
    return words;
}

bool do_runs(const std::string& scenario, const std::vector<const EnsembleRun*>& to_do, const fs::path& directory,
             const BatchOptions& options) {
    HeldSignals signals;
    std::map<pid_t, const EnsembleRun*> running;
    std::size_t next = 0, n_done = 0;
    while (!running.empty() || (next < to_do.size() && !signals.interrupted())) {
        if (next < to_do.size() && !signals.interrupted() &&
            running.size() < static_cast<std::size_t>(options.n_at_once)) {
            running[start(scenario, *to_do[next], directory, options.force, signals.before())] = to_do[next];
            ++next;
            continue;
        }
        if (signals.next_interrupts())  // Ctrl-C reaches the runs by itself, SIGTERM may not
            for (const auto& [child, run] : running) kill(child, SIGTERM);
        int status = 0;
        for (pid_t ended; (ended = waitpid(-1, &status, WNOHANG)) > 0;) {
            const auto found = running.find(ended);
            if (found == running.end()) continue;
            const std::string& name = found->second->name;
            ++n_done;
            if (!options.quiet)
                std::fprintf(stderr, "run %zu of %zu: %s: %s\n", n_done, to_do.size(), name.c_str(),
                             outcome(directory / name, status, signals.interrupted()).c_str());
            running.erase(found);
        }
    }
    if (signals.interrupted()) std::fprintf(stderr, "interrupted; the same command goes on where it stopped\n");
    return !signals.interrupted();
}

}  // namespace knap
