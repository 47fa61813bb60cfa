#pragma once
// knap study: the same scenario at several steps, mesh sizes, schemes or seeds; values, errors, observed orders, cost.
//
//     plan_study     which runs          overrides of the scenario, one set a run
//     do_runs        child processes     finished runs are kept
//     RunResult      what came of a run  from its run.json and histories
//     judge_study    errors and orders   or statistics over seeds
//     tables and figures
#include "app/convergence.hpp"
#include "app/run.hpp"
#include "app/run_batch.hpp"
#include "app/run_result.hpp"

#include <cmath>
#include <map>
#include <optional>

namespace knap {

/// `overrides` as with --set. The study is in the scenario's [study], or all defaults.
ExitCode study_scenario(const std::string& scenario, const std::vector<std::string>& overrides, const BatchOptions& command);

struct StudyRun : BatchRun {
    std::size_t line = 0;
    double level = 1;
    std::uint64_t seed = 1;
    double size = 0;                     // [m] smallest wanted edge; 0 for a mesh that is read
};

struct StudyPlan {
    StudyOptions options;
    std::string name, title;
    std::vector<StudyRun> runs;  // by line, level, seed
};

/// Throws UserError with what is wrong in the scenario or in what the study sets.
StudyPlan plan_study(const std::string& scenario, const std::vector<std::string>& overrides);

/// Judgement of one quantity, arrays per run.
struct StudyErrors {
    double reference = NAN;
    bool exact = false;                 // known beforehand; else from the finest run
    std::size_t reference_run = 0;      // that one; beyond the last if exact
    bool relative = true;               // errors are over the scale or the reference; else in the unit of the quantity, since the reference is 0
    std::vector<double> error, order;   // the order: from the run before to this one, where the line converges
    std::vector<std::vector<double>> gaps;  // per line: what orders are judged by, errors or differences between neighbours
    std::vector<Trend> trend;               // per line: of these
    std::vector<double> fitted;             // order, per line; NaN where they do not fall
    std::vector<std::optional<double>> extrapolated, extrapolated_order;  // per line; only where the orders are clean
};

/// A study with all that is known of it.
struct Study {
    StudyPlan plan;
    std::vector<RunResult> results;  // per run
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
