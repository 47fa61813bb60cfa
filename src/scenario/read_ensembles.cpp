// [study] and [sweep].
#include "analysis/crack_history.hpp"
#include "analysis/energy_ledger.hpp"
#include "analysis/probes.hpp"
#include "analysis/reactions.hpp"
#include "base/random.hpp"
#include "record/outputs.hpp"
#include "scenario/reading.hpp"
#include "scenario/units.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace knap {
namespace {

bool in_summary(const std::string& name) { return find_output("summary", name) != nullptr; }

StudyQuantity of_summary(const std::string& name) {
    return {.name = name, .of = name, .unit = std::string(unit_of("summary", name))};
}

/// Columns of the histories that the run will have.
std::vector<std::string> history_columns(const Scenario& scenario) {
    std::vector<std::string> names = names_of<EnergyRow>(energy_columns(scenario.works())), loads, obstacles;
    const auto add = [&](const std::vector<std::string>& more) { names.insert(names.end(), more.begin(), more.end()); };
    for (const Load& load : scenario.loads)
        if (load.drives()) loads.push_back(load.name);
    for (const Obstacle& obstacle : scenario.obstacles) obstacles.push_back(obstacle.name);
    add(names_of(crack_columns()));
    add(reaction_columns(loads, obstacles));
    if (scenario.specimen) add(names_of<SpecimenMoment>(stress_strain_columns(*scenario.specimen)));
    for (const ProbeOptions& probe : scenario.probes) add(probe_columns(probe));
    return names;
}

/// "strain at 1e-05 s", "glue_opening reaches 0.0001"
std::string name_of(const StudyQuantity& q) {
    if (q.at) return q.of + " at " + shortest(*q.at) + " s";
    if (q.reaches) return q.of + (q.since.empty() ? "" : " after " + q.since) + " reaches " + shortest(*q.reaches);
    if (q.slope)
        return "slope of " + q.of + " from " + shortest((*q.slope)[0]) + " s to " + shortest((*q.slope)[1]) + " s";
    return q.largest ? "largest " + q.of : q.of;
}

std::string unit_of_quantity(const StudyQuantity& q) {
    if (q.reaches) return "s";
    if (!q.from_history() && in_summary(q.of)) return std::string(unit_of("summary", q.of));
    return std::string(q.slope ? unit_of_slope(q.of) : unit_of_column(q.of));
}

void check_quantity(const Table& table, const StudyQuantity& q) {
    Reading& reading = table.reading();
    std::vector<std::string> columns = history_columns(table.scenario());
    const auto check_column = [&](const char* key, const std::string& name) {
        reading.find(table.path(key), "column of a history", name, columns);
    };
    if (q.at.has_value() + q.reaches.has_value() + q.largest + q.slope.has_value() > 1)
        table.error("exclusive-keys", "", "has more than one of at, reaches, largest and slope");
    if (q.slope && (*q.slope)[0] >= (*q.slope)[1])
        table.error("bad-interval", "slope", "must go from an earlier to a later time");
    if (!q.since.empty() && !q.reaches)
        table.error("missing-key", "since", "needs reaches", "the value whose times are compared");
    if (!q.since.empty()) check_column("since", q.since);
    if (q.from_history()) return check_column("of", q.of);
    if (std::ranges::count(columns, q.of) > 0) return;
    if (in_summary(q.of)) return reading.check_summary_number(table.path("of"), q.of);
    for (const Output& row : output_table("summary").rows) columns.emplace_back(row.name);
    reading.find(table.path("of"), "number or column", q.of, columns);
}

std::vector<StudyQuantity> study_quantities(Reading& reading) {
    std::vector<StudyQuantity> quantities;
    for (const Table& table : reading.list("study.quantity")) {
        StudyQuantity& quantity = quantities.emplace_back();
        table.fill(quantity);
        if (table.has("of")) check_quantity(table, quantity);
        if (!table.has("name")) quantity.name = name_of(quantity);
        quantity.unit = unit_of_quantity(quantity);
    }
    const std::vector<Expectation>& expect = reading.scenario.expect;
    if (quantities.empty())
        for (const Expectation& expected : expect)
            if (expected.value && *expected.value != 0 && expected.unit.empty())
                quantities.push_back(of_summary(expected.key));
    if (quantities.empty())
        for (const char* name : {"external_work", "dissipated", "strain_energy", "kinetic_energy"})
            quantities.push_back(of_summary(name));
    for (StudyQuantity& quantity : quantities)
        for (const Expectation& expected : expect)
            if (!quantity.from_history() && in_summary(quantity.of) && expected.key == quantity.of &&
                expected.unit.empty() && !quantity.exact)
                quantity.exact = expected.value;
    return quantities;
}

/// A pair bulk/cohesion. The explicit bulk has a lumped mass and one step size.
StudyLine line_of_scheme(const std::string& pair) {
    const std::size_t slash = pair.find('/');
    StudyLine line{.set = {"time.bulk=" + pair.substr(0, slash), "time.cohesion=" + pair.substr(slash + 1)}};
    if (pair.starts_with("explicit/")) line.set.insert(line.set.end(), {"time.step_cracking=", "time.mass="});
    return line;
}

std::vector<StudyLine> study_lines(const Table& study, bool statistics) {
    std::vector<StudyLine> lines;
    std::vector<std::string> schemes = study.texts("schemes");
    if (std::ranges::count(schemes, "all") > 0)
        schemes = {"explicit/explicit", "explicit/implicit", "implicit/explicit", "implicit/implicit"};
    for (const std::string& pair : schemes) lines.push_back(line_of_scheme(pair));
    if (!study.list("line").empty() && !schemes.empty())
        study.error("exclusive-keys", "", "has schemes and line, of which only one is allowed");
    for (const Table& table : study.list("line")) table.fill(lines.emplace_back());
    if (lines.empty()) lines.emplace_back();
    const auto levels = study.get<std::vector<double>>("levels").value_or(statistics ? std::vector<double>{1}
                                                                                     : std::vector<double>{1, 2, 4, 8});
    for (StudyLine& line : lines)
        if (line.levels.empty()) line.levels = levels;
    return lines;
}

// ---- [sweep.random]

/// The row of a key that can be drawn; null, and an error, where it cannot.
const Key* check_drawn_key(const Table& table, const std::string& path, const char* at = "key") {
    const Key* key = key_at(path);
    const Node* there = &table.reading().values.root;
    std::string above;
    for (const PathPart& part : path_parts(path).value_or(std::vector<PathPart>{})) {
        const Node* below = find_part(const_cast<Node&>(*there), part);
        if (!below && there->type == Node::Type::array && key) {
            std::vector<std::string> names;
            for (const Node& entry : there->children)
                if (const Node* name = entry.find("name")) names.push_back(name->text);
            table.error("unknown-name", at, "= \"" + path + "\": there is no `" + part.name + "` in `" + above + "`",
                        names.empty() ? "there is none" : "known: " + first_of(names), did_you_mean(part.name, names));
            return nullptr;
        }
        if (!below) break;  // a key without a value
        there = below, above = joined_path(above, part.name);
    }
    if (key && !key->is_table() && !path.starts_with("sweep.") && !path.starts_with("study.")) return key;
    if (const std::string pair = pair_without_component(path); !pair.empty()) {
        table.error("unknown-key", at, "= \"" + path + "\": `" + pair + "` has the components x and y");
        return nullptr;
    }
    std::vector<std::string> known;
    for (const Key& each : keys())
        if (each.kind == Kind::number || each.kind == Kind::integer) known.push_back(each.path);
    table.error(key ? "out-of-range" : "unknown-key", at, "= \"" + path + "\" is not a key that can be drawn",
                "as body.boulder.velocity.x, seed", did_you_mean(pattern_of(path), known));
    return nullptr;
}

/// Values that a normal distribution has within two bounds.
double part_within(double mean, double deviation, const std::array<double, 2>& bounds) {
    const auto below = [&](double x) { return 0.5 * std::erfc((mean - x) / (deviation * std::sqrt(2.0))); };
    return below(bounds[1]) - below(bounds[0]);
}

/// The parameters of one distribution, and whether all its values are allowed.
void check_distribution(const Table& table, const Key& key, const std::string& name, const RandomKey& drawn) {
    using Distribution = RandomKey::Distribution;
    const auto [a, b] = drawn.of;
    if (drawn.distribution == Distribution::uniform && !(a < b || (drawn.whole && a == b)))
        return table.error("out-of-range", name, "does not ascend");
    if (drawn.distribution != Distribution::uniform && !(b > 0))
        return table.error("out-of-range", name, "has a standard deviation that is not positive");
    if (drawn.distribution == Distribution::lognormal && !(a > 0))
        return table.error("out-of-range", name, "has a mean that is not positive");
    std::array<double, 2> values{-infinity, infinity};  // that occur
    if (drawn.distribution == Distribution::uniform) values = drawn.of;
    if (drawn.distribution == Distribution::lognormal) values[0] = std::numeric_limits<double>::min();
    if (drawn.within) {
        const auto [low, high] = *drawn.within;
        if (!(low < high)) return table.error("out-of-range", "within", "does not ascend");
        values = {std::max(values[0], low), std::min(values[1], high)};
        const double variance = std::log(1 + b * b / (a * a));
        const double part =
            drawn.distribution == Distribution::normal
                ? part_within(a, b, values)
                : part_within(std::log(a) - 0.5 * variance, std::sqrt(variance),
                              {std::log(std::max(values[0], 1e-300)), std::log(std::max(high, 1e-300))});
        if (part < 1e-3)
            return table.error("out-of-range", "within", "holds less than a thousandth of the distribution");
    }
    const bool low = key.range.contains(values[0]) || (values[0] == -infinity && key.range.low == -infinity),
               high = key.range.contains(values[1]) || (values[1] == infinity && key.range.high == infinity);
    if (!low || !high)
        table.error("out-of-range", name,
                    "gives values that `" + drawn.key + "` cannot have: it must be " + key.range.text(),
                    drawn.distribution == Distribution::uniform ? "" : "within = [smallest, largest]");
}

/// Warns of numbers that are chosen from and that the key cannot have: members that draw them are refused.
void check_choices(const Table& table, const char* at, const Key& key, const RandomKey& drawn) {
    if (key.kind != Kind::number && key.kind != Kind::integer) return;
    for (const std::string& choice : drawn.choices)
        if (const Quantity read = parse_quantity(choice); read.problem.empty() && !key.range.contains(read.value))
            return table.warning("out-of-range", at,
                                 "gives " + choice + ", which `" + drawn.key + "` cannot be: it must be " +
                                     key.range.text() + "; members that draw it are refused");
}

/// Adds a key that the key `at` of a table names, unless it has a value already.
void add_drawn_key(const Table& table, const char* at, RandomKey drawn, RandomMembers& random) {
    const auto is_it = [&](const RandomKey& other) { return other.key == drawn.key; };
    if (std::ranges::any_of(random.keys, is_it))
        table.error("duplicate-name", at, "= \"" + drawn.key + "\" is drawn twice");
    for (const std::string& set : table.scenario().sweep.set)
        if (trimmed(std::string_view(set).substr(0, set.find('='))) == drawn.key)
            table.error("exclusive-keys", at, "= \"" + drawn.key + "\" is a key of sweep.set, too");
    random.keys.push_back(std::move(drawn));
}

void read_drawn_key(const Table& table, RandomMembers& random) {
    using Distribution = RandomKey::Distribution;
    RandomKey drawn;
    table.fill(drawn);
    const std::vector<std::string> names{"uniform", "normal", "lognormal", "choice"};
    const auto name = table.one_of(names, true);
    if (!table.has("key")) return;
    const Key* key = check_drawn_key(table, drawn.key);
    if (!key || !name) return;
    const bool number = key->kind == Kind::integer || (key->kind == Kind::number && key->unit != "*"),
               component = key->form == Form::pair && pattern_of(drawn.key) != key->path;
    if (*name != "choice" && !(number && (key->form == Form::one || component)))
        return table.error("wrong-type", *name, "needs a key of one number, and `" + drawn.key + "` has another value",
                           key->form == Form::pair ? drawn.key + ".x, its component" : "choice = [...]");
    if (!table.has(*name)) return;
    drawn.distribution = static_cast<Distribution>(std::ranges::find(names, *name) - names.begin());
    drawn.whole = key->kind == Kind::integer;
    drawn.unit = key->has_fixed_unit() ? key->unit : "";
    if (const auto of = table.get<std::array<double, 2>>(*name); of && *name != "choice") drawn.of = *of;
    drawn.within = table.get<std::array<double, 2>>("within");
    const bool has_tails = *name == "normal" || *name == "lognormal";
    if (table.given("within") && !has_tails) table.error("exclusive-keys", "within", "belongs to normal and lognormal");
    if (*name != "choice") check_distribution(table, *key, *name, drawn);
    else check_choices(table, "choice", *key, drawn);
    add_drawn_key(table, "key", std::move(drawn), random);
}

/// The columns of a csv file whose names are keys, as `interface.default.sigma_c [Pa]`: a member draws a whole line.
void read_drawn_lines(const Table& table, RandomMembers& random) {
    const auto bytes = table.bytes_of("file");
    if (!bytes) return;
    bool is_refused = false;
    const auto refuse = [&](const std::string& problem, int number) {
        table.error_in_file("bad-csv", "file", *bytes, number, problem,
                            "first line: KEY [UNIT], KEY [UNIT], ...; each other one: their values");
        is_refused = true;
        return false;
    };
    std::vector<RandomKey> columns;
    for_each_line(*bytes, [&](int number, std::string_view line) {
        const std::vector<std::string> cells = cells_of(line, ",");
        const bool names = columns.empty();
        if (!names && cells.size() != columns.size())
            return refuse("this line has " + std::to_string(cells.size()) + " values for " +
                              std::to_string(columns.size()) + " keys",
                          number);
        for (std::size_t i = 0; i < cells.size(); ++i) {
            if (names) {
                RandomKey& column = columns.emplace_back();
                const std::size_t bracket = cells[i].ends_with(']') ? cells[i].find(" [") : std::string::npos;
                column.key = trimmed(cells[i].substr(0, bracket));
                if (bracket != std::string::npos)
                    column.unit = cells[i].substr(bracket + 2, cells[i].size() - bracket - 3);
                column.distribution = RandomKey::Distribution::choice;
                column.stream = "line of file";
                if (!check_drawn_key(table, column.key, "file")) is_refused = true;
                if (is_refused) return false;
                continue;
            }
            const Quantity value = parse_quantity(cells[i]);
            if (!value.problem.empty() || !value.unit.empty())
                return refuse("`" + cells[i] + "` of `" + columns[i].key + "` is not a number", number);
            columns[i].choices.push_back(cells[i] + (columns[i].unit.empty() ? "" : " " + columns[i].unit));
        }
        return true;
    });
    if (!is_refused && (columns.empty() || columns.front().choices.empty()))
        refuse("the file has no line of values", 0);
    if (is_refused) return;
    table.scenario().files.push_back({table.path("file"), "members.csv", *bytes});
    for (RandomKey& column : columns) {
        check_choices(table, "file", *key_at(column.key), column);
        add_drawn_key(table, "file", std::move(column), random);
    }
}

void read_members(Reading& reading) {
    const Table table = reading.table("sweep.random");
    RandomMembers& random = reading.scenario.sweep.random;
    table.compute("seed", Node::of_integer(static_cast<int>(reading.scenario.seed)));
    table.fill(random);
    if (table.has("file")) read_drawn_lines(table, random);
    for (const Table& vary : table.list("vary")) read_drawn_key(vary, random);
    if (table.list("vary").empty() && !table.has("file"))
        table.error("missing-key", "vary", "is missing: all members would be the same",
                    "[[sweep.random.vary]], or file = \"posterior.csv\"");
    if (reading.table("sweep").given("seeds"))
        reading.table("sweep").error("exclusive-keys", "seeds", "belongs to a sweep without random members",
                                     "draw the key `seed`: [[sweep.random.vary]] with key = \"seed\"");
}

void read_safety(const Table& table, SafetyOptions& safety) {
    table.fill(safety);
    std::vector<std::string> known;
    for (const NamedLaw& named : table.scenario().laws) known.push_back(named.name);
    for (const std::string& name : safety.laws) table.reading().find(table.path("laws"), "interface law", name, known);
    if (!(safety.factors[0] < safety.factors[1])) table.error("out-of-range", "factors", "does not ascend");
}

}  // namespace

