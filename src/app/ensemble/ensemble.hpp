#pragma once
// Many runs of one scenario: `knap study` (levels of refinement, schemes, seeds) and `knap sweep` (all combinations of
// values of keys and seeds).
//
//     plan_study, plan_sweep   the runs: overrides of the scenario; all are resolved before the first one starts
//     do_runs                  a process for each, several at a time; finished runs are kept
//     read_result              the numbers of each run, from its directory
//     judge_errors             of a study: errors, orders of convergence, extrapolation
//     overview, ..._csv        tables for people, of the runs, of statistics over the seeds
//     draw_ensemble            diagrams of a study, contact sheet of a sweep
#include "app/ensemble/run_result.hpp"
#include "app/ensemble/statistics.hpp"
#include "app/run/directory_lock.hpp"
#include "app/run/run.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace knap {

struct BatchOptions {
    std::filesystem::path output;  // empty: a default by the scenario's name
    int n_at_once = 1;             // runs at the same time
    bool force = false;            // repeat finished runs, replace those of another ensemble
    bool quiet = false;
    bool print_commands = false;   // instead of running: a command line for each run that is to be done
    std::string program = "knap";  // first word of these
};

/// One combination of values; its runs differ in the seed only.
struct Variant {
    std::string name;                    // for directories
    std::vector<std::string> values;     // per entry of Ensemble::keys
    std::vector<std::string> overrides;  // KEY=VALUE
    std::size_t line = 0;                // of a study
    double level = 1;                    // of a study
};

struct EnsembleRun {
    std::size_t variant = 0;
    std::uint64_t seed = 1;
    std::string name;  // of its directory
    std::vector<std::string> overrides;
    std::string resolved;  // the scenario as it will be; a directory with another one holds another run
    double mesh_size = 0;  // [m] the smallest requested; 0 for a mesh that is read
    RunResult result;
};

/// How one quantity converges along one line of a study.
struct LineOrder {
    std::vector<double>
        gaps;  // orders are judged by these: errors from an exact value, or differences between neighbours
    Trend trend = Trend::unknown;
    bool errors_grow = false;  // although differences fall: they change their sign
    double fitted = NAN;  // order; NaN where the gaps do not fall
    std::optional<Extrapolation> limit;
};

struct QuantityErrors {
    double reference = NAN;
    std::optional<std::size_t> reference_run;  // none: an exact value
    bool relative =
        true;  // errors are over the scale or the reference; else in the unit of the quantity, since the reference is 0
    std::vector<double> error, order;  // per run; the order from the run before to this one
    std::vector<LineOrder> lines;
};

struct Ensemble {
    std::string kind;  // "study" or "sweep"
    std::string name, title;
    std::string record;             // text of <kind>.toml
    std::vector<std::string> keys;  // that are varied; of a study "line" and "level"
    std::vector<Variant> variants;
    std::size_t n_seeds = 0;        // 0: the seed is not varied
    std::vector<EnsembleRun> runs;  // by variant, then by seed
    std::vector<StudyQuantity> quantities;
    StudyOptions study;                  // of a study
    std::vector<QuantityErrors> errors;  // per quantity, of a study with one seed
    FigureOptions sheet;                 // of a sweep: what its contact sheet shows

    bool is_study() const { return kind == "study"; }
    std::span<const EnsembleRun> runs_of(std::size_t variant) const;
    Spread spread(std::size_t variant, const std::function<double(const EnsembleRun&)>& number) const;
    Spread spread(std::size_t variant, std::size_t quantity) const;
    std::vector<std::size_t> variants_of(std::size_t line) const;  // from coarse to fine
    std::string caption(const EnsembleRun& run) const;             // "size 1 mm, seed 3"
};

// ---- plan

/// `overrides` as with --set; of a sweep KEY=VALUE,VALUE,... too. Both throw UserError with what is wrong in the
/// scenario or in any of its runs.
Ensemble plan_study(const std::string& scenario, const std::vector<std::string>& overrides);
Ensemble plan_sweep(const std::string& scenario, const std::vector<std::string>& overrides);

struct SweepKey {
    std::string key;
    std::vector<std::string> values;
};
/// "KEY=a,b" -> KEY and its values; commas in quotes and brackets are part of a value.
SweepKey sweep_key(const std::string& set);

/// "20" -> sweep.seeds=20, "3..20" -> seed=3, sweep.seeds=18; "" -> nothing. Throws UserError for anything else.
std::vector<std::string> seed_overrides(const std::string& text);

/// Letters, digits, - and . of a text, with _ between: for names of files.
std::string plain_name(const std::string& text);

/// For a shell: in quotes where it needs them.
std::string quoted_for_shell(const std::string& word);

// ---- processes

/// Makes the directory of an ensemble of this kind where there is none, for this process alone. Throws UserError where
/// another process has it, it cannot be made, or it holds anything but an earlier one (it has a <kind>.toml).
DirectoryLock take_directory(const std::filesystem::path& directory, const std::string& kind);

/// The runs that are not there yet, or all of them. Throws UserError when a directory holds something else, except by
/// `force`.
std::vector<const EnsembleRun*> runs_to_do(const std::vector<EnsembleRun>& runs, const std::filesystem::path& directory,
                                           bool force);

/// Words of the command line of a run in a directory of `place`.
std::vector<std::string> command_of(const std::string& program, const std::string& scenario, const EnsembleRun& run,
                                    const std::filesystem::path& place, bool force);

/// Returns false when interrupted, and says so.
bool do_runs(const std::string& scenario, const std::vector<const EnsembleRun*>& to_do,
             const std::filesystem::path& directory, const BatchOptions& options);

/// Does the runs that are to be done, judges and draws; or prints their command lines.
ExitCode run_ensemble(Ensemble ensemble, const std::string& scenario, const BatchOptions& options);

// ---- results

/// Fills Ensemble::errors from the results of the runs.
void judge_errors(Ensemble& study);

/// What is printed, and <kind>.md.
std::string overview(const Ensemble& ensemble);
/// <kind>.csv: a line a run.
std::string runs_csv(const Ensemble& ensemble);
/// statistics.csv: a line for each variant and quantity.
std::string statistics_csv(const Ensemble& ensemble);

/// Returns the files.
std::vector<std::filesystem::path> draw_ensemble(const Ensemble& ensemble, const std::filesystem::path& directory);

}  // namespace knap
