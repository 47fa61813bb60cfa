// The runs of an ensemble as a script that submits them to Slurm.
#include "app/check/cost.hpp"
#include "app/check/findings.hpp"
#include "app/ensemble/ensemble.hpp"
#include "app/run/report.hpp"
#include "base/formatted.hpp"
#include "base/stopwatch.hpp"
#include "scenario/read_scenario.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace knap {
namespace {

constexpr double shortest_job = 60;  // [s] a shorter one costs the scheduler more than it computes

struct Job {
    std::string commands;
    double seconds = 0;
};

Cost cost_of(const std::string& scenario, const EnsembleRun& run) {
    ReadResult read = open_scenario(scenario, run.overrides);
    const Stopwatch watch;
    const Model model = model_of(read);
    const StepPlan plan = plan_of(read, model, read.scenario.time.end);
    const Cost cost = estimate_cost(read.scenario, model, plan, watch.cpu(), 0.05);
    if (cost.given_up_after > 0)
        throw UserError("unknown-cost", "run `" + run.name + "`: " + unknown_text(cost, plan.limits.largest),
                        "jobs need a time limit: use a smaller time.step, or start the runs without --emit");
    return cost;
}

/// A file of a directory as an option in a comment of the script: words end at blanks, a backslash takes the meaning of
/// the next character, and Slurm replaces %a and the like in what is left.
std::string quoted_for_slurm(const std::filesystem::path& directory, const std::string& pattern) {
    std::string quoted = "\"";
    for (const char c : directory.string()) {
        if (c == '"' || c == '\\') quoted += '\\';
        if (c == '%') quoted += '%';
        quoted += c;
    }
    return quoted + "/" + pattern + "\"";
}

}  // namespace

std::string slurm_script(const Ensemble& ensemble, const std::string& scenario,
                         const std::vector<const EnsembleRun*>& to_do, const std::vector<std::string>& commands,
                         const std::filesystem::path& runs, const BatchOptions& options) {
    std::map<std::size_t, Cost> cost_of_variant;  // seeds make no difference
    std::vector<Job> jobs;
    double memory = 0, longest = 0;  // [MB], [s]
    for (std::size_t i = 0; i < to_do.size(); ++i) {
        const std::size_t variant = to_do[i]->variant;
        if (!cost_of_variant.contains(variant)) cost_of_variant[variant] = cost_of(scenario, *to_do[i]);
        const Cost& cost = cost_of_variant[variant];
        if (jobs.empty() || jobs.back().seconds + cost.total() > shortest_job) jobs.emplace_back();
        jobs.back().commands += commands[i] + "\n";
        jobs.back().seconds += cost.total();
        memory = std::max(memory, cost.memory), longest = std::max(longest, jobs.back().seconds);
    }
    std::vector<std::string> collect;
    for (std::size_t i = 0; i < options.command.size(); ++i)
        if (options.command[i] == "--emit") ++i;
        else if (!options.command[i].starts_with("--emit=")) collect.push_back(options.command[i]);
    // estimates hold within a factor of 2, for bodies that fragment less well
    const std::string resources = formatted("#SBATCH --cpus-per-task=1\n#SBATCH --time=%.0f\n#SBATCH --mem=%.0fM\n",
                                            std::ceil(3 * longest / 60 + 5), std::ceil(1.5 * memory + 200)),
                      limit = options.n_at_once > 1 ? "%" + std::to_string(options.n_at_once) : "",
                      name = plain_name(ensemble.name);
    std::string text =
        "#!/bin/sh\n# Submits " + std::to_string(to_do.size()) + " runs in " + std::to_string(jobs.size()) +
        formatted(" jobs, the longest of about %.0f s, and a job that makes tables and figures when they have ended.\n",
                  longest) +
        "set -e\ncd " + command_line({std::filesystem::current_path().string()}) +
        "\nids=$(sbatch --parsable <<'KNAP_JOBS'\n#!/bin/bash\n#SBATCH --job-name=" + name + "\n#SBATCH --array=1-" +
        std::to_string(jobs.size()) + limit + "\n#SBATCH --output=" + quoted_for_slurm(runs, "slurm_%a.log") + "\n" +
        resources + "case $SLURM_ARRAY_TASK_ID in\n";
    for (std::size_t i = 0; i < jobs.size(); ++i) text += std::to_string(i + 1) + ")\n" + jobs[i].commands + ";;\n";
    return text + "esac\nKNAP_JOBS\n)\nsbatch --dependency=afterany:\"${ids%%;*}\" <<'KNAP_COLLECT'\n#!/bin/bash\n" +
           "#SBATCH --job-name=" + name + "_collect\n#SBATCH --output=" + quoted_for_slurm(runs, "slurm_collect.log") +
           "\n" + resources + command_line(collect) + "\nKNAP_COLLECT\n";
}

}  // namespace knap
