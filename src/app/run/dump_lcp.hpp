#pragma once
// knap run --dump-lcp: stores the complementarity problems of selected steps for `knap lcp` and other programs.
#include "model/state.hpp"
#include "stepper/common/step_scheme.hpp"

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace knap {

/// Numbers of steps, counted from 1.
class StepSelection {
public:
    /// "10", "10,20", "10:20" (every step from the first to the last), "10:5:40" (every fifth). Throws UserError.
    static StepSelection parse(const std::string& text);
    bool contains(std::int64_t step) const;
    /// The selected steps before `first` and after `last`, in the notation of parse().
    std::string outside(std::int64_t first, std::int64_t last) const;
    bool empty() const { return ranges_.empty(); }

private:
    std::vector<std::array<std::int64_t, 3>> ranges_;  // first, stride, last
};

/// Throws UserError for the explicit bulk, which has no problem of the whole step, and where the matrix would be too
/// large to store.
void check_dump(const Model& model, const SchemeOptions& scheme);

/// Writes <directory>/step_000010.L.mtx and .q.mtx of a step of size h [s] from `start`. Returns a line for the log.
/// Throws SimulationError.
std::string dump_lcp(const Model& model, const State& start, double h, const SchemeOptions& scheme,
                     const std::filesystem::path& directory);

}  // namespace knap
