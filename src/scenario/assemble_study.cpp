// [study].
#include <algorithm>

#include "observe/history_columns.hpp"
#include "observe/probes.hpp"
#include "observe/reactions.hpp"
#include "scenario/assemble.hpp"
#include "scenario/units.hpp"

namespace knap {
namespace {

bool in_summary(const std::string& name) { return find_output("summary", name) != nullptr; }

/// Columns of the histories that the run will have.
std::vector<std::string> history_columns(const Scenario& scenario) {
    std::vector<std::string> names = names_of(energy_columns());
    const auto add = [&](const std::vector<std::string>& more) { names.insert(names.end(), more.begin(), more.end()); };
    add(names_of(crack_columns()));
    std::vector<std::string> loads, obstacles;
    for (const Load& load : scenario.loads)
        if (load.drives()) loads.push_back(load.name);
    for (const Obstacle& obstacle : scenario.obstacles) obstacles.push_back(obstacle.name);
    add(reaction_columns(loads, obstacles));
    if (scenario.specimen) add({"stress", "axial_strain", "tensile_breaks", "shear_breaks"});
    if (scenario.specimen && scenario.specimen->lateral) add({"lateral_strain"});
    if (scenario.specimen && scenario.specimen->lateral && scenario.specimen->test == SpecimenOptions::Test::compression) add({"volumetric_strain"});
    for (const ProbeOptions& probe : scenario.probes) add(probe_columns(probe));
    return names;
}

/// "strain at 10us", "glue_opening reaches 0.0001"
std::string name_of(const StudyQuantity& quantity) {
    if (quantity.at) return quantity.of + " at " + shortest(*quantity.at) + " s";
    if (quantity.reaches) return quantity.of + (quantity.since.empty() ? "" : " after " + quantity.since) + " reaches " + shortest(*quantity.reaches);
    if (quantity.slope) return "slope of " + quantity.of + " from " + shortest((*quantity.slope)[0]) + " s to " + shortest((*quantity.slope)[1]) + " s";
    return quantity.largest ? "largest " + quantity.of : quantity.of;
}

void check_quantity(const Assembly& assembly, const std::string& path, const StudyQuantity& quantity) {
    const std::vector<std::string> columns = history_columns(assembly.scenario);
    const bool is_column = std::find(columns.begin(), columns.end(), quantity.of) != columns.end();
    const int n = (quantity.at ? 1 : 0) + (quantity.reaches ? 1 : 0) + (quantity.largest ? 1 : 0) + (quantity.slope ? 1 : 0);
    if (n > 1) assembly.findings.error("exclusive-keys", "`" + path + "` has more than one of at, reaches, largest and slope", assembly.at(path));
    if (quantity.slope && (*quantity.slope)[0] >= (*quantity.slope)[1])
        assembly.findings.error("bad-interval", "`" + path + ".slope` must go from an earlier to a later time", assembly.at(path + ".slope"));
    if (!quantity.since.empty() && !quantity.reaches)
        assembly.findings.error("missing-key", "`" + path + ".since` needs reaches", assembly.at(path + ".since")).note = "the value whose times are compared";
    if (!quantity.since.empty() && std::find(columns.begin(), columns.end(), quantity.since) == columns.end())
        assembly.unknown_name(path + ".since", "column of a history", quantity.since, columns);
    if (!is_column && n == 0 && in_summary(quantity.of)) assembly.check_summary_number(path + ".of", quantity.of);
    if (is_column || (n == 0 && in_summary(quantity.of))) return;
    std::vector<std::string> known = columns;
    if (n == 0)
        for (const Output& row : output_table("summary").rows) known.emplace_back(row.name);
    assembly.unknown_name(path + ".of", n == 0 ? "number or column" : "column of a history", quantity.of, known);
}

StudyQuantity quantity_at(const Assembly& assembly, const std::string& path) {
    const Values& values = assembly.values;
    StudyQuantity quantity{.of = values.text(path + ".of").value_or(""),
                           .at = values.number(path + ".at"),
                           .reaches = values.number(path + ".reaches"),
                           .since = values.text(path + ".since").value_or(""),
                           .largest = values.flag(path + ".largest").value_or(false),
                           .exact = values.number(path + ".exact"),
                           .scale = values.number(path + ".scale")};
    if (const auto times = values.pair(path + ".slope")) quantity.slope = {times->x(), times->y()};
    if (values.has(path + ".of")) check_quantity(assembly, path, quantity);
    quantity.name = values.text(path + ".name").value_or(name_of(quantity));
    return quantity;
}

StudyQuantity of_summary(const std::string& name) { return {.name = name, .of = name}; }

void assemble_quantities(Assembly& assembly) {
    std::vector<StudyQuantity>& quantities = assembly.scenario.study.quantities;
    for (std::size_t i = 0; i < assembly.values.count("study.quantity"); ++i) quantities.push_back(quantity_at(assembly, item("study.quantity", i)));
    const std::vector<Expectation>& expect = assembly.scenario.expect;
    if (quantities.empty())
        for (const Expectation& expected : expect)
            if (expected.value && *expected.value != 0 && expected.unit.empty()) quantities.push_back(of_summary(expected.key));
    if (quantities.empty())
        for (const char* name : {"external_work", "dissipated", "strain_energy", "kinetic_energy"}) quantities.push_back(of_summary(name));
    for (StudyQuantity& quantity : quantities) {
        const bool summary = !quantity.from_history() && in_summary(quantity.of);
        quantity.unit = quantity.reaches ? "s" : std::string(summary ? unit_of("summary", quantity.of) : quantity.slope ? unit_of_slope(quantity.of) : unit_of_column(quantity.of));
        if (!summary || quantity.exact) continue;
        for (const Expectation& expected : expect)
            if (expected.key == quantity.of && expected.unit.empty()) quantity.exact = expected.value;
    }
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

/// A pair bulk/cohesion. The explicit bulk has a lumped mass, and steps below the stable one all along.
StudyLine line_of_scheme(const std::string& pair) {
    const std::string bulk = pair.substr(0, pair.find('/')), cohesion = pair.substr(pair.find('/') + 1);
    StudyLine line{.set = {"time.bulk=" + bulk, "time.cohesion=" + cohesion}};
    if (bulk == "explicit") line.set.insert(line.set.end(), {"time.step_cracking=", "time.mass="});
    return line;
}

void assemble_lines(Assembly& assembly) {
    const Values& values = assembly.values;
    StudyOptions& study = assembly.scenario.study;
    std::vector<std::string> schemes = texts(values, "study.schemes");
    if (std::find(schemes.begin(), schemes.end(), "all") != schemes.end())
        schemes = {"explicit/explicit", "explicit/implicit", "implicit/explicit", "implicit/implicit"};
    for (const std::string& pair : schemes) study.lines.push_back(line_of_scheme(pair));
    const std::size_t n = values.count("study.line");
    if (n > 0 && !schemes.empty())
        assembly.findings.error("exclusive-keys", "`study` has schemes and line, and only one of them can hold", assembly.at("study.schemes"));
    for (std::size_t i = 0; i < n; ++i) {
        const std::string path = item("study.line", i);
        study.lines.push_back({.name = values.text(path + ".name").value_or(""), .set = texts(values, path + ".set"), .levels = numbers(values, path + ".levels")});
    }
    if (study.lines.empty()) study.lines.emplace_back();
    std::vector<double> levels = numbers(values, "study.levels");
    if (levels.empty()) levels = study.n_seeds > 0 ? std::vector<double>{1} : std::vector<double>{1, 2, 4, 8};
    for (StudyLine& line : study.lines)
        if (line.levels.empty()) line.levels = levels;
}

}  // namespace

void assemble_study(Assembly& assembly) {
    const Values& values = assembly.values;
    StudyOptions& study = assembly.scenario.study;
    const std::string refine = values.text("study.refine").value_or("step");
    study.refine = refine == "mesh" ? Refine::mesh : refine == "both" ? Refine::both : Refine::step;
    if (study.refine != Refine::step && assembly.scenario.given)
        assembly.findings.error("exclusive-keys", "`study.refine` = \"" + refine + "\": a mesh that was read cannot be refined", assembly.at("study.refine"));
    study.n_seeds = values.has("study.seeds") ? static_cast<int>(values.find("study.seeds")->node.integer) : 0;
    study.against_finest = values.text("study.reference") == "finest";
    study.set = texts(values, "study.set");
    assemble_lines(assembly);
    assemble_quantities(assembly);
}

}  // namespace knap