std::string RandomKey::drawn(std::uint64_t seed, int member) const {
    constexpr int most_draws = 1'000'000;  // at least a thousandth of the distribution is within the bounds
    Random random(seed, "member " + std::to_string(member) + " " + (stream.empty() ? key : stream));
    if (distribution == Distribution::choice)
        return choices[std::min(static_cast<std::size_t>(random.uniform() * static_cast<double>(choices.size())),
                                choices.size() - 1)];
    const auto value = [&] {
        switch (distribution) {
            case Distribution::normal: return of[0] + of[1] * random.normal();
            case Distribution::lognormal: return of[0] * random.lognormal(of[1] / of[0]);
            default:
                return whole ? of[0] + std::floor(random.uniform() * (of[1] - of[0] + 1))
                             : random.uniform(of[0], of[1]);
        }
    };
    double x = value();
    for (int i = 0; within && !(x >= (*within)[0] && x <= (*within)[1]) && i < most_draws; ++i) x = value();
    return shortest(whole ? std::round(x) : x);
}

void read_study(Reading& reading) {
    const Table table = reading.table("study");
    StudyOptions& study = reading.scenario.study;
    table.fill(study);
    if (study.refine != Refine::step && reading.scenario.given)
        table.error("exclusive-keys", "refine", "= \"" + table.text("refine") + "\", but a mesh file cannot be refined",
                    "refine = \"step\"");
    read_safety(table.table("safety"), study.safety);
    study.lines = study_lines(table, study.n_seeds > 0);
    study.quantities = study_quantities(reading);
}

void read_sweep(Reading& reading) {
    const Table table = reading.table("sweep");
    SweepOptions& sweep = reading.scenario.sweep;
    const bool has_members = reading.table("sweep.random").given();
    if (!has_members) table.compute("show", Node::of_text("cracks"));
    else sweep.show = "";
    table.fill(sweep);
    if (has_members) read_members(reading);
    for (const std::string& name : sweep.quantities) reading.check_summary_number(table.path("quantities"), name);
    if (!sweep.quantities.empty()) return;
    if (reading.scenario.specimen) sweep.quantities = {"peak_stress", "tangent_modulus"};
    sweep.quantities.insert(sweep.quantities.end(), {"broken_length", "dissipated", "fragments"});
    for (const CollectorOptions& collector : reading.scenario.collectors)
        for (const char* number : {"_passages", "_largest_energy", "_largest_height"})
            sweep.quantities.push_back(collector.name + number);
}

}  // namespace knap
