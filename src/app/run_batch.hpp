#pragma once
// Many runs of one scenario, each a process of its own in a directory of its own; what is there is kept.
#include "app/directory_lock.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace knap {

struct BatchOptions {
    std::filesystem::path output;  // empty: a default by the scenario's name
    int n_at_once = 1;             // runs at the same time
    bool force = false;            // repeat what is there
    bool quiet = false;
};

/// A scenario with overrides.
struct BatchRun {
    std::string name;                    // of the directory
    std::vector<std::string> overrides;  // --set
    std::string resolved;                // the scenario as it will be; a directory with another one holds another run
};

/// Letters, digits, - and . of a text, with _ between: for names of files.
std::string plain_name(const std::string& text);

/// Makes the directory of a `what` where there is none, for this process alone. Throws UserError where another process has it, it cannot be made, or it holds
/// anything but an earlier `what` ("study": it has a study.toml).
DirectoryLock take_batch_directory(const std::filesystem::path& directory, const std::string& what);

/// Writes the scenario into it, and makes runs/. Throws UserError where it cannot be made.
void begin_batch(const std::filesystem::path& directory, const std::string& what, const std::string& scenario);

/// Throws UserError where two runs would share a directory.
void check_names(const std::vector<const BatchRun*>& runs, const std::string& note);

/// The runs that are not there yet, or all of them. Throws UserError when a directory holds something else, except by `force`.
std::vector<const BatchRun*> runs_to_do(const std::vector<const BatchRun*>& runs, const std::filesystem::path& directory, bool force);

/// What comes after `knap` on the command line of a run in a directory of `place`.
void append_arguments(const std::string& scenario, const BatchRun& run, const std::filesystem::path& place, bool force, std::vector<std::string>& words);

/// Does them; false when interrupted, and said so.
bool do_runs(const std::string& scenario, const std::vector<const BatchRun*>& to_do, const std::filesystem::path& directory, const BatchOptions& options);

template <class Runs>
std::vector<const BatchRun*> batch_of(const Runs& runs) {
    std::vector<const BatchRun*> batch;
    for (const BatchRun& run : runs) batch.push_back(&run);
    return batch;
}

}  // namespace knap
