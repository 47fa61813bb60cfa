#pragma once
// Many runs of one scenario: `knap study` (levels of refinement, schemes, seeds) and `knap sweep` (all combinations of
// values of keys and seeds).
//
//     plan_study, plan_sweep   the runs as overrides of the scenario; all are resolved before the first one starts
//     plan_safety              the first runs of a search, whose results say which ones follow (safety.cpp)
//     run_ensemble             one process per run, several at a time; finished runs are kept
//     read_result              the numbers of a run, from its directory
//     judge_errors             of a study: errors and orders of convergence (convergence.hpp)
//     overview, ..._csv        tables
//     draw_ensemble            diagrams of a study; contact sheet and trajectories of a sweep
//     passages_csv             what went through collectors in all runs
#include "app/ensemble/convergence.hpp"
#include "app/run/run.hpp"
#include "figures/figures.hpp"
#include "scenario/ensemble_options.hpp"

#include <functional>

namespace knap {

struct BatchOptions {
    std::filesystem::path output;  // empty: studies/<name> or sweeps/<name>
    int n_at_once = 1;             // simultaneous runs
    bool force = false;            // repeat finished runs and replace those of another ensemble
    bool quiet = false;
    bool print_commands = false;       // run nothing, print the command line of each run
    std::string emit;                  // "slurm": run nothing, print a script that submits the runs
    std::string program = "knap";      // first word of these lines
    std::vector<std::string> command;  // as typed, for the report
};

/// The numbers of a run, from its directory.
struct RunResult {
    std::string status;  // of run.json; "refused" without one: the run did not start; "": it has not ended yet
    std::string reason;  // of a failure
    std::string bulk, cohesion;
    bool gates_hold = true;
    double triangles = 0, steps = 0, cutbacks = 0, linear_solves = 0, factorisations = 0;
    double step = NAN;           // [s] as planned
    double cpu = NAN;            // [s] processor time without output
    double at_rest = NAN;        // 1: ended at rest, 0: time.end came before; NaN: it does not end at rest
    std::vector<double> values;  // per quantity; NaN without a value
    std::vector<std::string> warnings;

    /// Whether its process wrote the record for the last time while it was at work.
    bool is_under_way() const { return status == "running" || status == "starting"; }
    /// Why the run is not successful; empty for a successful one.
    std::string trouble() const;
};

/// `run`: its directory, next to which <run>.log has the messages of its process. Throws UserError for a damaged
/// record.
RunResult read_result(const std::filesystem::path& run, const std::vector<StudyQuantity>& quantities);

struct EnsembleRun {
    std::size_t variant = 0;
    std::uint64_t seed = 1;
    std::string name;                    // of its directory
    std::vector<std::string> overrides;  // KEY=VALUE
    std::vector<std::string> drawn;      // values of Ensemble::random
    std::string refusal = {};            // of a random member that is no scenario: why; it does not start
    std::string resolved;                // its resolved.toml: a directory with another one holds another run
    double mesh_size = 0;                // [m] smallest requested size; 0 of a mesh that is read
    RunResult result = {};

    bool is_left() const { return result.status.empty(); }
    bool is_done() const { return result.status == "done"; }
};

/// One combination of values; its runs differ in the seed, or in what is drawn at random, only.
struct Variant {
    std::string name;                    // for directories
    std::vector<std::string> values;     // per entry of Ensemble::keys
    std::vector<std::string> overrides;  // KEY=VALUE
    std::size_t line = 0;                // of a study
    double level = 1;                    // of a study
    bool only_shows = false;             // of a search: the mechanism, from rest; whether it stands decides nothing
};

/// A search for the factor of safety.
struct SafetySearch {
    SafetyOptions options;
    std::vector<std::string> common;  // KEY=VALUE of all runs
    std::vector<std::string> notes;   // on laws whose cohesion does not act everywhere
    double diagonal = 0;              // [m] of the bodies
    double low = 0, high = 0;         // [-] the body stands at `low`, and not at `high`; 0: not known
    std::string failure;              // why there is no factor; empty: it was found, or the search goes on
};

struct Ensemble {
    std::string kind;  // "study", "sweep" or "safety"
    std::string name, title, question;
    bool report = true;             // write report.html
    std::string record;             // text of <kind>.toml
    std::vector<std::string> keys;  // that are varied; of a study "line" and "level"
    std::vector<Variant> variants;
    std::size_t n_seeds = 0;        // 0: the seed is not varied
    RandomMembers random;           // of a sweep: in place of seeds
    std::vector<EnsembleRun> runs;  // by variant, then by seed
    std::vector<StudyQuantity> quantities;
    StudyOptions study;                  // of a study
    std::optional<SafetySearch> safety;  // of a search for the factor of safety
    std::vector<QuantityErrors> errors;  // per quantity, of a study without seeds
    FigureOptions sheet;                 // of a sweep: the figure of each run on its contact sheet; show empty: none
    bool trajectories = false;           // the runs of a sweep have trajectories.csv
    std::vector<Obstacle> obstacles;     // of a sweep, as the scenario has them
    std::vector<CollectorOptions> collectors;

