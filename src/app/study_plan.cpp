// Which runs a study consists of.
#include "app/step_plan.hpp"
#include "app/study.hpp"
#include "base/error.hpp"
#include "scenario/units.hpp"

#include <algorithm>
#include <optional>
#include <set>

namespace knap {
namespace {

using Overrides = std::vector<std::string>;

constexpr std::size_t longest_name = 150;  // of a quantity, which is part of the names of figures

void append(Overrides& all, const Overrides& more) { all.insert(all.end(), more.begin(), more.end()); }

/// What is not for the single run: its figures, its [expect] (a coarse run may miss it), the study or sweep itself.
const Overrides bare{"output.fields=false", "figure=", "expect=", "study=", "sweep="};

/// The steps of a level. Those in multiples of the stable step follow a refined mesh by themselves.
void refine_step(const ReadResult& base, double level, bool follows_mesh, Overrides& set) {
    const TimeOptions& time = base.scenario.time;
    const bool implicit = time.scheme.bulk == BulkScheme::implicit_theta;
    const auto divide = [&](const char* key, const StepLength& step) {
        if (step.value == 0 || (follows_mesh && step.of_stable_step)) return;
        set.push_back(std::string(key) + "=" + shortest(step.value / level) + (step.of_stable_step ? " CFL" : ""));
    };
    const StepLength automatic{.value = implicit ? automatic_multiple : time.safety, .of_stable_step = true};
    divide("time.step", time.step.value > 0 ? time.step : automatic);
    divide("time.step_cracking", time.step_cracking);
    divide("time.step_min", time.step_min);
}

void refine_mesh(const ReadResult& base, double level, Overrides& set) {
    const MeshOptions& mesh = base.scenario.mesh;
    set.push_back("mesh.size=" + shortest(mesh.size / level));
    for (std::size_t i = 0; i < mesh.refine.size(); ++i) set.push_back(item("mesh.refine", i) + ".size=" + shortest(mesh.refine[i].size / level));
}

double finest_size(const Scenario& scenario) {
    if (scenario.given) return 0;
    double size = scenario.mesh.size;
    for (const auto& box : scenario.mesh.refine) size = std::min(size, box.size);
    return size;
}

/// "explicit_implicit_r2_s1"
std::string directory_name(const std::string& line, double level, std::optional<std::uint64_t> seed) {
    return plain_name(line) + "_r" + shortest(level) + (seed ? "_s" + std::to_string(*seed) : "");
}

std::string scheme_name(const Scenario& scenario) {
    const SchemeOptions& scheme = scenario.time.scheme;
    return std::string(scheme.bulk == BulkScheme::explicit_lumped ? "explicit" : "implicit") + ", " +
           (scheme.cohesion == CohesionScheme::explicit_beta ? "explicit" : "implicit");
}

/// Throws UserError where two quantities would have one figure, or one none.
void check_quantities(const std::vector<StudyQuantity>& quantities) {
    std::set<std::string> names;
    for (const StudyQuantity& quantity : quantities) {
        const std::string name = plain_name(quantity.name);
        if (name.size() > longest_name)
            throw UserError("bad-name", "the name of a quantity has " + std::to_string(name.size()) + " letters", "at most " + std::to_string(longest_name));
        if (!names.insert(name).second) throw UserError("duplicate-name", "two quantities would be called `" + quantity.name + "`", "give each a name of its own, and each once");
    }
}

}  // namespace

StudyPlan plan_study(const std::string& scenario, const Overrides& overrides) {
    const ReadResult read = open_scenario(scenario, overrides);
    StudyPlan plan{.options = read.scenario.study, .name = read.scenario.name};
    StudyOptions& options = plan.options;
    check_quantities(options.quantities);
    // a study of single runs needs events to the step; statistics can do with the lines that the scenario writes
    Overrides common = options.n_seeds > 0 ? Overrides{} : Overrides{"output.history_every=" + shortest(1e-9 * read.scenario.time.end)};
    append(common, overrides);
    append(common, options.set);
    for (std::size_t i = 0; i < options.lines.size(); ++i) {
        StudyLine& line = options.lines[i];
        Overrides of_line = common;
        append(of_line, line.set);
        append(of_line, bare);
        const ReadResult base = open_scenario(scenario, of_line);
        if (i == 0) plan.title = base.scenario.title;
        if (line.name.empty()) line.name = scheme_name(base.scenario);
        std::sort(line.levels.begin(), line.levels.end());
        for (const double level : line.levels) {
            for (int s = 0; s < std::max(options.n_seeds, 1); ++s) {
                StudyRun run;
                run.line = i, run.level = level, run.seed = base.scenario.seed + static_cast<std::uint64_t>(s);
                run.overrides = of_line;
                if (options.refine != Refine::mesh) refine_step(base, level, options.refine == Refine::both, run.overrides);
                if (options.refine != Refine::step) refine_mesh(base, level, run.overrides);
                const bool seeds = options.n_seeds > 0;
                if (seeds) run.overrides.push_back("seed=" + std::to_string(run.seed));
                run.name = directory_name(line.name, level, seeds ? std::optional(run.seed) : std::nullopt);
                const ReadResult resolved = open_scenario(scenario, run.overrides);
                run.resolved = resolved_for_run(resolved);
                run.size = finest_size(resolved.scenario);
                plan.runs.push_back(std::move(run));
            }
        }
    }
    check_names(batch_of(plan.runs), "give every line a name of its own, and every level once");
    return plan;
}

}  // namespace knap
