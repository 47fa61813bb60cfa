// [specimen], output.breaks, and what needs them: figures and expectations.
#include <algorithm>
#include <array>

#include "scenario/assemble.hpp"

namespace knap {
namespace {

using Test = SpecimenOptions::Test;
constexpr std::array tests{std::pair{"compression", Test::compression}, std::pair{"tension", Test::tension}, std::pair{"brazilian", Test::brazilian},
                           std::pair{"bending", Test::bending}};

/// What drives and can be named: obstacles, and loads that prescribe a motion.
std::vector<std::pair<std::string, GaugeEnd>> drivers(const Scenario& scenario) {
    std::vector<std::pair<std::string, GaugeEnd>> found;
    for (std::size_t i = 0; i < scenario.obstacles.size(); ++i)
        found.emplace_back(scenario.obstacles[i].name, GaugeEnd{.kind = GaugeEnd::Kind::obstacle, .number = static_cast<Index>(i)});
    for (std::size_t i = 0; i < scenario.loads.size(); ++i)
        if (scenario.loads[i].drives()) found.emplace_back(scenario.loads[i].name, GaugeEnd{.kind = GaugeEnd::Kind::load, .number = static_cast<Index>(i)});
    return found;
}

/// All that a gauge may end at.
std::vector<std::pair<std::string, GaugeEnd>> gauge_ends(const Scenario& scenario) {
    std::vector<std::pair<std::string, GaugeEnd>> found;
    for (const std::string& boundary : scenario.shape.boundary_names) found.emplace_back(boundary, GaugeEnd{.boundary = boundary});
    for (const ProbeOptions& probe : scenario.probes)
        if (!probe.interface) found.emplace_back(probe.name, GaugeEnd{.kind = GaugeEnd::Kind::place, .at = probe.at});
    for (auto& driver : drivers(scenario)) found.push_back(std::move(driver));
    return found;
}

const GaugeEnd* named(const std::vector<std::pair<std::string, GaugeEnd>>& ends, const std::string& name) {
    const auto found = std::find_if(ends.begin(), ends.end(), [&](const auto& end) { return end.first == name; });
    return found == ends.end() ? nullptr : &found->second;
}

std::vector<std::string> names_of(const std::vector<std::pair<std::string, GaugeEnd>>& ends) {
    std::vector<std::string> names;
    for (const auto& [name, end] : ends) names.push_back(name);
    return names;
}

std::optional<GaugeEnds> gauge(const Assembly& assembly, const std::string& path) {
    if (!assembly.values.has(path)) return std::nullopt;
    const auto ends = gauge_ends(assembly.scenario);
    const auto items = assembly.values.items(path);
    if (items.size() != 2) {
        assembly.findings.error("wrong-type", "`" + path + "` needs two ends, not " + std::to_string(items.size()), assembly.at(path)).note =
            "two of: " + joined(names_of(ends));
        return std::nullopt;
    }
    GaugeEnds found;
    for (std::size_t i = 0; i < 2; ++i) {
        const GaugeEnd* end = named(ends, items[i]->text);
        if (end) found[i] = *end;
        else assembly.unknown_name(path, "boundary, probe, obstacle or driving load", items[i]->text, names_of(ends));
    }
    return found;
}

/// Whether what drives moves along an axis.
bool moves(const Scenario& scenario, const GaugeEnd& driver, int axis) {
    if (driver.kind == GaugeEnd::Kind::load) return scenario.loads[driver.number].value[axis].value_or(0) != 0;
    const Drive& drive = scenario.obstacles[driver.number].drive[axis];
    return drive.kind == Drive::Kind::free || drive.value != 0;
}

/// Without a gauge the travel of the driver is taken for that of the whole specimen.
void check_other_end(const Assembly& assembly, const SpecimenOptions& specimen) {
    if (specimen.axial) return;
    for (const auto& [name, driver] : drivers(assembly.scenario)) {
        const bool itself = driver.kind == specimen.driver.kind && driver.number == specimen.driver.number;
        if (itself || !moves(assembly.scenario, driver, specimen.axis)) continue;
        const std::string message = "`" + name + "` moves as well; the strain of the specimen is the travel of what `specimen.force` names alone";
        assembly.findings.warning("other-end", message, assembly.at("specimen")).note = "axial = [...] names the two ends of a gauge";
        return;
    }
}

/// Numbers of a run that has no [specimen], or notes no breaks.
void check_expectations(const Assembly& assembly) {
    const bool specimen = assembly.values.given("specimen"), lateral = assembly.values.given("specimen.lateral");
    const auto needs = [&](const char* name, bool there, const char* what) {
        const std::string path = std::string("expect.") + name;
        if (assembly.values.given(path) && !there) assembly.findings.error("nothing-to-expect", "`" + path + "` needs " + what, assembly.at(path));
    };
    for (const char* name : {"peak_stress", "peak_strain", "tangent_modulus", "crack_initiation_stress"}) needs(name, specimen, "a [specimen]");
    for (const char* name : {"youngs_modulus", "poisson_ratio", "dilatancy_stress", "crack_damage_stress"}) needs(name, lateral, "a [specimen] with a lateral gauge");
    for (const char* name : {"tensile_breaks", "shear_breaks"}) needs(name, assembly.scenario.output.breaks, "output.breaks = true");
}

void assemble_breaks(Assembly& assembly, bool specimen) {
    Values& values = assembly.values;
    std::string shown;  // the first figure that needs them
    for (std::size_t i = 0; i < values.count("figure") && shown.empty(); ++i) {
        const std::string show = values.text(item("figure", i) + ".show").value_or("");
        const std::string colour = values.text(item("figure", i) + ".colour").value_or("opening");
        if (needs_breaks(show.empty() ? "cracks" : show, colour)) shown = item("figure", i) + (show == "breaks" || show == "rose" ? ".show" : ".colour");
        if (show != "stress_strain" || specimen) continue;
        const std::string path = item("figure", i);
        assembly.findings.error("nothing-to-show", "`" + path + "` shows stress and strain, but there is no specimen", assembly.at(path + ".show")).note = "add a [specimen]";
    }
    if (!values.given("output.breaks")) values.compute("output.breaks", Node::of_boolean(specimen || !shown.empty()));
    assembly.scenario.output.breaks = values.flag("output.breaks").value_or(false);
    if (assembly.scenario.output.breaks || (!specimen && shown.empty())) return;
    const std::string who = specimen ? "a [specimen]" : "`" + shown + "`";
    assembly.findings.error("exclusive-keys", "`output.breaks` is false, but " + who + " needs it", assembly.at("output.breaks"));
}

}  // namespace

void assemble_specimen(Assembly& assembly) {
    const Values& values = assembly.values;
    const bool given = values.given("specimen");
    assemble_breaks(assembly, given);
    check_expectations(assembly);
    if (!given) return;
    SpecimenOptions specimen;
    for (const auto& [word, test] : tests)
        if (values.text("specimen.test") == word) specimen.test = test;
    specimen.axis = values.text("specimen.axis") == "x" ? 0 : 1;
    specimen.height = values.number("specimen.height").value_or(0);
    specimen.width = values.number("specimen.width").value_or(0);
    specimen.span = values.number("specimen.span").value_or(1);
    const auto known = drivers(assembly.scenario);
    if (const auto name = values.text("specimen.force")) {
        if (const GaugeEnd* end = named(known, *name)) specimen.driver = *end;
        else assembly.unknown_name("specimen.force", "obstacle or load that prescribes motion", *name, names_of(known));
    }
    specimen.axial = gauge(assembly, "specimen.axial");
    specimen.lateral = gauge(assembly, "specimen.lateral");
    if (values.has("specimen.force")) check_other_end(assembly, specimen);
    if (const auto parts = values.pair("specimen.modulus_between")) {
        specimen.modulus_between = {parts->x(), parts->y()};
        if (!(parts->x() < parts->y())) assembly.findings.error("out-of-range", "`specimen.modulus_between` does not ascend", assembly.at("specimen.modulus_between"));
    }
    assembly.scenario.specimen = specimen;
}

}  // namespace knap