    bool is_study() const { return kind == "study"; }
    /// Number of runs of a variant: seeds or members.
    std::size_t n_each() const {
        return random.n > 0 ? static_cast<std::size_t>(random.n) : std::max<std::size_t>(n_seeds, 1);
    }
    bool has_statistics() const { return n_seeds > 0 || random.n > 0; }
    std::span<const EnsembleRun> runs_of(std::size_t variant) const;
    Spread spread(std::size_t variant, const std::function<double(const EnsembleRun&)>& number) const;
    Spread spread(std::size_t variant, std::size_t quantity) const;
    std::vector<std::size_t> variants_of(std::size_t line) const;  // from coarse to fine
    std::string caption(const EnsembleRun& run) const;             // "size 1 mm, seed 3"
};

/// `overrides` as with --set; of a sweep KEY=VALUE,VALUE,... too. All throw UserError for mistakes in the scenario or
/// in any run.
Ensemble plan_study(const std::string& scenario, const std::vector<std::string>& overrides);
Ensemble plan_sweep(const std::string& scenario, const std::vector<std::string>& overrides);

Ensemble plan_safety(const std::string& scenario, const std::vector<std::string>& overrides);

/// Resolves the runs of variants from the first new one on and adds them: a mistake in any of them is reported before
/// one starts.
void add_runs(const std::string& scenario, Ensemble& ensemble, std::size_t first_variant = 0);
/// Overrides that keep a run of an ensemble from making reports of its own, unless that is asked for.
std::vector<std::string> report_of_runs(const std::vector<std::string>& overrides);

/// Adds the runs that follow from the results, up to `n_at_once` if that helps; the factors do not depend on it. False:
/// the search is over.
bool continue_search(Ensemble& safety, const std::string& scenario, int n_at_once);
/// "stands", or why a run of a search does not; empty: the run tells nothing of it.
std::string verdict_of(const Ensemble& safety, const EnsembleRun& run);
/// The factor, its bracket, the verdicts; printed, and the text of safety.md.
std::string safety_text(const Ensemble& safety);

struct SweepKey {
    std::string key;
    std::vector<std::string> values;
};
/// Splits "KEY=a,b"; commas in quotes and brackets belong to a value.
SweepKey sweep_key(const std::string& set);

/// "20" -> sweep.seeds=20, "3..20" -> seed=3, sweep.seeds=18; "" -> nothing. Throws UserError for other texts.
std::vector<std::string> seed_overrides(const std::string& text);

/// Letters, digits, - and . of a text with _ between them, for file names.
std::string plain_name(const std::string& text);

/// Does all runs that are not finished, judges and draws; or prints their command lines.
ExitCode run_ensemble(Ensemble ensemble, const std::string& scenario, const BatchOptions& options);

/// A shell script that submits the runs as an array of jobs of a minute or more, with time and memory as `knap check`
/// estimates them, and a last job that collects. `commands`: a line per run.
std::string slurm_script(const Ensemble& ensemble, const std::string& scenario,
                         const std::vector<const EnsembleRun*>& to_do, const std::vector<std::string>& commands,
                         const std::filesystem::path& runs, const BatchOptions& options);

/// Fills Ensemble::errors from the results.
void judge_errors(Ensemble& study);

/// Printed, and the text of <kind>.md.
std::string overview(const Ensemble& ensemble);
/// <kind>.csv: a row per run.
std::string runs_csv(const Ensemble& ensemble);
/// statistics.csv: a row per variant and quantity.
std::string statistics_csv(const Ensemble& ensemble);

/// passages.csv of a sweep: the lines of all its runs that are done, which are in `runs`, with their names.
std::string passages_csv(const Ensemble& sweep, const std::filesystem::path& runs);
/// A row per collector: statistics of the passages of all these runs together.
std::string passages_table(const Ensemble& sweep, const std::filesystem::path& runs);

struct CaptionedFigure {
    std::filesystem::path file;
    std::string caption;
};

/// Of a sweep: trajectories of all its runs over the ground, heights and energies over x, run-outs, sizes of pieces;
/// none where nothing has moved.
std::vector<CaptionedFigure> draw_trajectories(const Ensemble& sweep, const std::filesystem::path& runs,
                                               const std::filesystem::path& figures);

std::vector<CaptionedFigure> draw_ensemble(const Ensemble& ensemble, const std::filesystem::path& directory);

}  // namespace knap
