// Each run is a process of its own: its processor time and memory are its own, and `n_at_once` go side by side.
#include "app/run_batch.hpp"

#include "app/checkpoint.hpp"
#include "app/interrupt.hpp"
#include "app/read_run.hpp"
#include "app/run_directory.hpp"
#include "app/run_json.hpp"
#include "app/run_result.hpp"
#include "base/error.hpp"
#include "base/whole_file.hpp"

#include <nlohmann/json.hpp>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cctype>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <map>
#include <set>
#include <sstream>

namespace knap {
namespace {

namespace fs = std::filesystem;

/// SIGINT, SIGTERM, SIGHUP and the end of a run wait until they are asked for.
class HeldSignals {
public:
    HeldSignals() {
        std::signal(SIGCHLD, SIG_DFL);
        sigemptyset(&held_);
        for (const int which : {SIGINT, SIGTERM, SIGCHLD}) sigaddset(&held_, which);
        if (!ignores_hangup()) sigaddset(&held_, SIGHUP);  // a signal that is held is not ignored
        sigprocmask(SIG_BLOCK, &held_, &before_);
    }
    /// What comes again after the first is of no interest until all is over.
    ~HeldSignals() {
        if (interrupted_)
            for (const int which : {SIGINT, SIGTERM, SIGHUP}) std::signal(which, SIG_IGN);
        sigprocmask(SIG_SETMASK, &before_, nullptr);
    }
    /// Waits for one; true for the first that is to end all.
    bool next_interrupts() {
        const int which = sigwaitinfo(&held_, nullptr);
        const bool first = (which == SIGINT || which == SIGTERM || which == SIGHUP) && !interrupted_;
        interrupted_ = interrupted_ || first;
        return first;
    }
    bool interrupted() const { return interrupted_; }
    const sigset_t& before() const { return before_; }  // for the runs

private:
    sigset_t held_, before_;
    bool interrupted_ = false;
};

enum class Found { nothing, finished, unfinished, another_run, no_run };

/// What is in the directory of a run from earlier. A failure would only be repeated, so it counts as finished.
Found found_in(const fs::path& run, const std::string& resolved) {
    std::error_code error;
    const bool any = fs::exists(run, error) && !fs::is_empty(run, error);
    if (!any) return Found::nothing;
    const EarlierRecord record = earlier_record(run);
    if (never_began(run, record)) return Found::unfinished;
    if (!is_file_of(run / "resolved.toml", resolved)) return record.is_of_a_run ? Found::another_run : Found::no_run;
    return record.status == "done" || (record.status == "failed" && !record.output_failed) ? Found::finished : Found::unfinished;
}

/// The file that takes what a run says. Never waits, as for the reader of a pipe.
int open_log(const fs::path& path) {
    const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_NONBLOCK | O_CLOEXEC, 0666);
    if (file < 0) throw OutputError("cannot write " + path.string() + ": " + std::strerror(errno));
    return file;
}

/// knap run SCENARIO ... with its output in a file. One that was interrupted goes on, if this program can.
pid_t start(const std::string& scenario, const BatchRun& run, const fs::path& directory, bool force, const sigset_t& signals) {
    std::vector<std::string> words{"knap"};
    append_arguments(scenario, run, directory, force || !Checkpoints::usable_in(directory / run.name), words);
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const int log = open_log(directory / (run.name + ".log"));
    const pid_t batch = getpid(), child = fork();
    if (child == 0) {
        // when the batch is gone, even by SIGKILL, the run ends as by Ctrl-C: an orphan would keep its directory from the next batch
        if (prctl(PR_SET_PDEATHSIG, SIGTERM) != 0 || getppid() != batch) _exit(127);
        sigprocmask(SIG_SETMASK, &signals, nullptr);
        if (dup2(log, STDOUT_FILENO) >= 0 && dup2(log, STDERR_FILENO) >= 0) execv("/proc/self/exe", arguments.data());
        _exit(127);
    }
    close(log);
    if (child < 0) throw SimulationError(std::string("cannot start a run: ") + std::strerror(errno));
    return child;
}

/// What became of a run that ended with this status, as of wait().
std::string outcome(const fs::path& run, int ended, bool interrupted) {
    if (!fs::exists(run / "run.json")) return interrupted ? "not begun" : "refused";
    const auto record = read_run_json(run);
    const std::string status = record.value("status", "");
    std::ostringstream text;
    const bool is_whole = !is_under_way(status) && !record.value("output_failed", false);  // the record, which counts no steps where they could not be written
    if (is_whole) text << status << ", " << record.value("steps", 0LL) << " steps, " << record.value("cpu_s", 0.0) << " s";
    else if (WIFSIGNALED(ended)) text << "killed by signal " << WTERMSIG(ended);
    else text << "failed: " << said_in(run.string() + ".log");
    return text.str();
}

void make_directory(const fs::path& directory) {
    std::error_code error;
    if (fs::create_directories(directory, error); error) throw UserError("cannot-write", "cannot make `" + directory.string() + "`: " + error.message());
}

}  // namespace

