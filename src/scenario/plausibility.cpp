// Values that the program can compute with but hardly anybody means: most are numbers whose unit was forgotten.
#include "scenario/reading.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

namespace knap {
namespace {

/// What real materials have. Nothing is forbidden.
struct Plausible {
    const char *table, *key, *unit;
    double low, high;
    const char *below, *above;     // what such a value would be
    const char* meant;             // unit of a plain number that was probably meant
    double meant_low, meant_high;  // numbers for which it was
};

// From gels and aerogels to diamond and osmium.
constexpr Plausible ranges[] = {
    {"material", "E", "Pa", 1e3, 2e12, "softer than any gel", "stiffer than diamond", "GPa", 0.01, 1000},
    {"material", "density", "kg/m3", 10, 3e4, "lighter than any foam", "heavier than osmium", "g/cm3", 0.1, 30},
    {"interface", "sigma_c", "Pa", 10, 2e11, "weaker than any gel", "stronger than diamond", "MPa", 0.01, 1000},
    {"interface", "G_c", "J/m2", 1e-4, 1e7, "less than the surface energy of any solid",
     "more than that of the toughest steel", "", 0, 0},
    {"interface", "delta_c", "m", 1e-11, 0.1, "less than the size of an atom",
     "more than any solid opens before it breaks", "um", 0.1, 10000},
    {"interface", "friction", "", 0, 3, "", "beyond that of any rock", "", 0, 0},
};
constexpr double softest_material = 1e3;  // [Pa] the first row's

/// Zero is a choice: no strength, no friction.
void check(const Reading& reading, const Plausible& range, const std::string& path) {
    const std::optional<double> value = reading.values.number(path);
    if (!value || *value == 0 || (*value >= range.low && *value <= range.high)) return;
    const std::string number = shortest(*value), unit = *range.unit ? " " + std::string(range.unit) : "";
    const char* what = *value < range.low ? range.below : range.above;
    Diagnostic& d =
        reading.findings.warning("implausible", "`" + path + "` = " + number + unit + " is " + what, reading.at(path));
    if (std::string(range.key) == "friction" && *value < 90) {
        char text[100];
        std::snprintf(text, sizeof text, "a coefficient is wanted, not an angle: tan(%.4g deg) = %.3g", *value,
                      std::tan(*value * std::numbers::pi / 180));
        d.note = text;
        return;
    }
    if (reading.values.given(path) && *range.meant && *value >= range.meant_low && *value <= range.meant_high)
        d.hint = "did you mean \"" + number + " " + range.meant + "\"?";
    d.note = "plausible: " + shortest(range.low) + " to " + shortest(range.high) + unit +
             "; a number without a unit is in SI; it is taken as it stands";
}

/// A strength above the modulus means strains above 1 at the crack, far beyond the small strains that are computed.
void check_strengths(Reading& reading) {
    double stiffest = 0;
    for (const NamedMaterial& material : reading.scenario.materials) stiffest = std::max(stiffest, material.elastic.E);
    if (!(stiffest >= softest_material)) return;  // reported already
    for (const NamedLaw& named : reading.scenario.laws)
        if (named.law.breakable() && named.law.sigma_c > stiffest)
            reading.table("interface." + named.name)
                .warning(
                    "implausible", "sigma_c",
                    "= " + shortest(named.law.sigma_c) + " Pa is above the largest E, " + shortest(stiffest) + " Pa",
                    "strains are to be small: a strength is a thousandth of E or less");
}

double largest(const Load& load) {
    if (load.kind != Load::Kind::stress) return std::hypot(load.value[0].value_or(0), load.value[1].value_or(0));
    return std::max({std::abs(load.stress[0]), std::abs(load.stress[1]), std::abs(load.stress[2])});
}

double largest_factor(const TimeFunction& history) {
    double factor = history.time.empty() ? 1 : 0;
    for (const double value : history.value) factor = std::max(factor, std::abs(value));
    return factor;
}

void check_load(const Table& table, const Load& load, double softest, double fastest) {
    const double size = largest(load) * largest_factor(load.history);
    const bool is_stress = load.kind == Load::Kind::traction || load.kind == Load::Kind::stress;
    if (is_stress && softest >= softest_material && size > 0.1 * softest)
        table.warning("implausible", "",
                      "puts a stress of " + shortest(size) + " Pa on a material of E = " + shortest(softest) + " Pa",
                      "strains are to be small: a stress is a hundredth of E or less");
    if (load.kind == Load::Kind::velocity && fastest > 0 && size > fastest) {
        const std::string waves = "faster than waves run in it, " + shortest(std::round(fastest)) + " m/s";
        const std::string text = "`" + table.path() + "` drives the body at " + shortest(size) + " m/s, " + waves;
        table.reading().findings.warning("implausible", text, table.reading().at(table.path("velocity"))).note =
            "a number without a unit is in m/s";
    }
}

void check_loads(Reading& reading) {
    double softest = std::numeric_limits<double>::infinity(), fastest = 0;
    for (const NamedMaterial& material : reading.scenario.materials) {
        softest = std::min(softest, material.elastic.E);
        if (material.elastic.density > 0)
            fastest = std::max(fastest, material.elastic.dilatational_speed(reading.scenario.plane));
    }
    for (std::size_t i = 0; i < reading.scenario.loads.size(); ++i)
        check_load(reading.table(item("load", i)), reading.scenario.loads[i], softest, fastest);
}

/// A table that begins when the run is over never changes anything.
void check_history(const Table& table, const TimeFunction& history) {
    const double end = table.reading().scenario.time.end;
    if (history.time.empty() || history.time.front() < end) return;
    table.warning("after-the-end", table.given("csv") ? "csv" : "table",
                  "begins at " + shortest(history.time.front()) + " s, and the run ends at " + shortest(end) +
                      " s: its factor is " + shortest(history.value.front()) + " all the time",
                  "a number without a unit is in seconds");
}

void check_times(Reading& reading) {
    const Scenario& scenario = reading.scenario;
    if (!(scenario.time.end > 0)) return;
    for (std::size_t i = 0; i < scenario.loads.size(); ++i)
        check_history(reading.table(item("load", i)), scenario.loads[i].history);
    for (std::size_t i = 0; i < scenario.obstacles.size(); ++i) {
        const auto& drives = scenario.obstacles[i].drive;
        const auto driven =
            std::ranges::find_if(drives, [](const Drive& drive) { return !drive.history.time.empty(); });
        if (driven != drives.end()) check_history(reading.table(item("obstacle", i)), driven->history);
    }
    for (const Table& quantity : reading.list("study.quantity"))
        if (const auto at = quantity.number("at"); at && *at > scenario.time.end)
            quantity.warning("after-the-end", "at",
                             "is " + shortest(*at) + " s, and the run ends at " + shortest(scenario.time.end) +
                                 " s: there is no such value");
}

}  // namespace

void warn_of_implausible(Reading& reading) {
    for (const Plausible& range : ranges)
        for (const std::string& name : reading.values.names(range.table))
            check(reading, range, std::string(range.table) + "." + name + "." + range.key);
    check_strengths(reading);
    check_loads(reading);
    check_times(reading);
}

}  // namespace knap
