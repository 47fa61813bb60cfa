// The runs of a study and of a sweep.
#include "app/ensemble/ensemble.hpp"
#include "app/run/step_plan.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "record/outputs.hpp"

#include <algorithm>
#include <regex>
#include <set>

namespace knap {
namespace {

using Texts = std::vector<std::string>;

constexpr double max_runs = 100'000;  // each is resolved before the first one starts, which takes about a millisecond
constexpr std::size_t max_directory_name = 120,
                      max_quantity_name = 150;  // a quantity's name is part of the names of figures

void append(Texts& all, const Texts& more) { all.insert(all.end(), more.begin(), more.end()); }

double finest_size(const Scenario& scenario) {
    if (scenario.given) return 0;
    double size = scenario.mesh.size;
    for (const auto& box : scenario.mesh.refine) size = std::min(size, box.size);
    return size;
}

/// Adds the runs of all variants, each resolved: a mistake in any of them is reported before the first one starts.
void add_runs(const std::string& scenario, Ensemble& ensemble) {
    const bool seeds = ensemble.n_seeds > 0;
    std::set<std::string> names;
    for (std::size_t v = 0; v < ensemble.variants.size(); ++v) {
        const Variant& variant = ensemble.variants[v];
        const std::uint64_t first_seed = seeds ? open_scenario(scenario, variant.overrides).scenario.seed : 0;
        for (std::size_t s = 0; s < std::max<std::size_t>(ensemble.n_seeds, 1); ++s) {
            EnsembleRun run{.variant = v, .name = variant.name, .overrides = variant.overrides};
            if (seeds) run.overrides.push_back("seed=" + std::to_string(first_seed + s));
            const ReadResult read = open_scenario(scenario, run.overrides);
            run.seed = read.scenario.seed;
            run.resolved = resolved_for_run(read);
            run.mesh_size = finest_size(read.scenario);
            if (seeds || run.name.empty()) run.name += (run.name.empty() ? "s" : "_s") + std::to_string(run.seed);
            if (run.name.size() > max_directory_name) run.name = "run_" + std::to_string(ensemble.runs.size() + 1);
            if (!names.insert(run.name).second)
                throw UserError("duplicate-name", "two runs would be called `" + run.name + "`",
                                "give every value once, and every line a name of its own");
            ensemble.runs.push_back(std::move(run));
        }
    }
}

// ---- study

/// The steps of a level. Those in multiples of the stable step follow a refined mesh by themselves.
void refine_step(const Scenario& base, double level, bool follows_mesh, Texts& set) {
    const TimeOptions& time = base.time;
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

void refine_mesh(const Scenario& base, double level, Texts& set) {
    set.push_back("mesh.size=" + shortest(base.mesh.size / level));
    for (std::size_t i = 0; i < base.mesh.refine.size(); ++i)
        set.push_back(item("mesh.refine", i) + ".size=" + shortest(base.mesh.refine[i].size / level));
}

std::string scheme_name(const SchemeOptions& scheme) {
    return std::string(scheme.bulk == BulkScheme::explicit_lumped ? "explicit" : "implicit") + ", " +
           (scheme.cohesion == CohesionScheme::explicit_beta ? "explicit" : "implicit");
}

/// Throws UserError where two quantities would have one figure, or one none.
void check_quantities(const std::vector<StudyQuantity>& quantities) {
    std::set<std::string> names;
    for (const StudyQuantity& quantity : quantities) {
        const std::string name = plain_name(quantity.name);
        if (name.size() > max_quantity_name)
            throw UserError("bad-name", "the name of a quantity has " + std::to_string(name.size()) + " letters",
                            "at most " + std::to_string(max_quantity_name));
        if (!names.insert(name).second)
            throw UserError("duplicate-name", "two quantities would be called `" + quantity.name + "`",
                            "give each a name of its own, and each once");
    }
}

// ---- sweep

/// Later entries take the place of earlier ones for the same key.
void add_keys(const Texts& set, std::vector<SweepKey>& keys) {
    for (const std::string& text : set) {
        SweepKey key = sweep_key(text);
        std::erase_if(keys, [&](const SweepKey& earlier) { return earlier.key == key.key; });
        keys.push_back(std::move(key));
    }
}

std::string last_part(const std::string& key) { return key.substr(key.rfind('.') + 1); }

/// The panel of a run on the contact sheet: as the scenario draws it, at the end of the run.
FigureOptions sheet_figure(const Scenario& scenario, const std::string& show) {
    const auto own = std::ranges::find(scenario.figures, show, &FigureOptions::show);
    FigureOptions figure = own == scenario.figures.end() ? FigureOptions{.show = show} : *own;
    figure.file = "sheet.png";
    figure.at.clear();
    figure.width = 800;
    figure.panel = true;
    return figure;
}

/// All combinations of the values, the last key fastest.
std::vector<Variant> combinations(const std::vector<SweepKey>& keys, std::size_t n_seeds) {
    double n_runs = static_cast<double>(std::max<std::size_t>(n_seeds, 1));
    for (const SweepKey& key : keys) n_runs *= static_cast<double>(key.values.size());
    if (n_runs > max_runs)
        throw UserError("too-many-runs", "this sweep has " + shortest(n_runs) + " runs",
                        "at most " + shortest(max_runs) + "; fewer values or seeds, or several sweeps");
    std::vector<Variant> all{{}};
    for (const SweepKey& key : keys) {
        std::vector<Variant> longer;
        for (const Variant& shorter : all)
            for (const std::string& value : key.values) {
                Variant& variant = longer.emplace_back(shorter);
                variant.values.push_back(value);
                variant.overrides.push_back(key.key + "=" + value);
                variant.name += (variant.name.empty() ? "" : "_") + plain_name(last_part(key.key) + " " + value);
            }
        all = std::move(longer);
    }
    return all;
}

}  // namespace

std::span<const EnsembleRun> Ensemble::runs_of(std::size_t variant) const {
    const std::size_t n = std::max<std::size_t>(n_seeds, 1);
    return {runs.data() + variant * n, n};
}

Spread Ensemble::spread(std::size_t variant, const std::function<double(const EnsembleRun&)>& number) const {
    std::vector<double> values;
    for (const EnsembleRun& run : runs_of(variant)) values.push_back(number(run));
    return spread_of(values);
}

Spread Ensemble::spread(std::size_t variant, std::size_t q) const {
    return spread(variant, [q](const EnsembleRun& run) { return run.result.values[q]; });
}

std::vector<std::size_t> Ensemble::variants_of(std::size_t line) const {
    std::vector<std::size_t> found;
    for (std::size_t v = 0; v < variants.size(); ++v)
        if (variants[v].line == line) found.push_back(v);
    return found;
}

std::string Ensemble::caption(const EnsembleRun& run) const {
    std::string text;
    for (std::size_t k = 0; k < keys.size(); ++k)
        text += (text.empty() ? "" : ", ") + last_part(keys[k]) + " " + variants[run.variant].values[k];
    if (n_seeds > 0 || text.empty()) text += (text.empty() ? "seed " : ", seed ") + std::to_string(run.seed);
    return text;
}

std::string plain_name(const std::string& text) {
    std::string name;
    for (const char c : text) {
        const bool plain = std::isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '-';
        if (plain)
            name += c;
        else if (!name.empty() && name.back() != '_')
            name += '_';
    }
    return name;
}

std::vector<std::string> seed_overrides(const std::string& text) {
    static const std::regex form(R"((\d{1,18})(\.\.(\d{1,18}))?)");
    std::smatch part;
    if (text.empty()) return {};
    if (!std::regex_match(text, part, form))
        throw UserError("bad-value", "`--seeds " + text + "` is no number of seeds", "20, or 1..20");
    if (!part[2].matched) return {"sweep.seeds=" + text};
    const long long first = std::stoll(part[1]), last = std::stoll(part[3]);
    if (last < first)
        throw UserError("bad-value", "`--seeds " + text + "`: the last one is before the first", "20, or 1..20");
    return {"seed=" + std::to_string(first), "sweep.seeds=" + std::to_string(last - first + 1)};
}

SweepKey sweep_key(const std::string& set) {
    const std::size_t equals = set.find('=');
    if (equals == std::string::npos || equals == 0)
        throw UserError("bad-override", "`" + set + "` is not of the form KEY=VALUE or KEY=VALUE,VALUE,...",
                        "for example mesh.size=1 mm,2 mm");
    SweepKey found{.key = set.substr(0, equals)};
    char quote = 0;
    int depth = 0;
    std::size_t begin = equals + 1;
    const auto end_value = [&](std::size_t end) {
        found.values.emplace_back(trimmed(std::string_view(set).substr(begin, end - begin)));
        begin = end + 1;
    };
    for (std::size_t at = begin; at < set.size(); ++at) {
        const char c = set[at];
        if (quote == '"' && c == '\\')
            ++at;  // \" ends no text
        else if (quote)
            quote = c == quote ? 0 : quote;
        else if (c == '"' || c == '\'')
            quote = c;
        else if (c == '[' || c == '{')
            ++depth;
        else if (c == ']' || c == '}')
            --depth;
        else if (c == ',' && depth == 0)
            end_value(at);
    }
    end_value(set.size());
    return found;
}

Ensemble plan_study(const std::string& scenario, const Texts& overrides) {
    const ReadResult read = open_scenario(scenario, overrides);
    const StudyOptions& options = read.scenario.study;
    Ensemble study{.kind = "study",
                   .name = read.scenario.name,
                   .record = resolved_for_run(read),
                   .keys = {"line", "level"},
                   .n_seeds = static_cast<std::size_t>(options.n_seeds),
                   .quantities = options.quantities,
                   .study = options};
    check_quantities(options.quantities);
    // errors need events to the step; statistics can do with the lines that the scenario writes
    Texts common =
        options.n_seeds > 0 ? Texts{} : Texts{"output.history_every=" + shortest(1e-9 * read.scenario.time.end)};
    append(common, overrides);
    append(common, options.set);
    for (std::size_t i = 0; i < options.lines.size(); ++i) {
        StudyLine& line = study.study.lines[i];
        Texts of_line = common;
        append(of_line, line.set);
        // a single run draws no figures, is bound to no [expect], which a coarse run may miss, and is no study
        append(of_line, {"output.fields=false", "figure=", "expect=", "study=", "sweep="});
        const Scenario base = open_scenario(scenario, of_line).scenario;
        if (i == 0) study.title = base.title;
        if (line.name.empty()) line.name = scheme_name(base.time.scheme);
        std::sort(line.levels.begin(), line.levels.end());
        for (const double level : line.levels) {
            Variant variant{.name = plain_name(line.name) + "_r" + shortest(level),
                            .values = {line.name, shortest(level)},
                            .overrides = of_line,
                            .line = i,
                            .level = level};
            if (options.refine != Refine::mesh)
                refine_step(base, level, options.refine == Refine::both, variant.overrides);
            if (options.refine != Refine::step) refine_mesh(base, level, variant.overrides);
            study.variants.push_back(std::move(variant));
        }
    }
    add_runs(scenario, study);
    return study;
}

Ensemble plan_sweep(const std::string& scenario, const Texts& overrides) {
    // --set may vary what the scenario does not; what [sweep] says is read without it
    std::vector<SweepKey> given, keys;
    add_keys(overrides, given);
    Texts single;
    for (const SweepKey& key : given)
        if (key.values.size() == 1) single.push_back(key.key + "=" + key.values.front());
    const Scenario base = open_scenario(scenario, single).scenario;
    Ensemble sweep{.kind = "sweep",
                   .name = base.name,
                   .title = base.title,
                   .record = "# knap sweep " + quoted_for_shell(scenario),
                   .n_seeds = static_cast<std::size_t>(base.sweep.n_seeds)};
    for (const std::string& set : overrides) sweep.record += " -s " + quoted_for_shell(set);
    sweep.record += "\n";
    for (const std::string& name : base.sweep.quantities)
        sweep.quantities.push_back({.name = name, .of = name, .unit = std::string(unit_of("summary", name))});
    add_keys(base.sweep.set, keys);
    add_keys(overrides, keys);
    Texts common;
    std::erase_if(keys, [&](const SweepKey& key) {
        if (key.values.size() == 1 && !key.key.starts_with("sweep"))
            common.push_back(key.key + "=" + key.values.front());
        return key.values.size() == 1 || key.key.starts_with("sweep");
    });
    for (const SweepKey& key : keys) sweep.keys.push_back(key.key);
    sweep.variants = combinations(keys, sweep.n_seeds);
    sweep.sheet = sheet_figure(base, base.sweep.show);
    // a single run keeps what its panel needs, is bound to no [expect], and is no sweep; breaks go on being noted
    const std::string figure =
        "figure=[{ file = \"" + sweep.sheet.file + "\", show = \"" + sweep.sheet.show + "\", panel = true }]";
    Texts last{"output.fields=false", figure, "expect=", "study=", "sweep="};
    if (base.output.breaks) last.emplace_back("output.breaks=true");
    for (Variant& variant : sweep.variants) {
        variant.overrides.insert(variant.overrides.begin(), common.begin(), common.end());
        append(variant.overrides, last);
    }
    add_runs(scenario, sweep);
    return sweep;
}

}  // namespace knap
