#pragma once
// The directory of a run: taken before anything is computed, never overwritten unless told to, complete and movable afterwards.
//
//     look       what is there?            a refusal touches nothing
//     lock       log.txt                   from here on no other process is in it
//     look       another may have been faster
//     begin      run.json "starting", the first files, the rest of an earlier run away, run.json "running"
//
// The directory stays the one that the user named: a mount point, behind a link, with its owner and mode. Killed at any moment it is as good as empty,
// or its run.json says what it is, and the same command goes on.
#include "app/run/run_json.hpp"
#include "app/run/run_log.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace knap {

/// Name and text of the files that a run begins with, beside its run.json.
using FirstFiles = std::vector<std::pair<std::string, std::string>>;

class RunDirectory {
public:
    /// Takes the directory for a run that begins with these files. The same run that did not come to its end goes on, or begins again where it has no
    /// checkpoint yet. Anything else that is there is refused (UserError) unless `force`, and even then it must be an earlier run (it has a run.json, or
    /// the same resolved.toml), and none under way. What is cleared are files and directories of the names that runs give; whatever else lies there stays.
    /// `shorter`: what a run with an earlier end began with that this one may go on with; its files are then replaced by these.
    RunDirectory(const std::filesystem::path& directory, const FirstFiles& files, const RunRecord& record, bool force,
                 const std::optional<FirstFiles>& shorter = std::nullopt);

    bool resumes() const { return resumes_; }  // from a checkpoint
    RunLog& log() { return *log_; }

private:
    std::optional<RunLog> log_;
    bool resumes_ = false;
};

/// Whether a run took this directory, or was about to, and was stopped before its first files were there: any run may begin in it.
bool never_began(const std::filesystem::path& directory, const EarlierRecord& record);

/// Whether there is a file of exactly these bytes.
bool is_file_of(const std::filesystem::path& path, const std::string& text);

/// Whether there is nothing in a directory but files of these names, or no directory at all. Throws UserError where that cannot be seen.
bool holds_only(const std::filesystem::path& directory, const std::vector<std::string>& names);

}  // namespace knap