std::string plain_name(const std::string& text) {
    std::string name;
    for (const char c : text) {
        const bool plain = std::isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '-';
        if (plain) name += c;
        else if (!name.empty() && name.back() != '_') name += '_';
    }
    return name;
}

DirectoryLock take_batch_directory(const fs::path& directory, const std::string& what) {
    std::error_code none;
    if (!holds_only(directory, {what + ".toml.part"}) && !fs::exists(directory / (what + ".toml"), none))
        throw UserError("not-a-" + what, "`" + directory.string() + "` was not made by knap " + what + " (no " + what + ".toml), so it is left alone",
                        "choose another directory with --output");
    make_directory(directory);
    return DirectoryLock(directory);
}

void begin_batch(const fs::path& directory, const std::string& what, const std::string& scenario) {
    write_whole_file(directory / (what + ".toml"), scenario);  // first, so that it can be told from a directory of someone else
    make_directory(directory / "runs");
}

void check_names(const std::vector<const BatchRun*>& runs, const std::string& note) {
    std::set<std::string> names;
    for (const BatchRun* run : runs)
        if (!names.insert(run->name).second) throw UserError("duplicate-name", "two runs would be called `" + run->name + "`", note);
}

std::vector<const BatchRun*> runs_to_do(const std::vector<const BatchRun*>& runs, const fs::path& directory, bool force) {
    std::vector<const BatchRun*> to_do;
    for (const BatchRun* run : runs) {
        const Found found = found_in(directory / run->name, run->resolved);
        const std::string there = "`" + (directory / run->name).string() + "`";
        if (found == Found::no_run)
            throw UserError("not-a-run", there + " was not made by knap (it has no run.json of a run), nothing was run",
                            "choose another directory with --output, or delete this one by hand");
        if (found == Found::another_run && !force)
            throw UserError("runs-exist", there + " is not one of these runs as they are now, nothing was run",
                            "choose another directory with --output, or replace the old runs with --force");
        if (found != Found::finished || force) to_do.push_back(run);
    }
    return to_do;
}

void append_arguments(const std::string& scenario, const BatchRun& run, const fs::path& place, bool force, std::vector<std::string>& words) {
    words.insert(words.end(), {"run", scenario, "-j", "1", "-q", "-o", (place / run.name).string()});
    if (force) words.emplace_back("--force");
    for (const std::string& set : run.overrides) words.insert(words.end(), {"-s", set});
}

bool do_runs(const std::string& scenario, const std::vector<const BatchRun*>& to_do, const fs::path& directory, const BatchOptions& options) {
    HeldSignals signals;
    std::map<pid_t, const BatchRun*> running;
    std::size_t next = 0, n_done = 0;
    int status = 0;  // of the run that ended
    while (!running.empty() || (next < to_do.size() && !signals.interrupted())) {
        if (next < to_do.size() && !signals.interrupted() && running.size() < static_cast<std::size_t>(options.n_at_once)) {
            running[start(scenario, *to_do[next], directory, options.force, signals.before())] = to_do[next];
            ++next;
            continue;
        }
        if (signals.next_interrupts())  // Ctrl-C reaches the runs by itself, SIGTERM may not
            for (const auto& [child, run] : running) kill(child, SIGTERM);
        for (pid_t ended; (ended = waitpid(-1, &status, WNOHANG)) > 0;) {
            const auto found = running.find(ended);
            if (found == running.end()) continue;
            ++n_done;
            const std::string& name = found->second->name;
            const std::string became = outcome(directory / name, status, signals.interrupted());
            if (!options.quiet) std::fprintf(stderr, "run %zu of %zu: %s: %s\n", n_done, to_do.size(), name.c_str(), became.c_str());
            running.erase(found);
        }
    }
    if (signals.interrupted()) std::fprintf(stderr, "interrupted; the same command goes on where it stopped\n");
    return !signals.interrupted();
}

}  // namespace knap
