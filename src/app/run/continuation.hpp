#pragma once
// A run that goes on with what stands in a directory: a finished or unfinished run of the same scenario with an earlier time.end.
//
// What follows from time.end stays that of the first part: the step where it is automatic or in CFL (equal steps that end at the first
// time.end), output.every and output.history_every where they are not given. The resolved scenario then says so, and run at once it gives the
// same bits. Tied to the end are the figures and lines of the end, and the summary: those are of the later one.
#include "app/run/run_directory.hpp"
#include "scenario/read_scenario.hpp"

#include <filesystem>
#include <optional>
#include <string>

namespace knap {

struct Continuation {
    ReadResult read;                  // with what it keeps of the first part
    std::optional<FirstFiles> of_run; // what that run began with, where this one has a later end
    std::string said;                 // for the log; empty without a later end
};

/// `read` as it is where nothing of the kind stands there. Throws UserError where it does but cannot be used.
Continuation continuation_of(const ReadResult& read, const Model& model, const std::filesystem::path& directory);

}  // namespace knap
