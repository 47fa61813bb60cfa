#include "app/run/run_directory.hpp"

#include "app/run/checkpoint.hpp"
#include "base/error.hpp"
#include "base/whole_file.hpp"

#include <algorithm>
#include <set>
#include <sstream>

namespace knap {

namespace fs = std::filesystem;

namespace {

UserError cannot(const std::string& what, const fs::path& path, const std::error_code& error) {
    return UserError("cannot-write", "cannot " + what + " `" + path.string() + "`: " + error.message());
}

/// Nothing, or what is left of a start that was killed before its run.json was there; on a volume of its own the system has a directory, too.
bool is_vacant(const fs::path& directory) {
    std::error_code none;
    const std::uintmax_t said = fs::file_size(directory / "log.txt", none);
    return holds_only(directory, {"log.txt", "run.json.part", "lost+found"}) && (none || said == 0);
}

/// What runs make, whichever; figures and frames are in directories of their own.
bool is_made_by_runs(fs::path name) {
    if (name.extension() == ".part") name = name.stem();
    static const std::set<fs::path> names{"run.json",   "log.txt",       "scenario.toml", "resolved.toml",     "mesh.msh", "energy.csv", "cracks.csv", "reactions.csv",
                                          "probes.csv", "breaks.csv",    "fragments.csv", "arms.csv", "stress_strain.csv", "run.pvd",  "fields",     "figures",    "lcp",
                                          "checkpoint", "checkpoint.previous", "checkpoint.end"};
    return names.contains(name);
}

/// Throws UserError where a run would wait for the reader of a pipe, or write into a device.
void refuse_what_is_no_file(const fs::path& directory) {
    std::error_code error;
    for (auto at = fs::recursive_directory_iterator(directory, error); !error && at != end(at); at.increment(error)) {
        if (at.depth() == 0 && !is_made_by_runs(at->path().filename())) at.disable_recursion_pending();
        else if (fs::is_other(at->status(error)))
            throw UserError("not-a-file", "`" + at->path().string() + "` is a pipe, socket or device, and a run writes a file of this name",
                            "remove it, or choose another directory with --output");
    }
}

/// Whether a run stands there that began with this scenario, however that was written: what it resolves to counts, and the files that it reads.
bool began_with(const fs::path& directory, const FirstFiles& files) {
    return std::all_of(files.begin(), files.end(), [&](const auto& file) { return file.first == "scenario.toml" || is_file_of(directory / file.first, file.second); });
}

/// What this program resolves of this scenario, to the byte: that was written by a run, whatever else of it was lost.
bool is_resolved_as(const fs::path& directory, const FirstFiles& files) {
    return std::any_of(files.begin(), files.end(), [&](const auto& file) { return file.first == "resolved.toml" && is_file_of(directory / file.first, file.second); });
}

/// Whether the same command would go on with the run that stands there, or begin it again.
bool is_unfinished(const fs::path& directory, const EarlierRecord& record) {
    return Checkpoints::exist_in(directory) || record.status == "running" || record.output_failed;
}

/// Where two resolved scenarios, which have a key a line, part from each other; empty where they do not.
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
    const auto resolved = std::find_if(files.begin(), files.end(), [](const auto& file) { return file.first == "resolved.toml"; });
    const fs::path old = directory / "resolved.toml";
    const std::string run = "`" + directory.string() + "` holds an unfinished run of another scenario, nothing was run", other = "choose another directory with --output";
    std::error_code none;
    if (resolved == files.end() || !fs::is_regular_file(old, none)) return UserError("run-exists", run, other + "; --force throws the unfinished run away");
    return UserError("run-exists", run + first_difference(read_whole_file(old), resolved->second),
                     other + "; `knap run " + old.string() + " -o " + directory.string() + "` goes on with the unfinished run, --force throws it away");
}

/// Whether this run goes on there; else it begins. Throws UserError where it may do neither.
bool goes_on(const fs::path& directory, const FirstFiles& files, bool force, const std::optional<FirstFiles>& shorter) {
    refuse_what_is_no_file(directory);
    const EarlierRecord record = earlier_record(directory);
    if (never_began(directory, record)) return false;
    const bool is_run = record.is_of_a_run || is_resolved_as(directory, files);
    if (force && !is_run)
        throw UserError("not-a-run", "`" + directory.string() + "` was not made by knap (it has no run.json of a run), so --force does not clear it",
                        "choose another directory with --output, or delete this one by hand");
    if (force) return false;
    if (record.is_of_a_run && shorter && began_with(directory, *shorter) && (Checkpoints::exist_in(directory) || Checkpoints::end_exists_in(directory))) return true;
    if (is_run && is_unfinished(directory, record)) {
        if (!began_with(directory, files)) throw unfinished_run_of_another(directory, files);
        return Checkpoints::exist_in(directory);
    }
    throw UserError("run-exists", "`" + directory.string() + "` exists already, nothing was run",
                    std::string("choose another directory with --output") + (is_run ? ", or replace the old run with --force" : "") +
                        (Checkpoints::end_exists_in(directory) ? "; the same scenario with a later time.end goes on with it" : ""));
}

void write_record(const fs::path& directory, RunRecord record, const std::string& status) {
    record.status = status;
    write_whole_file(directory / "run.json", run_json(record));
}

/// While all of an earlier run is still there, so that nothing is lost where they cannot be written.
void write_first(const fs::path& directory, const FirstFiles& files, const RunRecord& record) {
    const bool vacant = is_vacant(directory);
    try {
        write_record(directory, record, "starting");
        for (const auto& [name, text] : files) write_whole_file(directory / name, text);
    } catch (const OutputError& error) {
        if (vacant) throw;
        throw OutputError(std::string(error.what()) + "; files of the earlier run are still there. When that is mended, or if it is room that is wanted and you delete `" +
                          directory.string() + "` by hand, the same command starts this one");
    }
}

/// What an earlier run made, but for its record, its log and the files that this one began with.
void clear(const fs::path& directory, const FirstFiles& kept) {
    std::set<fs::path> names{"run.json", "log.txt"};
    for (const auto& file : kept) names.insert(file.first);
    std::vector<fs::path> old;
    for (const fs::path& path : fs::directory_iterator(directory))
        if (is_made_by_runs(path.filename()) && !names.contains(path.filename())) old.push_back(path);
    std::error_code error;
    for (const fs::path& path : old)
        if (fs::remove_all(path, error); error) throw cannot("clear", path, error);
}

}  // namespace

