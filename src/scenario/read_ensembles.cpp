// [study] and [sweep].
#include "analysis/crack_history.hpp"
#include "analysis/energy_ledger.hpp"
#include "analysis/probes.hpp"
#include "analysis/reactions.hpp"
#include "record/outputs.hpp"
#include "scenario/reading.hpp"

#include <algorithm>

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

}  // namespace

void read_study(Reading& reading) {
    const Table table = reading.table("study");
    StudyOptions& study = reading.scenario.study;
    table.fill(study);
    if (study.refine != Refine::step && reading.scenario.given)
        table.error("exclusive-keys", "refine", "= \"" + table.text("refine") + "\", but a mesh file cannot be refined",
                    "refine = \"step\"");
    study.lines = study_lines(table, study.n_seeds > 0);
    study.quantities = study_quantities(reading);
}

void read_sweep(Reading& reading) {
    const Table table = reading.table("sweep");
    SweepOptions& sweep = reading.scenario.sweep;
    table.fill(sweep);
    for (const std::string& name : sweep.quantities) reading.check_summary_number(table.path("quantities"), name);
    if (!sweep.quantities.empty()) return;
    if (reading.scenario.specimen) sweep.quantities = {"peak_stress", "tangent_modulus"};
    sweep.quantities.insert(sweep.quantities.end(), {"broken_length", "dissipated", "fragments"});
}

}  // namespace knap
