#pragma once
// A run that continues a finished or unfinished run of the same scenario with an earlier time.end.
//
// Defaults that follow from time.end keep the values of the first part: an automatic step or one in CFL (equal steps
// that land on the first time.end), output.every and output.history_every. The resolved scenario contains them, and
// running it at once gives the same bits. Figures and lines at the end, and the summary, are those of the later end.
#include "app/run/run_directory.hpp"
#include "scenario/read_scenario.hpp"

#include <filesystem>
#include <optional>
#include <string>

namespace knap {

struct Continuation {
    ReadResult read;                                        // with the values kept from the first part
    std::optional<FirstFiles> first_files_of_shorter = {};  // of that run, where this one has a later end
    std::string text = {};                                  // for the log; empty where nothing is kept
};

/// `read` unchanged where the directory has no such run. Throws UserError where it has one that cannot be continued.
Continuation continuation_of(const ReadResult& read, const Model& model, const std::filesystem::path& directory);

/// The resolved scenario as it is stored in a run directory, where the files that it reads have fixed names (mesh.msh).
std::string resolved_for_run(const ReadResult& read);

}  // namespace knap
