// [specimen], output.breaks, and what needs them: figures and expectations.
#include "scenario/reading.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace knap {
namespace {

using Test = SpecimenOptions::Test;
constexpr std::array tests{std::pair{"compression", Test::compression}, std::pair{"tension", Test::tension},
                           std::pair{"brazilian", Test::brazilian}, std::pair{"bending", Test::bending}};

using NamedEnd = std::pair<std::string, GaugeEnd>;

/// What drives and can be named: obstacles, and loads that prescribe a motion.
std::vector<NamedEnd> drivers(const Scenario& scenario) {
    std::vector<NamedEnd> found;
    for (Index i = 0; const Obstacle& obstacle : scenario.obstacles)
        found.emplace_back(obstacle.name, GaugeEnd{.kind = GaugeEnd::Kind::obstacle, .number = i++});
    for (Index i = 0; const Load& load : scenario.loads) {
        if (load.drives()) found.emplace_back(load.name, GaugeEnd{.kind = GaugeEnd::Kind::load, .number = i});
        ++i;
    }
    return found;
}

/// All that a gauge may end at.
std::vector<NamedEnd> gauge_ends(const Scenario& scenario) {
    std::vector<NamedEnd> found;
    for (const std::string& boundary : scenario.shape.boundary_names)
        found.emplace_back(boundary, GaugeEnd{.boundary = boundary});
    for (const ProbeOptions& probe : scenario.probes)
        if (!probe.interface) found.emplace_back(probe.name, GaugeEnd{.kind = GaugeEnd::Kind::place, .at = probe.at});
    for (NamedEnd& driver : drivers(scenario)) found.push_back(std::move(driver));
    return found;
}

/// The end of this name; nothing, and a finding, where there is none.
std::optional<GaugeEnd> end_named(const Table& specimen, const std::string& key, const std::string& what,
                                  const std::string& name, const std::vector<NamedEnd>& ends) {
    const auto found = std::ranges::find(ends, name, &NamedEnd::first);
    if (found != ends.end()) return found->second;
    std::vector<std::string> known;
    for (const NamedEnd& end : ends) known.push_back(end.first);
    specimen.reading().unknown_name(specimen.path(key), what, name, known);
    return std::nullopt;
}

std::optional<GaugeEnds> read_gauge(const Table& specimen, const std::string& key) {
    if (!specimen.has(key)) return std::nullopt;
    const std::vector<NamedEnd> ends = gauge_ends(specimen.reading().scenario);
    const auto items = specimen.items(key);
    if (items.size() != 2) {
        std::vector<std::string> known;
        for (const NamedEnd& end : ends) known.push_back(end.first);
        specimen.error("wrong-type", key, "needs two ends, not " + std::to_string(items.size()),
                       "two of: " + joined(known));
        return std::nullopt;
    }
    GaugeEnds found;
    for (std::size_t i = 0; i < 2; ++i)
        if (const auto end =
                end_named(specimen, key, "boundary, probe, obstacle or driving load", items[i]->text, ends))
            found[i] = *end;
    return found;
}

/// Whether what drives moves along an axis.
bool moves(const Scenario& scenario, const GaugeEnd& driver, int axis) {
    if (driver.kind == GaugeEnd::Kind::load) return scenario.loads[driver.number].value[axis].value_or(0) != 0;
    const Drive& drive = scenario.obstacles[driver.number].drive[axis];
    return drive.kind == Drive::Kind::free || drive.value != 0;
}

/// Without a gauge the travel of the driver is taken for that of the whole specimen.
void check_other_end(const Reading& reading, const SpecimenOptions& specimen) {
    if (specimen.axial) return;
    for (const auto& [name, driver] : drivers(reading.scenario)) {
        const bool itself = driver.kind == specimen.driver.kind && driver.number == specimen.driver.number;
        if (itself || !moves(reading.scenario, driver, specimen.axis)) continue;
        const std::string text =
            "`" + name +
            "` moves as well; the strain of the specimen is the travel of what `specimen.force` names alone";
        reading.findings.warning("other-end", text, reading.at("specimen")).note =
            "axial = [...] names the two ends of a gauge";
        return;
    }
}

/// Numbers of a run that has no [specimen], or notes no breaks.
void check_expectations(Reading& reading) {
    const Table expect = reading.table("expect");
    const auto need = [&](std::initializer_list<const char*> names, bool there, const char* what) {
        for (const char* name : names)
            if (expect.given(name) && !there) expect.error("nothing-to-expect", name, std::string("needs ") + what);
    };
    need({"peak_stress", "peak_strain", "tangent_modulus", "crack_initiation_stress"}, reading.values.given("specimen"),
         "a [specimen]");
    need({"youngs_modulus", "poisson_ratio", "dilatancy_stress", "crack_damage_stress"},
         reading.values.given("specimen.lateral"), "a [specimen] with a lateral gauge");
    need({"tensile_breaks", "shear_breaks"}, reading.scenario.output.breaks, "output.breaks = true");
}

void read_breaks(Reading& reading, bool specimen) {
    std::string shown;  // the first figure that needs them
    for (const Table& figure : reading.list("figure")) {
        if (!shown.empty()) break;
        const std::string show = figure.text("show"), colour = figure.has("colour") ? figure.text("colour") : "opening";
        if (needs_breaks(show.empty() ? "cracks" : show, colour))
            shown = figure.path(show == "breaks" || show == "rose" ? "show" : "colour");
        if (show == "stress_strain" && !specimen)
            figure
                .report("nothing-to-show", "show",
                        "`" + figure.path() + "` shows stress and strain, but there is no specimen")
                .note = "add a [specimen]";
    }
    const Table output = reading.table("output");
    const bool needed = specimen || !shown.empty();
    output.compute("breaks", Node::of_boolean(needed));
    output.fill(reading.scenario.output);
    if (reading.scenario.output.breaks || !needed) return;
    output.error("exclusive-keys", "breaks",
                 "is false, but " + (specimen ? "a [specimen]" : "`" + shown + "`") + " needs it");
}

}  // namespace

void read_specimen(Reading& reading) {
    const Table table = reading.table("specimen");
    read_breaks(reading, table.given());
    check_expectations(reading);
    if (!table.given()) return;
    SpecimenOptions specimen;
    table.fill(specimen);
    for (const auto& [word, test] : tests)
        if (table.text("test") == word) specimen.test = test;
    specimen.axis = table.text("axis") == "x" ? 0 : 1;
    if (table.has("force")) {
        const std::string what = "obstacle or load that prescribes motion";
        if (const auto end = end_named(table, "force", what, table.text("force"), drivers(reading.scenario)))
            specimen.driver = *end;
    }
    specimen.axial = read_gauge(table, "axial");
    specimen.lateral = read_gauge(table, "lateral");
    if (table.has("force")) check_other_end(reading, specimen);
    if (const auto parts = table.pair("modulus_between")) {
        specimen.modulus_between = {parts->x(), parts->y()};
        if (!(parts->x() < parts->y())) table.error("out-of-range", "modulus_between", "does not ascend");
    }
    reading.scenario.specimen = specimen;
}

}  // namespace knap
