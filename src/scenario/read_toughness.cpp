// [toughness]: whether G_c is that of the interfaces or that of a specimen, which cracks along a random mesh exceed.
#include "scenario/built_in.hpp"
#include "scenario/reading.hpp"
#include "scenario/toughness.hpp"

#include "base/formatted.hpp"

#include <algorithm>

namespace knap {
namespace {

constexpr const char* program_table = "mesh_toughness.csv";

}  // namespace

std::optional<std::string> calibration_table(const Table& table, const char* of_program, const char* stored_as) {
    if (!table.given("table")) return std::ranges::find(built_in_files(), of_program, &BuiltIn::name)->text;
    std::optional<std::string> bytes = table.bytes_of("table");
    if (bytes) table.scenario().files.push_back({table.path("table"), stored_as, *bytes});
    return bytes;
}

void report_bad_calibration(const Table& table, const UserError& error) {
    for (const Diagnostic& found : error.diagnostics)
        table.error(found.code, table.given("table") ? "table" : "", ": " + found.message, found.note);
}

bool report_keys_without_rows(const Table& table, const std::string& law, std::span<const char* const> of_tables) {
    if (table.given("table")) return false;
    const std::string keys = given_keys(*table.reading().values.find("interface." + law), of_tables);
    if (!keys.empty())
        table.error("no-calibration", "",
                    "= \"as measured\", but the program's table has no surplus for the " + keys + " of `interface." +
                        law + "`: its rows were measured without",
                    "`knap calibrate` with this scenario measures a table of its own");
    return !keys.empty();
}

std::vector<LawWithin> laws_within(const Scenario& scenario, const Values& values) {
    const double mean = scenario.given ? mean_edge(scenario.given->mesh) : scenario.mesh.size,
                 edge = scenario.finest_edge(mean);
    std::vector<LawWithin> found;
    for (Index i = 0; i < static_cast<Index>(scenario.laws.size()); ++i) {
        const CohesiveLaw& law = scenario.laws[i].law;
        if (!law.breakable() || law.sigma_c <= 0) continue;
        double shortest = infinity;
        LawWithin within{.law = i, .material = -1, .edge = edge, .meshed = {}};
        for (Index m = 0; m < static_cast<Index>(scenario.materials.size()); ++m) {
            if (scenario.law_of_pair[m][m] != i && scenario.law_within[m] != i) continue;
            const double zone = law.steep_zone(scenario.materials[m].elastic.plane_modulus(scenario.plane));
            if (zone < shortest) shortest = zone, within.material = m;
        }
        if (within.material < 0) continue;  // joints, supports, pairs of materials: their cracks run along given lines
        within.meshed = {.softening = softening_words(*values.find("interface." + scenario.laws[i].name)),
                         .unloading = name_of(law.unloading),
                         .order = scenario.order,
                         .gamma = law.gamma,
                         .edges = shortest / edge};
        found.push_back(within);
    }
    return found;
}

void read_toughness(Reading& reading) {
    const Table table = reading.table("toughness");
    if (table.text("meaning") != "as measured" || reading.findings.has_errors()) return;
    const std::optional<std::string> bytes = calibration_table(table, program_table, "toughness.csv");
    if (!bytes) return;
    Scenario& scenario = reading.scenario;
    const std::vector<LawWithin> found = laws_within(scenario, reading.values);
    try {
        const ToughnessTable toughness(*bytes);
        for (const LawWithin& within : found) {
            NamedLaw& named = scenario.laws[within.law];
            const MeshedLaw& law = within.meshed;
            if (report_keys_without_rows(table, named.name, without_toughness)) continue;
            const std::optional<Surplus> surplus = toughness.of_measured(law);
            if (!surplus) {
                std::vector<ToldOfLaw> told = told_of(law);
                told.push_back({formatted("%.3g edges in the process zone", law.edges), {}});
                table.error("no-calibration", "",
                            "= \"as measured\", but its table has no surplus for `interface." + named.name +
                                "`: " + told_text(*reading.values.find("interface." + named.name), told),
                            "`knap calibrate` with this scenario measures it; " + toughness.nearest_text(law));
                continue;
            }
            named.measured_G_c = named.law.G_c;
            named.surplus = *surplus;
            named.law.G_c /= surplus->mean, named.law.G_II /= surplus->mean;
        }
    } catch (const UserError& error) {
        return report_bad_calibration(table, error);
    }
    if (found.empty())
        table.warning("no-effect", "", "= \"as measured\" has no effect: no law with cohesion acts within a material",
                      "cracks between two materials, along joints and supports run along given lines and cost G_c");
}

}  // namespace knap
