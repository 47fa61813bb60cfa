// [strength]: whether sigma_c is that of the interfaces or that for which their law gives the strength of a specimen,
// which specimens with a random mesh exceed.
#include "scenario/reading.hpp"
#include "scenario/specimen_strength.hpp"

#include "base/formatted.hpp"

namespace knap {
namespace {

constexpr const char* strength_table_of_program = "mesh_strength.csv";

/// [m] Extent of the only body along an axis; none of several bodies.
std::optional<double> extent_of_body(const Scenario& scenario, int axis) {
    if (!scenario.given && scenario.bodies.size() != 1) return {};
    const std::vector<Vec2>& points =
        scenario.given ? scenario.given->mesh.vertices : scenario.bodies.front().shape.outer.points;
    if (points.empty()) return {};  // of a body with mistakes
    const double extent = bounding_box(points).extent()[axis];
    return extent > 0 ? std::optional(extent) : std::nullopt;
}

/// [m] Size of the [specimen], if it has this test: width in compression, diameter of a disc.
std::optional<double> size_of_specimen(const Scenario& scenario, SpecimenOptions::Test test) {
    if (!scenario.specimen || scenario.specimen->test != test) return {};
    const SpecimenOptions& specimen = *scenario.specimen;
    const bool disc = test == SpecimenOptions::Test::brazilian;
    const double given = disc ? specimen.height : specimen.width;
    return given > 0 ? given : extent_of_body(scenario, disc ? specimen.axis : 1 - specimen.axis);
}

void apply_strength(const Table& table, const LawWithin& within, const StrengthTable& strengths) {
    NamedLaw& named = table.scenario().laws[within.law];
    const TestedLaw law = tested_law(table.scenario(), within);
    if (const std::string reason = not_tested(table.scenario(), within.law); !reason.empty()) {
        table.error("no-calibration", "",
                    "= \"as measured\" has no meaning for `interface." + named.name + "`: " + reason,
                    "allowed: laws whose strength is one number");
        return;
    }
    if (report_keys_without_rows(table, named.name, without_strength)) return;
    const std::optional<Surplus> surplus = strengths.of_measured(law);
    if (!surplus) {
        std::vector<ToldOfLaw> told = told_of(law.meshed());
        told.push_back({formatted("friction %.4g", law.friction),
                        {"friction", "friction_table", "friction_over_pressure", "friction_csv"}});
        told.push_back(
            {formatted("%s, size of %.3g process zones and %.3g edges", law.test.c_str(), law.zones, law.edges), {}});
        table.error("no-calibration", "",
                    "= \"as measured\", but its table has no surplus for `interface." + named.name +
                        "`: " + told_text(*table.reading().values.find("interface." + named.name), told),
                    "`knap calibrate --of strength` with this scenario measures it; " + strengths.nearest_text(law));
        return;
    }
    named.measured_sigma_c = named.law.sigma_c;
    named.strength_surplus = *surplus;
    named.law.sigma_c /= surplus->mean;
}

}  // namespace

void read_strength(Reading& reading) {
    const Table table = reading.table("strength");
    Scenario& scenario = reading.scenario;
    if (scenario.specimen) table.compute("test", Node::of_text(test_word(scenario.specimen->test)));
    StrengthOptions& options = scenario.strength;
    table.fill(options);
    if (const std::optional<double> size = size_of_specimen(scenario, options.test))
        table.compute("size", Node::of_number(*size));
    options.size = table.number("size").value_or(0);
    if (!options.as_measured || reading.findings.has_errors()) return;
    if (!(options.size > 0)) {
        table.error("missing-key", "size", "is missing: the scenario has no [specimen] with this test",
                    "width of the plate, twice as high, or diameter of the disc whose strength was measured");
        return;
    }
    const std::optional<std::string> bytes = calibration_table(table, strength_table_of_program, "strength.csv");
    if (!bytes) return;
    const std::vector<LawWithin> found = laws_within(scenario, reading.values);
    try {
        const StrengthTable strengths(*bytes);
        for (const LawWithin& within : found) apply_strength(table, within, strengths);
    } catch (const UserError& error) {
        return report_bad_calibration(table, error);
    }
    if (found.empty())
        table.warning("no-effect", "", "= \"as measured\" has no effect: no law with cohesion acts within a material");
}

}  // namespace knap
