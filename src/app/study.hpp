#pragma once
// knap study: the same scenario at several steps, mesh sizes, schemes or seeds; values, errors, observed orders, cost.
//
//     plan_study     which runs          overrides of the scenario, one set a run
//     do_runs        child processes     finished runs are kept
//     StudyResult    what came of a run  from its run.json and histories
//     judge_study    errors and orders   or statistics over seeds
//     tables and figures
#include "app/run.hpp"

#include <cmath>
#include <map>
#include <optional>

namespace knap {

struct StudyCommand {
    std::filesystem::path output;  // empty: studies/<name>
    int n_at_once = 1;             // runs at the same time
    bool force = false;            // repeat what is there
    bool quiet = false;
};

/// `overrides` as with --set. The study is in the scenario's [study], or all defaults.
ExitCode study_scenario(const std::string& scenario, const std::vector<std::string>& overrides, const StudyCommand& command);

/// A run of a study: a scenario with overrides, in a directory of its own.
struct StudyRun {
    std::size_t line = 0;
    double level = 1;
    std::uint64_t seed = 1;
    std::string name;                    // of the directory
    std::vector<std::string> overrides;  // --set
    std::string resolved;                // the scenario as it will be; a directory with another one holds another run
    double size = 0;                     // [m] smallest wanted edge; 0 for a mesh that is read
};

struct StudyPlan {
    StudyOptions options;
    std::string name, title;
    std::vector<StudyRun> runs;  // by line, level, seed
};

/// Letters, digits, - and . of a text, with _ between: for names of files.
std::string plain_name(const std::string& text);

/// Throws UserError with what is wrong in the scenario or in what the study sets.
StudyPlan plan_study(const std::string& scenario, const std::vector<std::string>& overrides);

/// The runs that are not there yet, or all of them. Throws UserError when a directory holds something else, except by `force`.
std::vector<const StudyRun*> runs_to_do(const StudyPlan& plan, const std::filesystem::path& directory, bool force);

/// Does them; false when interrupted.
bool do_runs(const std::string& scenario, const std::vector<const StudyRun*>& to_do, const std::filesystem::path& directory, const StudyCommand& command);

/// What came of a run.
struct StudyResult {
    std::string status;  // done, failed, refused (before it began)
    std::string reason;
    std::string bulk, cohesion;
    bool gates_hold = true;
    double triangles = 0, steps = 0, n_cuts = 0, linear_solves = 0, factorisations = 0;
    double step = NAN;            // [s] the largest, as planned
    double cpu = NAN;             // [s] processor time without output
    std::vector<double> values;   // per quantity
};
StudyResult read_result(const std::filesystem::path& run, const std::vector<StudyQuantity>& quantities);

/// Judgement of one quantity, arrays per run.
struct StudyErrors {
    double reference = NAN;
    bool exact = false;                 // known beforehand; else from the finest run
    std::size_t reference_run = 0;      // that one; beyond the last if exact
    std::vector<double> error, order;   // the order: from the run before to this one
    std::vector<double> fitted;         // order, per line
    std::vector<std::optional<double>> extrapolated, extrapolated_order;  // per line; only where the orders are clean
};

/// A study with all that is known of it.
struct Study {
    StudyPlan plan;
    std::vector<StudyResult> results;  // per run
    std::vector<StudyErrors> errors;   // per quantity
    std::vector<std::size_t> runs_of(std::size_t line) const;  // from coarse to fine
    std::vector<double> h(std::size_t line) const;             // of these runs: what orders refer to; [s] or a multiple of the sizes
    bool is_statistics() const { return plan.options.n_seeds > 0; }
};
void judge_study(Study& study);

/// What is printed, and study.csv, study.md.
std::string study_text(const Study& study);
std::string study_csv(const Study& study);
std::string study_markdown(const Study& study);
std::string statistics_csv(const Study& study);

/// Draws the figures; returns their files.
std::vector<std::filesystem::path> draw_study(const Study& study, const std::filesystem::path& directory);

}  // namespace knap
