// [study] and [sweep].
#include "analysis/history_columns.hpp"
#include "analysis/probes.hpp"
#include "analysis/reactions.hpp"
#include "record/outputs.hpp"
#include "scenario/reading.hpp"
#include "scenario/units.hpp"

#include <algorithm>

namespace knap {
namespace {

bool in_summary(const std::string& name) { return find_output("summary", name) != nullptr; }

StudyQuantity of_summary(const std::string& name) {
    return {.name = name, .of = name, .unit = std::string(unit_of("summary", name))};
}

std::vector<std::string> texts(const Values& values, const std::string& path) {
    std::vector<std::string> list;
    for (const Node* node : values.items(path)) list.push_back(node->text);
    return list;
}

std::vector<double> numbers(const Values& values, const std::string& path) {
    std::vector<double> list;
    for (const Node* node : values.items(path)) list.push_back(node->number);
    return list;
}

int integer_or_0(const Values& values, const std::string& path) {
    return values.has(path) ? static_cast<int>(values.find(path)->node.integer) : 0;
}

/// Columns of the histories that the run will have.
std::vector<std::string> history_columns(const Scenario& scenario) {
    std::vector<std::string> names = names_of(energy_columns()), loads, obstacles;
    const auto add = [&](const std::vector<std::string>& more) { names.insert(names.end(), more.begin(), more.end()); };
    for (const Load& load : scenario.loads)
        if (load.drives()) loads.push_back(load.name);
    for (const Obstacle& obstacle : scenario.obstacles) obstacles.push_back(obstacle.name);
    add(names_of(crack_columns()));
    add(reaction_columns(loads, obstacles));
    if (const auto& specimen = scenario.specimen) {
        add({"stress", "axial_strain", "tensile_breaks", "shear_breaks"});
        if (specimen->lateral) add({"lateral_strain"});
        if (specimen->lateral && specimen->test == SpecimenOptions::Test::compression) add({"volumetric_strain"});
    }
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

std::string quantity_unit(const StudyQuantity& q) {
    if (q.reaches) return "s";
    if (!q.from_history() && in_summary(q.of)) return std::string(unit_of("summary", q.of));
    return std::string(q.slope ? unit_of_slope(q.of) : unit_of_column(q.of));
}

void check_quantity(const Reading& reading, const std::string& path, const StudyQuantity& quantity) {
    Findings& findings = reading.findings;
    std::vector<std::string> columns = history_columns(reading.scenario);
    const auto is_column = [&](const std::string& name) {
        return std::find(columns.begin(), columns.end(), name) != columns.end();
    };
    if (quantity.at.has_value() + quantity.reaches.has_value() + quantity.largest + quantity.slope.has_value() > 1)
        findings.error("exclusive-keys", "`" + path + "` has more than one of at, reaches, largest and slope",
                       reading.at(path));
    if (quantity.slope && (*quantity.slope)[0] >= (*quantity.slope)[1])
        findings.error("bad-interval", "`" + path + ".slope` must go from an earlier to a later time",
                       reading.at(path + ".slope"));
    if (!quantity.since.empty() && !quantity.reaches)
        findings.error("missing-key", "`" + path + ".since` needs reaches", reading.at(path + ".since")).note =
            "the value whose times are compared";
    if (!quantity.since.empty() && !is_column(quantity.since))
        reading.unknown_name(path + ".since", "column of a history", quantity.since, columns);
    if (is_column(quantity.of)) return;
    if (quantity.from_history())
        return reading.unknown_name(path + ".of", "column of a history", quantity.of, columns);
    if (in_summary(quantity.of)) return reading.check_summary_number(path + ".of", quantity.of);
    for (const Output& row : output_table("summary").rows) columns.emplace_back(row.name);
    reading.unknown_name(path + ".of", "number or column", quantity.of, columns);
}

StudyQuantity quantity_at(const Reading& reading, const std::string& path) {
    const Values& values = reading.values;
    StudyQuantity quantity{.of = values.text(path + ".of").value_or(""),
                         .at = values.number(path + ".at"),
                         .reaches = values.number(path + ".reaches"),
                         .since = values.text(path + ".since").value_or(""),
                         .largest = values.flag(path + ".largest").value_or(false),
                         .exact = values.number(path + ".exact"),
                         .scale = values.number(path + ".scale")};
    if (const auto times = values.pair(path + ".slope")) quantity.slope = {times->x(), times->y()};
    if (values.has(path + ".of")) check_quantity(reading, path, quantity);
    quantity.name = values.text(path + ".name").value_or(name_of(quantity));
    quantity.unit = quantity_unit(quantity);
    return quantity;
}

std::vector<StudyQuantity> study_quantities(const Reading& reading) {
    std::vector<StudyQuantity> quantities;
    const std::vector<Expectation>& expect = reading.scenario.expect;
    for (std::size_t i = 0; i < reading.values.count("study.quantity"); ++i)
        quantities.push_back(quantity_at(reading, item("study.quantity", i)));
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

/// A pair bulk/cohesion. The explicit bulk has a lumped mass and no larger step before the crack runs.
StudyLine line_of_scheme(const std::string& pair) {
    const std::string bulk = pair.substr(0, pair.find('/')), cohesion = pair.substr(pair.find('/') + 1);
    StudyLine line{.set = {"time.bulk=" + bulk, "time.cohesion=" + cohesion}};
    if (bulk == "explicit") line.set.insert(line.set.end(), {"time.step_cracking=", "time.mass="});
    return line;
}

std::vector<StudyLine> study_lines(const Reading& reading, bool statistics) {
    const Values& values = reading.values;
    std::vector<StudyLine> lines;
    std::vector<std::string> schemes = texts(values, "study.schemes");
    if (std::find(schemes.begin(), schemes.end(), "all") != schemes.end())
        schemes = {"explicit/explicit", "explicit/implicit", "implicit/explicit", "implicit/implicit"};
    for (const std::string& pair : schemes) lines.push_back(line_of_scheme(pair));
    const std::size_t n = values.count("study.line");
    if (n > 0 && !schemes.empty())
        reading.findings.error("exclusive-keys", "`study` has schemes and line, and only one of them can hold",
                                reading.at("study.schemes"));
    for (std::size_t i = 0; i < n; ++i) {
        const std::string path = item("study.line", i);
        lines.push_back({values.text(path + ".name").value_or(""), texts(values, path + ".set"),
                         numbers(values, path + ".levels")});
    }
    if (lines.empty()) lines.emplace_back();
    std::vector<double> levels = numbers(values, "study.levels");
    if (levels.empty()) levels = statistics ? std::vector<double>{1} : std::vector<double>{1, 2, 4, 8};
    for (StudyLine& line : lines)
        if (line.levels.empty()) line.levels = levels;
    return lines;
}

}  // namespace

void read_study(Reading& reading) {
    const Values& values = reading.values;
    StudyOptions& study = reading.scenario.study;
    const std::string refine = values.text("study.refine").value_or("step");
    study.refine = refine == "mesh" ? Refine::mesh : refine == "both" ? Refine::both : Refine::step;
    if (study.refine != Refine::step && reading.scenario.given)
        reading.findings.error("exclusive-keys",
                                "`study.refine` = \"" + refine + "\": a mesh that was read cannot be refined",
                                reading.at("study.refine"));
    study.n_seeds = integer_or_0(values, "study.seeds");
    study.against_finest = values.text("study.reference") == "finest";
    study.set = texts(values, "study.set");
    study.lines = study_lines(reading, study.n_seeds > 0);
    study.quantities = study_quantities(reading);
}

void read_sweep(Reading& reading) {
    const Values& values = reading.values;
    SweepOptions& sweep = reading.scenario.sweep;
    sweep.set = texts(values, "sweep.set");
    sweep.n_seeds = integer_or_0(values, "sweep.seeds");
    sweep.show = values.text("sweep.show").value_or(sweep.show);
    sweep.quantities = texts(values, "sweep.quantities");
    for (const std::string& name : sweep.quantities) reading.check_summary_number("sweep.quantities", name);
    if (!sweep.quantities.empty()) return;
    if (reading.scenario.specimen) sweep.quantities = {"peak_stress", "tangent_modulus"};
    sweep.quantities.insert(sweep.quantities.end(), {"broken_length", "dissipated", "fragments"});
}

}  // namespace knap
