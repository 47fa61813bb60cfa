// Which runs a sweep consists of.
#include "app/sweep.hpp"

#include "base/error.hpp"
#include "scenario/keys.hpp"
#include "scenario/units.hpp"

#include <algorithm>
#include <charconv>

namespace knap {
namespace {

using Overrides = std::vector<std::string>;

constexpr double most_runs = 100'000;  // each is resolved before the first begins, which takes about a millisecond

/// Later entries take the place of earlier ones for the same key.
void add_keys(const Overrides& set, std::vector<SweepKey>& keys) {
    for (const std::string& text : set) {
        SweepKey key = sweep_key(text);
        std::erase_if(keys, [&](const SweepKey& earlier) { return earlier.key == key.key; });
        keys.push_back(std::move(key));
    }
}

/// The one picture of a run, drawn as the scenario draws it.
std::string sheet_figure(const Scenario& scenario, const std::string& show) {
    const auto own = std::find_if(scenario.figures.begin(), scenario.figures.end(), [&](const FigureOptions& f) { return f.show == show; });
    const FigureOptions figure = own == scenario.figures.end() ? FigureOptions{} : *own;
    std::string text = "figure=[{ file = \"sheet.png\", show = \"" + show + "\", panel = true, width = 800, colour = \"" + figure.colour + "\", over = \"" + figure.over +
                       "\", deform = " + shortest(figure.deform) + ", aspect = " + shortest(figure.aspect);
    if (figure.range.size() == 2) text += ", range = [" + shortest(figure.range[0]) + ", " + shortest(figure.range[1]) + "]";
    if (figure.box) {
        const Box& box = *figure.box;
        text += ", box = [" + shortest(box.low.x()) + ", " + shortest(box.low.y()) + ", " + shortest(box.high.x()) + ", " + shortest(box.high.y()) + "]";
    }
    return text + " }]";
}

std::vector<StudyQuantity> quantities_of(const std::vector<std::string>& names) {
    std::vector<StudyQuantity> quantities;
    for (const std::string& name : names) {
        quantities.push_back({.name = name, .of = name, .unit = std::string(unit_of("summary", name))});
    }
    return quantities;
}

std::string directory_name(const SweepPlan& plan, const SweepRun& run) {
    std::string name;
    for (std::size_t k = 0; k < plan.keys.size(); ++k) name += (name.empty() ? "" : "_") + plain_name(plan.keys[k].name() + " " + run.values[k]);
    if (plan.has_seeds || name.empty()) name += (name.empty() ? "s" : "_s") + std::to_string(run.seed);
    return name.size() <= 120 ? name : "run_" + std::to_string(plan.runs.size() + 1);
}

void check_number(const SweepPlan& plan) {
    double n = static_cast<double>(plan.n_seeds);
    for (const SweepKey& key : plan.keys) n *= static_cast<double>(key.values.size());
    if (n > most_runs)
        throw UserError("too-many-runs", "this sweep has " + shortest(n) + " runs", "at most " + shortest(most_runs) + "; fewer values or seeds, or several sweeps");
}

/// All combinations of values, the last key fastest.
std::vector<std::vector<std::string>> product(const std::vector<SweepKey>& keys) {
    std::vector<std::vector<std::string>> all{{}};
    for (const SweepKey& key : keys) {
        std::vector<std::vector<std::string>> longer;
        for (const auto& values : all)
            for (const std::string& value : key.values) {
                longer.push_back(values);
                longer.back().push_back(value);
            }
        all = std::move(longer);
    }
    return all;
}

}  // namespace

std::string SweepKey::name() const { return key.substr(key.rfind('.') + 1); }

std::string SweepPlan::caption(const SweepRun& run) const {
    std::string text;
    for (std::size_t k = 0; k < keys.size(); ++k) text += (text.empty() ? "" : ", ") + keys[k].name() + " " + run.values[k];
    if (has_seeds || text.empty()) text += (text.empty() ? "seed " : ", seed ") + std::to_string(run.seed);
    return text;
}

std::vector<std::string> seed_overrides(const std::string& text) {
    if (text.empty()) return {};
    const auto whole = [&](const std::string& part) {
        std::uint64_t number = 0;
        const auto [end, problem] = std::from_chars(part.data(), part.data() + part.size(), number);
        if (problem != std::errc() || end != part.data() + part.size()) throw UserError("bad-value", "`--seeds " + text + "` is no number of seeds", "20, or 1..20");
        return number;
    };
    const std::size_t dots = text.find("..");
    if (dots == std::string::npos) return {"sweep.seeds=" + std::to_string(whole(text))};
    const std::uint64_t first = whole(text.substr(0, dots)), last = whole(text.substr(dots + 2));
    if (last < first) throw UserError("bad-value", "`--seeds " + text + "`: the last one is before the first", "20, or 1..20");
    return {"seed=" + std::to_string(first), "sweep.seeds=" + std::to_string(last - first + 1)};
}

SweepKey sweep_key(const std::string& set) {
    const std::size_t equals = set.find('=');
    if (equals == std::string::npos || equals == 0)
        throw UserError("bad-override", "`" + set + "` is not of the form KEY=VALUE or KEY=VALUE,VALUE,...", "for example mesh.size=1 mm,2 mm");
    SweepKey found{.key = set.substr(0, equals)};
    char quote = 0;
    int depth = 0;
    std::size_t begin = equals + 1;
    const auto end_value = [&](std::size_t end) { found.values.emplace_back(trimmed(std::string_view(set).substr(begin, end - begin))), begin = end + 1; };
    for (std::size_t at = begin; at < set.size(); ++at) {
        const char c = set[at];
        if (quote == '"' && c == '\\') ++at;  // \" ends no text
        else if (quote) quote = c == quote ? 0 : quote;
        else if (c == '"' || c == '\'') quote = c;
        else if (c == '[' || c == '{') ++depth;
        else if (c == ']' || c == '}') --depth;
        else if (c == ',' && depth == 0) end_value(at);
    }
    end_value(set.size());
    return found;
}

SweepPlan plan_sweep(const std::string& scenario, const Overrides& overrides) {
    // --set may vary what the scenario does not; what [sweep] says is read without it
    std::vector<SweepKey> given, keys;
    add_keys(overrides, given);
    Overrides common;
    for (const SweepKey& key : given)
        if (key.values.size() == 1) common.push_back(key.key + "=" + key.values.front());
    const ReadResult read = open_scenario(scenario, common);
    const SweepOptions& options = read.scenario.sweep;
    add_keys(options.set, keys);
    add_keys(overrides, keys);
    Overrides all;
    SweepPlan plan{.name = read.scenario.name, .title = read.scenario.title, .quantities = quantities_of(options.quantities)};
    for (SweepKey& key : keys) {
        if (key.key.starts_with("sweep")) continue;  // no matter of the single run
        if (key.values.size() == 1) all.push_back(key.key + "=" + key.values.front());
        else plan.keys.push_back(std::move(key));
    }
    plan.has_seeds = options.n_seeds > 0;
    plan.n_seeds = static_cast<std::size_t>(std::max(options.n_seeds, 1));
    check_number(plan);
    // what is not for the single run: its fields, its figures but one, its [expect], the sweep itself; breaks go on being noted
    Overrides bare{"output.fields=false", sheet_figure(read.scenario, options.show), "expect=", "study=", "sweep="};
    if (read.scenario.output.breaks) bare.push_back("output.breaks=true");
    for (const std::vector<std::string>& values : product(plan.keys))
        for (std::size_t s = 0; s < plan.n_seeds; ++s) {
            SweepRun run;
            run.values = values;
            run.seed = read.scenario.seed + s;
            run.overrides = all;
            for (std::size_t k = 0; k < values.size(); ++k) run.overrides.push_back(plan.keys[k].key + "=" + values[k]);
            run.overrides.insert(run.overrides.end(), bare.begin(), bare.end());
            if (plan.has_seeds) run.overrides.push_back("seed=" + std::to_string(run.seed));
            run.name = directory_name(plan, run);
            const ReadResult resolved = open_scenario(scenario, run.overrides);
            run.resolved = resolved_for_run(resolved);
            plan.sheet = resolved.scenario.figures.front();
            plan.runs.push_back(std::move(run));
        }
    check_names(batch_of(plan.runs), "give every value once");
    return plan;
}

}  // namespace knap
