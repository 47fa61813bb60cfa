// The runs of a study and of a sweep.
#include "app/ensemble/ensemble.hpp"
#include "app/run/continuation.hpp"
#include "app/run/report.hpp"
#include "app/setup/step_plan.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "record/html.hpp"
#include "record/outputs.hpp"

#include <algorithm>
#include <regex>
#include <set>

namespace knap {
namespace {

using Texts = std::vector<std::string>;

constexpr double max_runs = 100'000;  // each is resolved before the first one starts, in about a millisecond
constexpr std::size_t max_directory_name = 120, max_quantity_name = 150;

void append(Texts& all, const Texts& more) { all.insert(all.end(), more.begin(), more.end()); }

/// Resolves a run: what it is, and its smallest mesh size.
void read_run(const std::string& scenario, EnsembleRun& run) {
    const ReadResult read = open_scenario(scenario, run.overrides);
    run.seed = read.scenario.seed;
    run.resolved = resolved_for_run(read);
    if (read.scenario.given) return;
    run.mesh_size = read.scenario.mesh.size;
    for (const auto& place : read.scenario.mesh.refine) run.mesh_size = std::min(run.mesh_size, place.size);
    for (const Body& body : read.scenario.bodies) run.mesh_size = std::min(run.mesh_size, body.mesh.size);
    if (read.scenario.adapt.active()) run.mesh_size = read.scenario.adapt.size;
}

}  // namespace

void add_runs(const std::string& scenario, Ensemble& ensemble, std::size_t first_variant) {
    const bool seeds = ensemble.n_seeds > 0;
    std::set<std::string> names;
    for (std::size_t v = first_variant; v < ensemble.variants.size(); ++v) {
        const Variant& variant = ensemble.variants[v];
        const std::uint64_t first_seed = seeds ? open_scenario(scenario, variant.overrides).scenario.seed : 0;
        for (std::size_t s = 0; s < ensemble.n_each(); ++s) {
            EnsembleRun run{.variant = v, .name = variant.name, .overrides = variant.overrides};
            for (const RandomKey& random : ensemble.random.keys) {
                run.drawn.push_back(random.drawn(ensemble.random.seed, static_cast<int>(s) + 1));
                run.overrides.push_back(random.key + "=" + run.drawn.back());
            }
            if (seeds) run.overrides.push_back("seed=" + std::to_string(first_seed + s));
            try {
                read_run(scenario, run);
            } catch (const UserError& error) {  // what is drawn may lie in another body
                if (ensemble.random.n == 0) throw;
                run.refusal = error.diagnostics.front().message;
            }
            if (ensemble.random.n > 0) run.name += (run.name.empty() ? "m" : "_m") + std::to_string(s + 1);
            else if (seeds || run.name.empty()) run.name += (run.name.empty() ? "s" : "_s") + std::to_string(run.seed);
            if (run.name.size() > max_directory_name) run.name = "run_" + std::to_string(ensemble.runs.size() + 1);
            if (!names.insert(run.name).second)
                throw UserError("duplicate-name", "two runs would be called `" + run.name + "`",
                                "give every value once, and every line a name of its own");
            ensemble.runs.push_back(std::move(run));
        }
    }
    const auto is_refused = [](const EnsembleRun& run) { return !run.refusal.empty(); };
    if (std::ranges::all_of(ensemble.runs, is_refused)) read_run(scenario, ensemble.runs.front());  // throws
}

namespace {

// ---- study

/// Overrides that divide the steps or the sizes of the mesh by `level`. Steps in multiples of the stable step follow a
/// refined mesh without that.
Texts refined(const Scenario& base, Refine refine, double level) {
    Texts set;
    const TimeOptions& time = base.time;
    const auto divide = [&](const char* key, const StepLength& step) {
        if (refine == Refine::mesh || step.value == 0 || (refine == Refine::both && step.of_stable_step)) return;
        set.push_back(std::string(key) + "=" + shortest(step.value / level) + (step.of_stable_step ? " CFL" : ""));
    };
    const StepLength automatic = automatic_step(time);
    divide("time.step", time.step.value > 0 ? time.step : automatic);
    divide("time.step_cracking", time.step_cracking);
    divide("time.step_min", time.step_min);
    if (refine == Refine::step) return set;
    set.push_back("mesh.size=" + shortest(base.mesh.size / level));
    for (std::size_t i = 0; i < base.mesh.refine.size(); ++i)
        set.push_back(item("mesh.refine", i) + ".size=" + shortest(base.mesh.refine[i].size / level));
    if (base.adapt.active()) set.push_back("adapt.size=" + shortest(base.adapt.size / level));
    for (const Body& body : base.bodies)
        if (const std::string key = body.path + ".mesh_size="; body.own_mesh_size && !set.back().starts_with(key))
            set.push_back(key + shortest(body.mesh.size / level));
    return set;
}

std::string scheme_name(const SchemeOptions& scheme) {
    if (scheme.bulk == BulkScheme::automatic) return name_of(scheme.bulk);
    return std::string(name_of(scheme.bulk)) + ", " + name_of(scheme.cohesion);
}

/// The name of a quantity is part of the names of its figures.
void check_names(const std::vector<StudyQuantity>& quantities) {
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

/// A later text replaces an earlier one of the same key.
void add_keys(const Texts& set, std::vector<SweepKey>& keys) {
    for (const std::string& text : set) {
        SweepKey key = sweep_key(text);
        std::erase_if(keys, [&](const SweepKey& earlier) { return earlier.key == key.key; });
        keys.push_back(std::move(key));
    }
}

std::string last_part(const std::string& key) { return key.substr(key.rfind('.') + 1); }

/// free, 80 um of ["free", "80 um"]: a value for readers.
std::string without_quotes(std::string value) {
    std::erase_if(value, [](char c) { return c == '"' || c == '\''; });
    if (value.starts_with('[') && value.find(']') + 1 == value.size()) value = value.substr(1, value.size() - 2);
    return value;
}

/// All combinations of the values; the last key varies fastest.
std::vector<Variant> combinations(const std::vector<SweepKey>& keys, std::size_t n_each) {
    double n_runs = static_cast<double>(n_each);
    for (const SweepKey& key : keys) n_runs *= static_cast<double>(key.values.size());
    if (n_runs > max_runs)
        throw UserError("too-many-runs", "this sweep has " + shortest(n_runs) + " runs",
                        "at most " + shortest(max_runs) + "; use fewer values or seeds, or several sweeps");
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
    const std::size_t n = n_each();
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
    Texts parts;
    for (std::size_t k = 0; k < keys.size(); ++k)
        parts.push_back(last_part(keys[k]) + " " + without_quotes(variants[run.variant].values[k]));
    if (random.n > 0) parts.push_back(run.name);
    else if (n_seeds > 0 || parts.empty()) parts.push_back("seed " + std::to_string(run.seed));
    return joined(parts);
}

std::string plain_name(const std::string& text) {
    std::string name;
    for (const char c : text)
        if (c != '_' && is_plain(c)) name += c;
        else if (!name.empty() && name.back() != '_') name += '_';
    return name;
}

Texts seed_overrides(const std::string& text) {
    static const std::regex form(R"((\d{1,18})(\.\.(\d{1,18}))?)");
    std::smatch part;
    if (text.empty()) return {};
    if (!std::regex_match(text, part, form))
        throw UserError("bad-value", "`--seeds " + text + "` is not a number of seeds", "20, or 1..20");
    if (!part[2].matched) return {"sweep.seeds=" + text};
    const long long first = std::stoll(part[1]), last = std::stoll(part[3]);
    if (last < first)
        throw UserError("bad-value", "`--seeds " + text + "`: the last one is before the first", "20, or 1..20");
    return {"seed=" + std::to_string(first), "sweep.seeds=" + std::to_string(last - first + 1)};
}

SweepKey sweep_key(const std::string& set) {
    const std::size_t equals = set.find('=');
    if (equals == set.npos || equals == 0)
        throw UserError("bad-override", "`" + set + "` is not of the form KEY=VALUE or KEY=VALUE,VALUE,...",
                        "for example mesh.size=1 mm,2 mm");
    SweepKey found{.key = set.substr(0, equals), .values = {}};
    char quote = 0;
    int depth = 0;
    std::size_t start = equals + 1;
    const auto end_value = [&](std::size_t end) {
        found.values.emplace_back(trimmed(std::string_view(set).substr(start, end - start)));
        start = end + 1;
    };
    for (std::size_t at = start; at < set.size(); ++at) {
        const char c = set[at];
        if (quote == '"' && c == '\\') ++at;  // \" does not end a text
        else if (quote) quote = c == quote ? 0 : quote;
        else if (c == '"' || c == '\'') quote = c;
        else if (c == '[' || c == '{') ++depth;
        else if (c == ']' || c == '}') --depth;
        else if (c == ',' && depth == 0) end_value(at);
    }
    end_value(set.size());
    return found;
}

Texts report_of_runs(const Texts& overrides) {
    if (std::ranges::count(overrides, "output.report=true") > 0) return {};
    return {"output.report=false"};
}

Ensemble plan_study(const std::string& scenario, const Texts& overrides) {
    const ReadResult read = open_scenario(scenario, overrides);
    Ensemble study{.kind = "study",
                   .name = read.scenario.name,
                   .question = question_of(read.source.text()),
                   .report = read.scenario.output.report,
                   .record = resolved_for_run(read),
                   .keys = {"line", "level"},
                   .n_seeds = static_cast<std::size_t>(read.scenario.study.n_seeds),
                   .quantities = read.scenario.study.quantities,
                   .study = read.scenario.study};
    check_names(study.quantities);
    Texts common;
    // times of events must be known to the step for errors; statistics need only what the scenario writes
    if (study.n_seeds == 0) common = {"output.history_every=" + shortest(1e-9 * read.scenario.time.end)};
    append(common, overrides);
    append(common, study.study.set);
    for (std::size_t i = 0; i < study.study.lines.size(); ++i) {
        StudyLine& line = study.study.lines[i];
        Texts of_line = common;
        append(of_line, line.set);
        // the runs draw no figures, are no studies themselves, and may miss [expect], as coarse ones do
        append(of_line, {"output.fields=false", "figure=", "expect=", "study=", "sweep="});
        append(of_line, report_of_runs(overrides));
        const Scenario base = open_scenario(scenario, of_line).scenario;
        if (i == 0) study.title = base.title;
        if (line.name.empty()) line.name = scheme_name(base.time.scheme);
        std::ranges::sort(line.levels);
        for (const double level : line.levels) {
            Variant variant{.name = plain_name(line.name) + "_r" + shortest(level),
                            .values = {line.name, shortest(level)},
                            .overrides = of_line,
                            .line = i,
                            .level = level};
            append(variant.overrides, refined(base, study.study.refine, level));
            study.variants.push_back(std::move(variant));
        }
    }
    add_runs(scenario, study);
    return study;
}

Ensemble plan_sweep(const std::string& scenario, const Texts& overrides) {
    // [sweep] is read with the overrides of a single value; the others need not hold one after the other
    std::vector<SweepKey> given, keys;
    add_keys(overrides, given);
    Texts single;
    for (const SweepKey& key : given)
        if (key.values.size() == 1) single.push_back(key.key + "=" + key.values.front());
    const ReadResult read = open_scenario(scenario, single);
    const Scenario& base = read.scenario;
    Ensemble sweep{.kind = "sweep",
                   .name = base.name,
                   .title = base.title,
                   .question = question_of(read.source.text()),
                   .report = base.output.report,
                   .record = "# knap sweep " + quoted_for_shell(scenario),
                   .n_seeds = static_cast<std::size_t>(base.sweep.n_seeds),
                   .random = base.sweep.random,
                   .trajectories = base.output.trajectories,
                   .obstacles = base.obstacles,
                   .collectors = base.collectors};
    const auto is_free = [](const Obstacle& obstacle) { return obstacle.is_free(); };
    if (sweep.random.n > 0 && (base.large_rotation || std::ranges::any_of(base.obstacles, is_free)))
        sweep.trajectories = true;
    for (const std::string& set : overrides) sweep.record += " -s " + quoted_for_shell(set);
    sweep.record += "\n";
    for (const std::string& name : base.sweep.quantities)
        sweep.quantities.push_back({.name = name, .of = name, .unit = std::string(unit_of("summary", name))});
    add_keys(base.sweep.set, keys);
    add_keys(overrides, keys);
    Texts common;
    std::erase_if(keys, [&](const SweepKey& key) {
        const bool is_single = key.values.size() == 1, of_sweep = key.key.starts_with("sweep");
        if (is_single && !of_sweep) common.push_back(key.key + "=" + key.values.front());
        return is_single || of_sweep;
    });
    for (const SweepKey& key : keys) sweep.keys.push_back(key.key);
    sweep.variants = combinations(keys, sweep.n_each());

    // a panel of the contact sheet shows the end of a run as the scenario draws it
    const auto own = std::ranges::find(base.figures, base.sweep.show, &FigureOptions::show);
    sweep.sheet = own == base.figures.end() ? FigureOptions{.show = base.sweep.show} : *own;
    sweep.sheet.file = "sheet.png";
    sweep.sheet.at.clear();
    sweep.sheet.width = 800;
    sweep.sheet.panel = true;
    // the runs keep their last frame where a panel needs it, are no sweeps themselves, and may miss [expect]
    Texts last{"figure=", "expect=", "study=", "sweep="};
    append(last, shows_body(sweep.sheet.show) ? Texts{"output.fields=true", "output.frame_every=1e9"}
                                              : Texts{"output.fields=false"});
    append(last, report_of_runs(overrides));
    if (!base.sweep.show.empty()) {  // whether a run has what the panel shows
        append(single, {"figure=[{ file = \"sheet.png\", show = \"" + sweep.sheet.show + "\" }]"});
        open_scenario(scenario, single);
    }
    if (sweep.trajectories) last.emplace_back("output.trajectories=true");
    if (base.output.breaks || need_of_figure(sweep.sheet.show, sweep.sheet.colour) == FigureNeed::breaks)
        last.emplace_back("output.breaks=true");
    for (Variant& variant : sweep.variants) {
        variant.overrides.insert(variant.overrides.begin(), common.begin(), common.end());
        append(variant.overrides, last);
    }
    add_runs(scenario, sweep);
    return sweep;
}

}  // namespace knap
