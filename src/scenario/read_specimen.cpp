// [specimen], output.breaks, and figures and expectations that need them.
#include "scenario/reading.hpp"

#include <algorithm>

namespace knap {
namespace {

/// All possible ends of a gauge.
std::vector<NamedEnd> gauge_ends(const Reading& reading) {
    std::vector<NamedEnd> found;
    for (const std::string& boundary : reading.scenario.shape.boundary_names)
        found.emplace_back(boundary, GaugeEnd{.boundary = boundary});
    for (const ProbeOptions& probe : reading.scenario.probes)
        if (!probe.interface) found.emplace_back(probe.name, GaugeEnd{.kind = GaugeEnd::Kind::place, .at = probe.at});
    for (NamedEnd& driver : reading.drivers()) found.push_back(std::move(driver));
    return found;
}

std::vector<std::string> names_of_ends(const std::vector<NamedEnd>& ends) {
    std::vector<std::string> names;
    for (const auto& [name, end] : ends) names.push_back(name);
    return names;
}

std::optional<GaugeEnds> read_gauge(const Table& table, const std::string& key) {
    if (!table.has(key)) return std::nullopt;
    const std::vector<NamedEnd> ends = gauge_ends(table.reading());
    const std::vector<std::string> names = table.texts(key), known = names_of_ends(ends);
    if (names.size() != 2) {
        table.error("wrong-type", key, "needs two ends, not " + std::to_string(names.size()),
                    "two of: " + joined(known));
        return std::nullopt;
    }
    GaugeEnds found;
    for (std::size_t i = 0; i < 2; ++i)
        if (const auto end =
                table.reading().find(table.path(key), "boundary, probe, obstacle or driving load", names[i], known))
            found[i] = ends[*end].second;
    return found;
}

/// Whether a driver moves along an axis.
bool moves(const Scenario& scenario, const GaugeEnd& driver, int axis) {
    if (driver.kind == GaugeEnd::Kind::load) return scenario.loads[driver.number].value[axis].value_or(0) != 0;
    const Drive& drive = scenario.obstacles[driver.number].drive[axis];
    return drive.kind == Drive::Kind::free || drive.value != 0;
}

/// Without a gauge, the strain is the displacement of the driver over the height: the other end must be fixed.
void check_other_end(const Table& table, const SpecimenOptions& specimen) {
    if (specimen.axial) return;
    for (const auto& [name, driver] : table.reading().drivers()) {
        const bool itself = driver.kind == specimen.driver.kind && driver.number == specimen.driver.number;
        if (itself || !moves(table.scenario(), driver, specimen.axis)) continue;
        return table.warning(
            "other-end", "",
            "has a strain from the displacement of specimen.force alone, but `" + name + "` moves as well",
            "axial = [...] names the two ends of a gauge");
    }
}

/// Expected numbers that need a specimen or breaks.
void check_expectations(Reading& reading) {
    struct Need {
        const char* what;
        bool met;
        std::vector<const char*> numbers;
    };
    const Table expect = reading.table("expect"), specimen = reading.table("specimen");
    for (const auto& [what, met, numbers] :
         {Need{"a [specimen]",
               specimen.given(),
               {"peak_stress", "peak_strain", "tangent_modulus", "crack_initiation_stress"}},
          Need{"a [specimen] with a lateral gauge",
               specimen.given("lateral"),
               {"youngs_modulus", "poisson_ratio", "dilatancy_stress", "crack_damage_stress"}},
          Need{"output.breaks = true", reading.scenario.output.breaks, {"tensile_breaks", "shear_breaks"}}})
        for (const char* number : numbers)
            if (!met && expect.given(number)) expect.error("nothing-to-expect", number, std::string("needs ") + what);
}

void read_breaks(Reading& reading, bool specimen) {
    std::string user = specimen ? "a [specimen]" : "";
    for (const Table& figure : reading.list("figure")) {
        const std::string show = figure.has("show") ? figure.text("show") : "cracks";
        const std::string colour = figure.has("colour") ? figure.text("colour") : "opening";
        if (user.empty() && needs_breaks(show, colour))
            user = "`" + figure.path(show == "breaks" || show == "rose" ? "show" : "colour") + "`";
        if (show == "stress_strain" && !specimen)
            figure.error("nothing-to-show", "show", "= \"stress_strain\", but there is no specimen",
                         "add a [specimen]");
    }
    const Table output = reading.table("output");
    output.compute("breaks", Node::of_boolean(!user.empty()));
    output.fill(reading.scenario.output);
    if (!reading.scenario.output.breaks && !user.empty())
        output.error("exclusive-keys", "breaks", "is false, but " + user + " needs it");
}

}  // namespace

void read_specimen(Reading& reading) {
    const Table table = reading.table("specimen");
    read_breaks(reading, table.given());
    check_expectations(reading);
    if (!table.given()) return;
    SpecimenOptions specimen;
    table.fill(specimen);
    const std::vector<NamedEnd> drivers = reading.drivers();
    std::optional<Index> driver;
    if (table.has("force"))
        driver = reading.find(table.path("force"), "obstacle or load with prescribed motion", table.text("force"),
                              names_of_ends(drivers));
    if (driver) specimen.driver = drivers[*driver].second;
    specimen.axial = read_gauge(table, "axial");
    specimen.lateral = read_gauge(table, "lateral");
    if (driver) check_other_end(table, specimen);
    if (!(specimen.modulus_between[0] < specimen.modulus_between[1]))
        table.error("out-of-range", "modulus_between", "does not ascend");
    reading.scenario.specimen = specimen;
}

}  // namespace knap
