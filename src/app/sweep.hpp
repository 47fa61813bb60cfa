#pragma once
// knap sweep: a scenario over the full product of values of keys and seeds; a table, statistics over the seeds, a contact sheet.
//
//     plan_sweep    which runs            every combination, the last key fastest, then the seeds
//     do_runs       child processes       finished runs are kept; or job lists for other schedulers (--emit)
//     tables        from their run.json
#include "app/run.hpp"
#include "app/run_batch.hpp"
#include "app/run_result.hpp"

namespace knap {

struct SweepCommand {
    BatchOptions batch;
    std::string emit;                  // parallel, slurm, snakemake: job lists instead of runs
    std::vector<std::string> command;  // as typed, for the job lists
};

ExitCode sweep_scenario(const std::string& scenario, const std::vector<std::string>& overrides, const SweepCommand& command);

/// A key with the values that it takes.
struct SweepKey {
    std::string key;
    std::vector<std::string> values;
    std::string name() const;  // its last part
};

struct SweepRun : BatchRun {
    std::vector<std::string> values;  // one a key
    std::uint64_t seed = 1;
};

struct SweepPlan {
    std::string name, title;
    std::vector<SweepKey> keys;
    std::size_t n_seeds = 1;
    std::vector<StudyQuantity> quantities;
    std::vector<SweepRun> runs;
    bool has_seeds = false;  // they are varied
    FigureOptions sheet;     // a panel for each run
    std::string caption(const SweepRun& run) const;  // "size 1 mm, seed 3"
};

/// "20" -> sweep.seeds=20, "3..20" -> seed=3, sweep.seeds=18; "" -> nothing. Throws UserError for anything else.
std::vector<std::string> seed_overrides(const std::string& text);

/// "KEY=a,b" -> KEY and its values; commas in quotes and brackets are part of a value.
SweepKey sweep_key(const std::string& set);

/// Throws UserError with what is wrong in the scenario, or in any of the runs.
SweepPlan plan_sweep(const std::string& scenario, const std::vector<std::string>& overrides);

std::string sweep_text(const SweepPlan& plan, const std::vector<RunResult>& results);
std::string sweep_csv(const SweepPlan& plan, const std::vector<RunResult>& results);
/// Statistics over the seeds, a line for each combination and quantity.
std::string sweep_statistics_csv(const SweepPlan& plan, const std::vector<RunResult>& results);

/// Writes the job list for `kind` into the directory; returns what to type there.
std::string emit_jobs(const std::string& kind, const std::vector<std::vector<std::string>>& jobs, const std::vector<std::string>& collect, const std::string& name,
                      const std::filesystem::path& directory);

/// For a shell: in quotes where it needs them.
std::string quoted_for_shell(const std::string& word);

}  // namespace knap
