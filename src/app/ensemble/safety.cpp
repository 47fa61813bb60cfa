// `knap study --safety`: bisection for the factor of safety F. A law has the shear strength without pressure
// c = sigma_c s(mu) with s = gamma + mu (norm: gamma) and the friction tan phi = mu. Both over F are
//
//     mu' = mu/F,    sigma_c' = sigma_c s(mu)/(F s(mu/F)),    delta_c' = delta_c:    G_c' = G_c sigma_c'/sigma_c
//
// with the same gamma, so that a joint of c L + W cos a tan phi holds 1/F of it, whatever its pressure.
#include "app/ensemble/ensemble.hpp"
#include "app/run/continuation.hpp"
#include "app/run/report.hpp"
#include "base/display_unit.hpp"
#include "base/error.hpp"
#include "base/formatted.hpp"
#include "record/html.hpp"
#include "record/outputs.hpp"

#include <algorithm>

namespace knap {
namespace {

using Texts = std::vector<std::string>;

constexpr double of_diagonal = 0.01;  // displacement that no body at rest has
constexpr const char* stands = "stands";

bool slides_or_breaks(const CohesiveLaw& law) {
    return law.breakable() && (law.sigma_c > 0 || law.friction_range()[1] > 0);
}

/// Overrides that divide c and tan phi of a law.
Texts divided(const ReadResult& read, const NamedLaw& named, double F) {
    const std::string path = "interface." + named.name + ".";
    Texts set;
    const auto number = [&](const char* key) { return read.values.get<double>(path + key); };
    const auto put = [&](const char* key, double value) { set.push_back(path + key + "=" + shortest(value)); };
    const double mu = named.law.friction, of_less = named.law.shear_strength(mu / F),
                 of_c = (of_less > 0 ? named.law.shear_strength(mu) / of_less : 1) / F;
    if (mu > 0) put("friction", mu / F);
    if (const auto sigma_c = number("sigma_c"); sigma_c && *sigma_c > 0) put("sigma_c", *sigma_c * of_c);
    if (mu > 0 && named.law.slip_distance > 0) put("kinetic_friction", named.law.kinetic_friction / F);
    for (const char* energy : {"G_c", "G_II"})
        if (const auto G = number(energy); G && named.law.sigma_c > 0) put(energy, *G * of_c);
    return set;
}

double diagonal_of(const Scenario& scenario) {
    std::vector<Vec2> points;
    if (scenario.given) points = scenario.given->mesh.vertices;
    for (const Body& body : scenario.bodies)
        points.insert(points.end(), body.shape.outer.points.begin(), body.shape.outer.points.end());
    return bounding_box(points).extent().norm();
}

void add_factor(Ensemble& safety, const ReadResult& read, double F, bool from_rest = false) {
    const auto is_known = [&](const Variant& variant) { return variant.level == F && !from_rest; };
    if (std::ranges::any_of(safety.variants, is_known)) return;
    Variant variant{.name = "F" + shortest(F) + (from_rest ? "_from_rest" : ""),
                    .values = {shortest(F)},
                    .overrides = safety.safety->common,
                    .level = F,
                    .only_shows = from_rest};
    for (const std::string& name : safety.safety->options.laws) {
        const Texts set = divided(read, *std::ranges::find(read.scenario.laws, name, &NamedLaw::name), F);
        variant.overrides.insert(variant.overrides.end(), set.begin(), set.end());
    }
    if (from_rest) variant.overrides.emplace_back("time.start=rest");
    safety.variants.push_back(std::move(variant));
}

/// The points of some bisections, all of which may be asked for: the first one, then those on both sides of it.
void add_middles(Ensemble& safety, const ReadResult& read, double low, double high, int n_bisections) {
    const double middle = 0.5 * (low + high);
    if (n_bisections <= 0 || high - low <= safety.safety->options.tolerance * low) return;
    add_factor(safety, read, middle);
    add_middles(safety, read, low, middle, n_bisections - 1);
    add_middles(safety, read, middle, high, n_bisections - 1);
}

/// The run of a factor that the scenario's own start has; null where there is none yet.
const EnsembleRun* run_at(const Ensemble& safety, double F) {
    for (const EnsembleRun& run : safety.runs)
        if (const Variant& variant = safety.variants[run.variant]; variant.level == F && !variant.only_shows)
            return &run;
    return nullptr;
}

}  // namespace

Ensemble plan_safety(const std::string& scenario, const Texts& overrides) {
    const ReadResult read = open_scenario(scenario, overrides);
    Ensemble safety{.kind = "safety",
                    .name = read.scenario.name,
                    .title = read.scenario.title,
                    .question = question_of(read.source.text()),
                    .report = read.scenario.output.report,
                    .record = resolved_for_run(read),
                    .keys = {"factor"},
                    .safety = SafetySearch{.options = read.scenario.study.safety}};
    SafetyOptions& options = safety.safety->options;
    safety.safety->diagonal = diagonal_of(read.scenario);
    if (options.runaway == 0) options.runaway = of_diagonal * safety.safety->diagonal;
    if (options.laws.empty())
        for (const NamedLaw& named : read.scenario.laws)
            if (slides_or_breaks(named.law)) options.laws.push_back(named.name);
    const auto refuse = [&](const std::string& problem, const std::string& cure) {
        throw UserError({read.at("study.safety.laws", {.code = "no-strength", .message = problem, .note = cure})});
    };
    if (options.laws.empty())
        refuse("no law has a strength or friction that could be divided",
               "an [interface.NAME] that may break or slide");
    for (const std::string& name : options.laws) {
        const CohesiveLaw& law = std::ranges::find(read.scenario.laws, name, &NamedLaw::name)->law;
        if (!slides_or_breaks(law))
            refuse("`study.safety.laws`: the law `" + name + "` has neither strength nor friction to divide",
                   "a law that may break or slide");
        if (law.of_temperature && !law.of_temperature->friction.empty())
            refuse("`study.safety.laws`: the law `" + name + "` has a friction_table, which cannot be divided",
                   "friction at the temperature in question");
        if (law.over_pressure)
            refuse("`study.safety.laws`: the law `" + name + "` has a friction_over_pressure, which is not divided",
                   "friction, tan phi at the pressure in question");
    }
    for (std::size_t s = 0; s < read.scenario.supports.size(); ++s) {
        const Support& support = read.scenario.supports[s];
        const NamedLaw& named = read.scenario.laws[support.law];
        if (!support.glued && named.law.sigma_c > 0 && std::ranges::count(options.laws, named.name) > 0)
            safety.safety->notes.push_back("`" + item("support", s) + "` is not glued: of the law `" + named.name +
                                           "` it has the friction alone, and c = 0; glued = true for its cohesion");
    }
    for (const char* name : {"largest_displacement", "broken_length"})
        safety.quantities.push_back({.name = name, .of = name, .unit = std::string(unit_of("summary", name))});
    const auto own = std::ranges::find_if(read.scenario.figures,
                                          [](const FigureOptions& figure) { return figure.show == "displacement"; });
    if (own != read.scenario.figures.end()) safety.sheet = *own;
    safety.sheet.show = "displacement", safety.sheet.file = "mechanism.png", safety.sheet.at.clear();
    // the runs keep frames for the mechanism, are no studies themselves, and may miss [expect]
    safety.safety->common = overrides;
    constexpr double n_frames = 20;
    const Texts more{"output.fields=true",
                     "output.frame_every=" + shortest(read.scenario.time.end / n_frames),
                     "figure=",
                     "expect=",
                     "study=",
                     "sweep="};
    for (const Texts& each : {more, report_of_runs(overrides)})
        safety.safety->common.insert(safety.safety->common.end(), each.begin(), each.end());
    if (options.criterion == SafetyOptions::Criterion::rest) safety.safety->common.emplace_back("time.until=rest");
    for (const double F : options.factors) add_factor(safety, read, F);
    add_runs(scenario, safety);
    return safety;
}

std::string verdict_of(const Ensemble& safety, const EnsembleRun& run) {
    const SafetyOptions& options = safety.safety->options;
    const RunResult& result = run.result;
    if (safety.variants[run.variant].only_shows) return "shows the mechanism";
    if (result.status == "failed" && result.reason.starts_with("no equilibrium")) return result.reason;
    if (!result.gates_hold) return "runs away: " + result.reason;
    if (result.status != "done") return "";
    if (result.values[0] > options.runaway) return "runs away, by " + readable(result.values[0], "m");
    if (options.criterion == SafetyOptions::Criterion::rest && result.at_rest != 1) return "moves at time.end";
    return stands;
}

bool continue_search(Ensemble& safety, const std::string& scenario, int n_at_once) {
    SafetySearch& search = *safety.safety;
    const auto ends = [&](const std::string& failure) {
        search.failure = failure;
        return false;
    };
    for (const EnsembleRun& run : safety.runs)
        if (verdict_of(safety, run).empty())
            return ends("the run at factor " + safety.variants[run.variant].values[0] +
                        " tells nothing: " + run.result.trouble());
    const auto does_stand = [&](double F) { return verdict_of(safety, *run_at(safety, F)) == stands; };
    auto [low, high] = search.options.factors;
    if (!does_stand(low))
        return ends("the body does not stand at factor " + shortest(low) + ": " +
                    verdict_of(safety, *run_at(safety, low)) +
                    "; study.safety.factors from a smaller one on, or a longer time.end");
    if (does_stand(high))
        return ends("the body stands at factor " + shortest(high) +
                    ", the largest one; study.safety.factors up to a larger one");
    double middle = 0.5 * (low + high);
    for (; high - low > search.options.tolerance * low && run_at(safety, middle); middle = 0.5 * (low + high))
        (does_stand(middle) ? low : high) = middle;
    search.low = low, search.high = high;
    const ReadResult read = open_scenario(scenario, search.common);
    const std::size_t n_before = safety.variants.size();
    if (high - low > search.options.tolerance * low) {
        int n_bisections = 1;
        while ((2 << n_bisections) - 1 <= n_at_once) ++n_bisections;
        add_middles(safety, read, low, high, n_bisections);
    } else if (run_at(safety, high)->result.steps == 0 && !safety.variants.back().only_shows) {
        add_factor(safety, read, high, true);  // it failed before its first step and shows no mechanism
    }
    if (safety.variants.size() == n_before) return false;
    add_runs(scenario, safety, n_before);
    return true;
}

std::string safety_text(const Ensemble& safety) {
    const SafetySearch& search = *safety.safety;
    std::string text = search.failure.empty() ? formatted("factor of safety %.4g: stands at %.6g, not at %.6g",
                                                          search.low, search.low, search.high)
                                              : "no factor of safety: " + search.failure;
    text += "\n\nc and tan phi of " + joined(search.options.laws) + " divided by the factor; stands: " +
            (search.options.criterion == SafetyOptions::Criterion::rest ? "at rest, " : "") + "displacements below " +
            readable(search.options.runaway, "m") + "\n\n";
    std::vector<const EnsembleRun*> runs;
    for (const EnsembleRun& run : safety.runs) runs.push_back(&run);
    std::ranges::stable_sort(runs, {}, [&](const EnsembleRun* run) { return safety.variants[run->variant].level; });
    for (const EnsembleRun* run : runs) {
        const std::string verdict = verdict_of(safety, *run);
        text += "- " + run->name + ": " + (verdict.empty() ? run->result.trouble() : verdict) + "\n";
    }
    text += "\n";
    for (const std::string& note : search.notes) text += "Note: " + note + "\n\n";
    if (const EnsembleRun* last = search.low > 0 ? run_at(safety, search.low) : nullptr)
        for (const std::string& warning : last->result.warnings)
            text += "Warning of " + last->name + ": " + warning + "\n\n";
    return text;
}

}  // namespace knap
