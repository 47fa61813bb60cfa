#pragma once
// The directory of a run: reserved before anything is computed, never overwritten without --force, complete and movable
// afterwards.
//
//     announce   where nothing is: log.txt, run.json "starting" and report.html; what does not begin removes them
//     look       what is there?            a refusal changes nothing
//     lock       log.txt                   from here on no other process uses the directory
//     look       again, under the lock
//     start      run.json "starting", the first files, remove the rest of an earlier run, run.json "running"
//
// The directory that the user named keeps its identity: mount point, link target, owner and mode. A run that is killed
// at any moment leaves it either as good as empty or with a run.json of its state, and the same command continues.
#include "base/appended_file.hpp"
#include "record/run_record.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace knap {

/// A directory reserved for this process; leaves no trace in it. The system releases the lock when the process ends.
class DirectoryLock {
public:
    /// Throws UserError where another process has it, or it cannot be opened.
    explicit DirectoryLock(const std::filesystem::path& directory);
    ~DirectoryLock();
    DirectoryLock(const DirectoryLock&) = delete;
    DirectoryLock& operator=(const DirectoryLock&) = delete;

private:
    int file_;
};

/// log.txt of a run, locked: its holder is the only process that writes into the directory. Throws UserError where
/// another process has this run, or the file cannot be opened.
AppendedFile open_log(const std::filesystem::path& path);
/// Whether one has; a run that was killed says for ever in its run.json that it is running.
bool has_process(const std::filesystem::path& directory);

/// Names and texts of the files with which a run starts, besides its run.json.
using FirstFiles = std::vector<std::pair<std::string, std::string>>;

class RunDirectory {
public:
    explicit RunDirectory(const std::filesystem::path& path)
        : directory_(path.has_filename() ? path : path.parent_path()) {}
    ~RunDirectory();
    RunDirectory(const RunDirectory&) = delete;
    RunDirectory& operator=(const RunDirectory&) = delete;

    /// Writes report.html where no run is, for who waits for a mesh; without a word where that is not possible.
    void announce(const std::string& page, const RunRecord& record);

    /// Reserves the directory for a run that starts with these files. The same run that was not completed continues, or
    /// starts again where it has no checkpoint yet. Anything else in the directory is refused (UserError) unless
    /// `force`, and even then it must be an earlier run (with a run.json, or the same resolved.toml) that is not under
    /// way. Only files and directories with the names that runs use are removed. `shorter`: first files of a run with
    /// an earlier end that this one may continue; they are then replaced by `files`. `page`: report.html of a run that
    /// starts, in place of an earlier one, which a browser may show; "": none.
    void start(const FirstFiles& files, const RunRecord& record, bool force,
               const std::optional<FirstFiles>& shorter = std::nullopt, const std::string& page = "");

    bool resumes() const { return resumes_; }  // from a checkpoint
    AppendedFile& log() { return *log_; }

private:
    std::filesystem::path directory_;
    std::filesystem::path made_;  // the outermost directory that was made for the announcement
    std::optional<AppendedFile> log_;
    bool announced_ = false, resumes_ = false;
};

/// Whether a run reserved this directory, or was about to, and was stopped before its first files existed: any run may
/// start in it.
bool never_began(const std::filesystem::path& directory, const EarlierRecord& record);

/// Whether there is a file of exactly these bytes.
bool is_file_of(const std::filesystem::path& path, const std::string& text);

/// Whether a directory contains only files of these names, or does not exist. Throws UserError where it cannot be read.
bool holds_only(const std::filesystem::path& directory, const std::vector<std::string>& names);

}  // namespace knap
