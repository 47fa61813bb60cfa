#include "app/run/run_directory.hpp"

#include "app/run/checkpoint.hpp"
#include "base/error.hpp"
#include "base/whole_file.hpp"
#include "output/history_csv.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <set>
#include <sstream>

namespace knap {

namespace fs = std::filesystem;

namespace {

std::error_code last_error() { return {errno, std::generic_category()}; }

UserError cannot(const std::string& what, const fs::path& path, const std::error_code& error) {
    return UserError("cannot-write", "cannot " + what + " `" + path.string() + "`: " + error.message());
}

/// Locks an open file until it is closed. Throws UserError where another process has locked it.
void lock_or_refuse(int file, const fs::path& directory) {
    if (flock(file, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;  // other errors: no locks there
    throw UserError("run-busy", "another process is running in `" + directory.string() + "`",
                    "wait for it, or choose another directory with --output");
}

/// Empty, or the remains of a start that was killed before its run.json existed; a volume has a lost+found.
bool is_vacant(const fs::path& directory) {
    std::error_code none;
    const std::uintmax_t log_size = fs::file_size(directory / "log.txt", none);
    return holds_only(directory, {"log.txt", "run.json.part", "lost+found"}) && (none || log_size == 0);
}

/// Whether a run of any kind writes a file or directory of this name.
bool is_made_by_runs(fs::path name) {
    if (name.extension() == ".part") name = name.stem();
    static const std::set<fs::path> names{
        "run.json",          "report.html",     "log.txt", "scenario.toml", "resolved.toml", "mesh.msh",
        "arms.csv",          "run.pvd",         "fields",  "figures",       "lcp",           newest_checkpoint,
        previous_checkpoint, checkpoint_of_end, "states",  "start.state"};
    if (std::ranges::any_of(history_files, [&](const HistoryFile& file) { return name == file.name; })) return true;
    return names.contains(name);
}

/// Throws UserError where a run would wait for the reader of a pipe, or write into a device.
void refuse_special_files(const fs::path& directory) {
    std::error_code error;
    for (auto at = fs::recursive_directory_iterator(directory, error); !error && at != end(at); at.increment(error)) {
        if (at.depth() == 0 && !is_made_by_runs(at->path().filename())) at.disable_recursion_pending();
        else if (fs::is_other(at->status(error)))
            throw UserError(
                "not-a-file",
                "`" + at->path().string() + "` is a pipe, socket or device, and a run writes a file of this name",
                "remove it, or choose another directory with --output");
    }
}

/// Whether a run in the directory started with this scenario, whatever its text: its resolved form and the files that
/// it reads count.
bool began_with(const fs::path& directory, const FirstFiles& files) {
    return std::ranges::all_of(files, [&](const auto& file) {
        return file.first == "scenario.toml" || is_file_of(directory / file.first, file.second);
    });
}

/// The text of the resolved scenario among the first files; null where there is none.
const std::string* resolved_in(const FirstFiles& files) {
    const auto found = std::ranges::find(files, "resolved.toml", &FirstFiles::value_type::first);
    return found == files.end() ? nullptr : &found->second;
}

/// The first line in which two resolved scenarios differ (a key per line); empty where none does.
std::string first_difference(const std::string& there, const std::string& here) {
    std::istringstream old_lines(there), new_lines(here);
    std::string table, was, is;
    do {
        if (was.starts_with('[')) table = " in " + was;
        const bool old_ended = !std::getline(old_lines, was), new_ended = !std::getline(new_lines, is);
        if (old_ended && new_ended) return "";
    } while (was == is);
    return "; they differ first" + table + ": `" + was + "` there, `" + is + "` here";
}

UserError unfinished_run_of_another(const fs::path& directory, const FirstFiles& files) {
    const std::string *resolved = resolved_in(files),
                      run = "`" + directory.string() + "` holds an unfinished run of another scenario, nothing was run",
                      other = "choose another directory with --output";
    const fs::path old = directory / "resolved.toml";
    std::error_code none;
    if (resolved == nullptr || !fs::is_regular_file(old, none))
        return UserError("run-exists", run, other + "; --force deletes the unfinished run");
    std::string difference = first_difference(read_whole_file(old), *resolved);
    for (const auto& [name, content] : files)  // that the scenario reads
        if (difference.empty() && name != "scenario.toml" && !is_file_of(directory / name, content))
            difference = "; `" + name + "` has changed since";
    return UserError("run-exists", run + difference,
                     other + "; `knap run " + old.string() + " -o " + directory.string() +
                         "` continues the unfinished run, --force deletes it");
}

/// Whether this run continues one in the directory; else it starts. Throws UserError where it may do neither.
bool continues_in(const fs::path& directory, const FirstFiles& files, bool force,
                  const std::optional<FirstFiles>& shorter) {
    refuse_special_files(directory);
    const EarlierRecord record = earlier_record(directory);
    if (never_began(directory, record)) return false;
    const std::string* resolved = resolved_in(files);  // written by a run, whatever else of it is lost
    const bool is_run =
        record.is_of_a_run || (resolved != nullptr && is_file_of(directory / "resolved.toml", *resolved));
    if (force && !is_run)
        throw UserError("not-a-run",
                        "`" + directory.string() +
                            "` was not made by knap (it has no run.json of a run), so --force does not clear it",
                        "choose another directory with --output, or delete this one by hand");
    if (force) return false;
    const bool checkpoint = Checkpoints::exist_in(directory), end = Checkpoints::end_exists_in(directory);
    if (record.is_of_a_run && shorter && began_with(directory, *shorter) && (checkpoint || end)) return true;
    if (is_run && (checkpoint || record.status == "running" || record.output_failed)) {
        if (!began_with(directory, files)) throw unfinished_run_of_another(directory, files);
        return checkpoint;
    }
    throw UserError("run-exists", "`" + directory.string() + "` exists already, nothing was run",
                    std::string("choose another directory with --output") +
                        (is_run ? ", or replace the old run with --force" : "") +
                        (end ? "; the same scenario with a later time.end continues it" : ""));
}

void write_record(const fs::path& directory, RunRecord record, const std::string& status) {
    record.status = status;
    write_whole_file(directory / "run.json", run_json(record), true);
}

/// While the files of an earlier run still exist, so that nothing is lost where the new ones cannot be written.
void write_first(const fs::path& directory, bool vacant, const FirstFiles& files, const std::string& page,
                 const RunRecord& record) {
    try {
        write_record(directory, record, "starting");
        for (const auto& [name, text] : files) write_whole_file(directory / name, text);
        if (!page.empty()) write_whole_file(directory / "report.html", page);
    } catch (const OutputError& error) {
        if (vacant) throw;
        throw OutputError(
            std::string(error.what()) +
            "; files of the earlier run are still there. Once this is repaired, or once you have deleted `" +
            directory.string() + "` by hand to free space, the same command starts the run");
    }
}

/// Removes what an earlier run made, except its record, its log and the files with which this one started.
void clear(const fs::path& directory, const FirstFiles& kept, bool keeps_page) {
    std::set<fs::path> names{"run.json", "log.txt"};
    if (keeps_page) names.insert("report.html");
    for (const auto& file : kept) names.insert(file.first);
    std::vector<fs::path> old;
    for (const fs::path& path : fs::directory_iterator(directory))
        if (is_made_by_runs(path.filename()) && !names.contains(path.filename())) old.push_back(path);
    std::error_code error;
    for (const fs::path& path : old)
        if (fs::remove_all(path, error); error) throw cannot("clear", path, error);
}

}  // namespace

DirectoryLock::DirectoryLock(const fs::path& directory)
    : file_(open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
    if (file_ < 0) throw cannot("look into", directory, last_error());
    try {
        lock_or_refuse(file_, directory);
    } catch (...) {
        close(file_);
        throw;
    }
}

DirectoryLock::~DirectoryLock() { close(file_); }

AppendedFile open_log(const fs::path& path) {
    try {
        AppendedFile log(path);
        lock_or_refuse(log.descriptor(), path.parent_path());
        return log;
    } catch (const OutputError& error) {
        throw UserError("cannot-write", error.what());
    }
}

bool has_process(const fs::path& directory) {
    const int file = open((directory / "log.txt").c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0) return false;
    const bool is_locked = flock(file, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    close(file);
    return is_locked;
}

bool never_began(const fs::path& directory, const EarlierRecord& record) {
    return is_vacant(directory) || (record.is_of_a_run && record.status == "starting");
}

bool is_file_of(const fs::path& path, const std::string& text) {
    std::error_code none;
    return fs::is_regular_file(path, none) && fs::file_size(path, none) == text.size() && read_whole_file(path) == text;
}

bool holds_only(const fs::path& directory, const std::vector<std::string>& names) {
    std::error_code error;
    const fs::file_status status = fs::status(directory, error);
    if (status.type() == fs::file_type::not_found) {
        if (fs::is_symlink(fs::symlink_status(directory, error)))
            throw UserError("dangling-link",
                            "`" + directory.string() + "` is a link to a directory that does not exist",
                            "make the directory that it leads to, or choose another one with --output");
        return true;
    }
    if (status.type() == fs::file_type::none) throw cannot("look into", directory, error);
    if (status.type() != fs::file_type::directory) return false;
    fs::directory_iterator entries(directory, error);
    if (error) throw cannot("look into", directory, error);
    return std::all_of(begin(entries), end(entries), [&](const fs::directory_entry& entry) {
        return std::ranges::find(names, entry.path().filename().string()) != names.end();
    });
}

void RunDirectory::announce(const std::string& page, const RunRecord& record) try {
    refuse_special_files(directory_);
    if (!is_vacant(directory_)) return;
    for (fs::path at = directory_; !at.empty() && !fs::exists(at); at = at.parent_path()) made_ = at;
    fs::create_directories(directory_);
    log_.emplace(open_log(directory_ / "log.txt"));
    announced_ = true;
    write_record(directory_, record, "starting");
    write_whole_file(directory_ / "report.html", page);
} catch (const std::exception&) {
    // start() says why
}

RunDirectory::~RunDirectory() {
    std::error_code none;
    if (announced_)
        for (const char* name : {"report.html", "run.json", "log.txt"}) fs::remove(directory_ / name, none);
    for (fs::path at = directory_; !made_.empty() && fs::remove(at, none) && at != made_;) at = at.parent_path();
}

void RunDirectory::start(const FirstFiles& files, const RunRecord& record, bool force,
                         const std::optional<FirstFiles>& shorter, const std::string& page) {
    continues_in(directory_, files, force, shorter);
    std::error_code error;
    if (fs::create_directories(directory_, error); error) throw cannot("make", directory_, error);
    if (!log_) log_.emplace(open_log(directory_ / "log.txt"));
    resumes_ = continues_in(directory_, files, force, shorter);
    const bool vacant = std::exchange(announced_, false) || is_vacant(directory_);
    made_.clear();
    if (!resumes_) {
        write_first(directory_, vacant, files, page, record);
        clear(directory_, files, !page.empty());
        log_->truncate(0);
    }
    for (const char* part : {"fields", "figures"})
        if (fs::create_directories(directory_ / part, error); error) throw cannot("make", directory_ / part, error);
    if (resumes_ && !shorter) return;
    if (resumes_) {  // killed anywhere here, it is an unfinished run of the one scenario or the other
        Checkpoints::reopen_end(directory_);
        for (const auto& [name, text] : files) write_whole_file(directory_ / name, text);
    }
    write_record(directory_, record, "running");
}

}  // namespace knap
