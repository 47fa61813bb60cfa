// Warnings of values that are possible, but likely mistakes: most are numbers with a forgotten unit.
#include "scenario/reading.hpp"
#include "scenario/toughness.hpp"

#include "base/display_unit.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace knap {
namespace {

/// The range of real materials, and what a value beyond it would be. `meant`: the unit that a plain number between
/// `meant_low` and `meant_high` probably has.
struct Plausible {
    const char *table, *key;
    double low, high;
    const char *below, *above;
    const char* meant = "";
    double meant_low = 0, meant_high = 0;
};

// From gels and aerogels to diamond and osmium.
constexpr Plausible ranges[] = {
    {"material", "E", 1e3, 2e12, "softer than any gel", "stiffer than diamond", "GPa", 0.01, 1000},
    {"material", "density", 10, 3e4, "lighter than any foam", "heavier than osmium", "g/cm3", 0.1, 30},
    {"interface", "sigma_c", 10, 2e11, "weaker than any gel", "stronger than diamond", "MPa", 0.01, 1000},
    {"interface", "G_c", 1e-4, 1e7, "less than the surface energy of any solid",
     "more than that of the toughest steel"},
    {"interface", "delta_c", 1e-11, 0.1, "less than the size of an atom", "more than any solid opens before it breaks",
     "um", 0.1, 10000},
    {"interface", "friction", 0, 3, "", "more than that of any rock"},
    {"material", "expansion", -1e-4, 1e-3, "less than that of any solid", "more than that of any solid", "um/m/K", 0.1,
     300},
};
constexpr double min_modulus = ranges[0].low;  // [Pa]

/// Zero is a choice: no strength, no friction.
void check(const Table& table, const Plausible& range) {
    const std::optional<double> value = table.number(range.key);
    if (!value || *value == 0 || (*value >= range.low && *value <= range.high)) return;
    const Key& key = *find_key(std::string(range.table) + ".*." + range.key);
    const std::string number = shortest(*value), unit = key.unit.empty() ? "" : " " + std::string(key.unit);
    const std::string text = "= " + number + unit + " is " + (*value < range.low ? range.below : range.above);
    if (key.name() == "friction" && *value < 90) {
        char tangent[40];
        std::snprintf(tangent, sizeof tangent, "%.3g", std::tan(*value * std::numbers::pi / 180));
        return table.warning("implausible", range.key, text,
                             "a coefficient, not an angle: tan(" + number + " deg) = " + tangent);
    }
    const bool mistaken = *range.meant && *value >= range.meant_low && *value <= range.meant_high;
    table.warning("implausible", range.key, text,
                  "plausible: " + shortest(range.low) + " to " + shortest(range.high) + unit +
                      "; a number without a unit is in SI; the value is used as given",
                  mistaken ? "did you mean \"" + number + " " + range.meant + "\"?" : "");
}

/// Stresses above these would mean strains beyond those of the linear theory; velocities faster than waves.
void check_strains(Reading& reading) {
    const Scenario& scenario = reading.scenario;
    double softest = infinity, stiffest = 0, fastest = 0;
    for (const NamedMaterial& material : scenario.materials) {
        softest = std::min(softest, material.elastic.E);
        stiffest = std::max(stiffest, material.elastic.E);
        if (material.elastic.density > 0)
            fastest = std::max(fastest, material.elastic.dilatational_speed(scenario.plane));
    }
    if (stiffest >= min_modulus)  // otherwise reported already
        for (const NamedLaw& named : scenario.laws)
            if (named.law.breakable() && named.law.sigma_c > stiffest)
                reading.table("interface." + named.name)
                    .warning("implausible", "sigma_c",
                             "= " + readable(named.law.sigma_c, "Pa", 6) + " is above the largest E, " +
                                 readable(stiffest, "Pa", 6),
                             "strains are assumed small: a strength is a thousandth of E or less");
    for (std::size_t i = 0; i < scenario.loads.size(); ++i) {
        const Load& load = scenario.loads[i];
        const Table table = reading.table(item("load", i));
        double size = std::hypot(load.value[0].value_or(0), load.value[1].value_or(0)), factor = 0;
        for (const double stress : load.stress) size = std::max(size, std::abs(stress));
        for (const double value : load.history.value) factor = std::max(factor, std::abs(value));
        if (!load.history.time.empty()) size *= factor;
        const bool is_stress = load.kind == Load::Kind::traction || load.kind == Load::Kind::stress;
        if (is_stress && softest >= min_modulus && size > 0.1 * softest)
            table.warning(
                "implausible", "",
                "puts a stress of " + readable(size, "Pa", 6) + " on a material of E = " + readable(softest, "Pa", 6),
                "strains are assumed small: a stress is a hundredth of E or less");
        if (load.kind == Load::Kind::velocity && fastest > 0 && size > fastest)
            table.warning("implausible", "velocity",
                          "= " + readable(size, "m/s", 6) + " is faster than waves in the body, " +
                              readable(std::round(fastest), "m/s", 6),
                          "a number without a unit is in m/s");
    }
}

/// In plane strain triangles of first order lock as nu approaches 1/2: what they can do without a change of volume is
/// too little. In figures: the energy that a clamped beam, ten edges thick and five times as long, lacks.
void check_locking(Reading& reading) {
    constexpr double nearly_incompressible = 0.45;
    const Scenario& scenario = reading.scenario;
    if (scenario.plane != PlaneModel::strain || scenario.order != 1) return;
    for (const NamedMaterial& material : scenario.materials)
        if (material.elastic.nu > nearly_incompressible)
            reading.table("material." + material.name)
                .warning("locking", "nu",
                         "= " + shortest(material.elastic.nu) +
                             " in plane strain: triangles of first order are too stiff where volumes hardly change (a "
                             "beam of ten edges by 4 % with 0.45, 9 % with 0.49, 22 % with 0.499)",
                         "mesh.order = 2, or smaller triangles; compare two sizes");
}

/// The surplus of the program's tables is that of cracks in isotropic bodies, and no specimen has the keys of
/// not_calibrated.
void check_calibration(Reading& reading) {
    const Scenario& scenario = reading.scenario;
    const auto by_program = [&](double measured, const char* of) {
        return measured > 0 && !reading.table(of).given("table");
    };
    for (std::size_t i = 0; i < scenario.laws.size(); ++i) {
        const NamedLaw& law = scenario.laws[i];
        if (law.measured_G_c == 0 && law.measured_sigma_c == 0) continue;
        const Table table = reading.table("interface." + law.name);
        if (const std::string keys = given_keys(*reading.values.find(table.path()), not_calibrated); !keys.empty())
            table.warning("calibration", "",
                          "is corrected by the surplus of a mesh, which was measured without its " + keys,
                          "compare with a run whose properties are those \"of interfaces\"");
        const bool costs_by_program = by_program(law.measured_G_c, "toughness");
        if (costs_by_program && (law.law.friction > most_friction_of_toughness || law.law.over_pressure != nullptr))
            table.warning(
                "calibration", "toughness",
                formatted(
                    "= \"as measured\" has rows that hold for a friction of up to %.3g, which changes the cost of "
                    "a crack by less than its scatter, and this law has more, or one over the pressure",
                    most_friction_of_toughness),
                "a table of `knap calibrate` with this scenario");
        if (!costs_by_program && !by_program(law.measured_sigma_c, "strength")) continue;
        for (std::size_t m = 0; m < scenario.materials.size(); ++m)
            if (scenario.materials[m].elastic.bedding && scenario.law_of_pair[m][m] == static_cast<Index>(i))
                table.warning("calibration", "",
                              "is corrected by the surplus of a mesh, which was measured in isotropic bodies, in the "
                              "layers of `material." +
                                  scenario.materials[m].name + "`",
                              "a table of `knap calibrate` with this scenario");
    }
}

constexpr double negligible_factor = 1e-3;

/// Tables whose times the run does not meet.
void check_times(Reading& reading) {
    const Scenario& scenario = reading.scenario;
    const double end = scenario.time.end;
    if (!(end > 0)) return;
    const auto check_history = [&](const std::string& path, const TimeFunction& history) {
        if (history.time.empty()) return;
        const Table table = reading.table(path);
        const char* const key = table.given("ramp") ? "ramp" : table.given("csv") ? "csv" : "table";
        const auto largest = [](const auto& values) {
            return std::max(std::abs(std::ranges::min(values)), std::abs(std::ranges::max(values)));
        };
        const double in_run = largest(history.range(0, end)), in_all = largest(history.value);
        if (history.time.front() >= end)
            table.warning("after-the-end", key,
                          "begins at " + readable(history.time.front(), "s", 6) + ", and the run ends at " +
                              readable(end, "s", 6) + ": its factor is " + shortest(history.value.front()) +
                              " all the time",
                          "a number without a unit is in seconds");
        else if (in_run < negligible_factor * in_all)
            table.warning("after-the-end", key,
                          "has a factor of at most " + decimal(in_run, std::chars_format::general, 3) +
                              " until the run ends at " + readable(end, "s", 6) + ": its largest one, " +
                              shortest(in_all) + ", comes later",
                          "a number without a unit is in seconds");
        else if (history.time.back() < 0)
            table.warning("before-the-start", key,
                          "ends at " + readable(history.time.back(), "s", 6) +
                              ", before the run starts: its factor is " + shortest(history.value.back()) +
                              " all the time",
                          "times count from the start of the run");
    };
    for (std::size_t i = 0; i < scenario.loads.size(); ++i) check_history(item("load", i), scenario.loads[i].history);
    for (std::size_t i = 0; i < scenario.crack_pressures.size(); ++i)
        check_history(item("pressure", i), scenario.crack_pressures[i].history);
    if (scenario.heat) {
        check_history("heat", scenario.heat->field.history);
        for (std::size_t i = 0; i < scenario.heat->exchanges.size(); ++i)
            check_history(item("heat.exchange", i), scenario.heat->exchanges[i].history);
    }
    for (std::size_t i = 0; i < scenario.obstacles.size(); ++i) {  // one history for all
        TimeFunction history;
        for (const Drive& drive : scenario.obstacles[i].drive)
            if (!drive.history.time.empty()) history = drive.history;
        for (const ObstacleForce& force : scenario.obstacles[i].forces)
            if (!force.history.time.empty()) history = force.history;
        check_history(item("obstacle", i), history);
    }
    for (const NamedLaw& named : scenario.laws)
        if (const double tau = named.law.relaxation_time; tau > end)
            reading.table("interface." + named.name)
                .warning("after-the-end", "relaxation_time",
                         "= " + readable(tau, "s", 6) + " is longer than the run, " + readable(end, "s", 6) +
                             ": its points hardly soften, and open with nearly their whole strength",
                         "a number without a unit is in seconds");
    for (const Table& quantity : reading.list("study.quantity"))
        if (const auto at = quantity.number("at"); at && *at > end)
            quantity.warning("after-the-end", "at",
                             "is " + readable(*at, "s", 6) + ", and the run ends at " + readable(end, "s", 6) +
                                 ": there is no such value");
}

}  // namespace

void warn_of_implausible(Reading& reading) {
    for (const Plausible& range : ranges)
        for (const Table& table : reading.list(range.table)) check(table, range);
    check_strains(reading);
    check_locking(reading);
    check_calibration(reading);
    check_times(reading);
}

}  // namespace knap
