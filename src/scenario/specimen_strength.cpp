#include "scenario/specimen_strength.hpp"

#include "base/formatted.hpp"
#include "base/text.hpp"
#include "scenario/scenario.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr CalibrationFormat strength_format{
    "strength", "test,softening,unloading,order,gamma,friction,zones,edges,through,seeds,surplus,deviation", 3};
// of the table: four times the process zones change the surplus by 0.04, three times the edges by 0.01
constexpr double beyond_zones = 1.5, beyond_specimen_edges = 3;

bool same_kind(const TestedLaw& a, const TestedLaw& b) {
    return a.test == b.test && a.softening == b.softening && a.unloading == b.unloading && a.order == b.order;
}

}  // namespace

const char* test_word(SpecimenOptions::Test test) {
    return test == SpecimenOptions::Test::brazilian ? "brazilian" : "compression";
}

TestedLaw tested_law(const Scenario& scenario, const LawWithin& within, const std::string& test, double size) {
    const CohesiveLaw& law = scenario.laws[within.law].law;
    const double modulus = scenario.materials[within.material].elastic.plane_modulus(scenario.plane);
    FrictionLine line;
    if (test == "brazilian") line.slope = law.friction;  // that of the pressure which balances the cohesion
    if (test == "compression") line = law.compressive_strength().line;
    return {.test = test,
            .softening = within.meshed.softening,
            .unloading = within.meshed.unloading,
            .order = within.meshed.order,
            .gamma = law.gamma + line.offset / law.sigma_c,
            .friction = line.slope,
            .zones = size / law.process_zone(modulus),
            .edges = size / within.edge};
}

TestedLaw tested_law(const Scenario& scenario, const LawWithin& within) {
    return tested_law(scenario, within, test_word(scenario.strength.test), scenario.strength.size);
}

double weakest_facet(const CohesiveLaw& law, Coupling coupling) {
    const double gamma = law.gamma, mu = law.friction;
    // the norm: the least of 1/(cos t sqrt(cos^2 t + sin^2 t/gamma^2)), at cos^2 t = 1/(2 (1 - gamma^2)), else at t = 0
    if (coupling == Coupling::norm) return gamma * gamma < 0.5 ? 2 * gamma * std::sqrt(1 - gamma * gamma) : 1;
    // the sum: the least of (gamma + mu)/(cos t (sin t + mu cos t)), or the normal strength at t = 0
    return std::min(1., 2 * (gamma + mu) / (mu + std::hypot(1, mu)));
}

std::string not_tested(const Scenario& scenario, Index law) {
    const NamedLaw& named = scenario.laws[law];
    if (named.scatter.any() && named.scatter.of_strength) return "its strength is random";
    if (named.over_bedding.any()) return "it follows the angle to the layers (strength_over_bedding)";
    if (named.law.incubation_time > 0) return "its strength depends on the rate (incubation_time)";
    if (named.law.of_temperature && !named.law.of_temperature->friction.empty())
        return "its friction depends on the temperature";
    return {};
}

std::string strength_csv(const std::vector<StrengthRow>& rows) {
    std::string text = std::string(strength_format.columns) + "\n";
    for (const StrengthRow& row : rows)
        text += row.law.test + "," + row.law.softening + "," + row.law.unloading +
                formatted(",%d,%.4g,%.4g,%.4g,%.4g,%.3g,%d,%.4f,%.4f\n", row.law.order, row.law.gamma, row.law.friction,
                          row.law.zones, row.law.edges, row.through, row.seeds, row.surplus, row.deviation);
    return text;
}

StrengthTable::StrengthTable(const std::string& csv) {
    for (const CalibrationLine& line : calibration_lines(strength_format, csv)) {
        const std::vector<double>& numbers = line.numbers;
        if (!(numbers[3] > 0 && numbers[4] > 0)) throw bad_calibration(strength_format, line, "has no zones or edges");
        if (!(numbers[5] >= least_part_through)) continue;
        if (!(numbers[7] > 0)) throw bad_calibration(strength_format, line, "has no surplus");
        rows_.push_back({.law = {line.words[0], line.words[1], line.words[2], static_cast<Index>(numbers[0]),
                                 numbers[1], numbers[2], numbers[3], numbers[4]},
                         .through = numbers[5],
                         .seeds = static_cast<int>(numbers[6]),
                         .surplus = numbers[7],
                         .deviation = numbers[8]});
    }
}

std::optional<Surplus> StrengthTable::find(const TestedLaw& law) const {
    std::vector<SurplusPoint> points;
    for (const StrengthRow& row : rows_)
        if (same_kind(row.law, law))
            points.push_back({{row.law.gamma, row.law.friction, std::log(row.law.zones), std::log(row.law.edges)},
                              {row.surplus, row.deviation}});
    return interpolated(points, {law.gamma, law.friction, std::log(law.zones), std::log(law.edges)},
                        {0, 0, std::log(beyond_zones), std::log(beyond_specimen_edges)});
}

std::optional<double> distance(const TestedLaw& row, const TestedLaw& law) {
    const std::optional<double> of_law = distance(row.meshed(), law.meshed());
    if (row.test != law.test || !of_law) return {};
    return *of_law + apart(row.friction, law.friction) + apart(row.zones, law.zones);
}

std::vector<std::string> differences(const TestedLaw& row, const TestedLaw& law, double factor) {
    std::vector<std::string> parts = differences(row.meshed(), law.meshed(), factor);
    if (row.friction != law.friction) parts.push_back(formatted("friction %.3g", row.friction));
    if (std::abs(std::log(row.zones / law.zones)) > std::log(factor))
        parts.push_back(formatted("size of %.3g process zones", row.zones));
    return parts;
}

std::optional<Surplus> StrengthTable::of_measured(TestedLaw law) const {
    const double zones = law.zones;
    std::optional<Surplus> found;
    // four times the zones change the surplus by 0.04: a contraction
    for (int round = 0; round < 50; ++round) {
        const double surplus = found ? found->mean : 1.1;
        law.zones = zones / (surplus * surplus);
        const std::optional<Surplus> next = find(law);
        if (!next) return {};
        if (found && std::abs(next->mean - found->mean) < 1e-12) return next;
        found = next;
    }
    return found;
}

}  // namespace knap