bool never_began(const fs::path& directory, const EarlierRecord& record) { return is_vacant(directory) || (record.is_of_a_run && record.status == "starting"); }

bool is_file_of(const fs::path& path, const std::string& text) {
    std::error_code none;
    return fs::is_regular_file(path, none) && fs::file_size(path, none) == text.size() && read_whole_file(path) == text;
}

bool holds_only(const fs::path& directory, const std::vector<std::string>& names) {
    std::error_code error;
    const fs::file_status status = fs::status(directory, error);
    if (status.type() == fs::file_type::not_found) {
        if (fs::is_symlink(fs::symlink_status(directory, error)))
            throw UserError("dangling-link", "`" + directory.string() + "` is a link to what is not there",
                            "make the directory that it leads to, or choose another one with --output");
        return true;
    }
    if (status.type() == fs::file_type::none) throw cannot("look into", directory, error);
    if (status.type() != fs::file_type::directory) return false;
    fs::directory_iterator entries(directory, error);
    if (error) throw cannot("look into", directory, error);
    return std::all_of(begin(entries), end(entries), [&](const fs::directory_entry& entry) {
        return std::find(names.begin(), names.end(), entry.path().filename()) != names.end();
    });
}

RunDirectory::RunDirectory(const fs::path& directory, const FirstFiles& files, const RunRecord& record, bool force, const std::optional<FirstFiles>& shorter) {
    goes_on(directory, files, force, shorter);
    std::error_code error;
    if (fs::create_directories(directory, error); error) throw cannot("make", directory, error);
    log_.emplace(directory / "log.txt");
    resumes_ = goes_on(directory, files, force, shorter);
    if (!resumes_) {
        write_first(directory, files, record);
        clear(directory, files);
        log_->cut_to(0);
    }
    for (const char* part : {"fields", "figures"})
        if (fs::create_directories(directory / part, error); error) throw cannot("make", directory / part, error);
    if (resumes_ && !shorter) return;
    if (resumes_) {  // killed anywhere here, it is an unfinished run of the one scenario or the other
        Checkpoints::reopen_end(directory);
        for (const auto& [name, text] : files) write_whole_file(directory / name, text);
    }
    write_record(directory, record, "running");
}

}  // namespace knap
