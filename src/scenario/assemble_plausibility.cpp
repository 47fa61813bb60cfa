// Values that the program can compute with but hardly anybody means: most are numbers whose unit was forgotten.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

#include "scenario/assemble.hpp"
#include "scenario/units.hpp"

namespace knap {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

/// What real materials have. Nothing is forbidden.
struct Plausible {
    const char *table, *key, *unit;
    double low, high;
    const char *below, *above;       // what such a value would be
    const char* meant;               // unit of a plain number that was probably meant
    double meant_low, meant_high;    // numbers for which it was
};

// From gels and aerogels to diamond and osmium.
constexpr Plausible ranges[] = {
    {"material", "E", "Pa", 1e3, 2e12, "softer than any gel", "stiffer than diamond", "GPa", 0.01, 1000},
    {"material", "density", "kg/m3", 10, 3e4, "lighter than any foam", "heavier than osmium", "g/cm3", 0.1, 30},
    {"interface", "sigma_c", "Pa", 10, 2e11, "weaker than any gel", "stronger than diamond", "MPa", 0.01, 1000},
    {"interface", "G_c", "J/m2", 1e-4, 1e7, "less than the surface energy of any solid", "more than that of the toughest steel", "", 0, 0},
    {"interface", "delta_c", "m", 1e-11, 0.1, "less than the size of an atom", "more than any solid opens before it breaks", "um", 0.1, 10000},
    {"interface", "friction", "", 0, 3, "", "beyond that of any rock", "", 0, 0},
};

/// Zero is a choice: no strength, no friction.
void check(const Assembly& assembly, const Plausible& range, const std::string& path) {
    const std::optional<double> value = assembly.values.number(path);
    if (!value || *value == 0 || (*value >= range.low && *value <= range.high)) return;
    const bool is_low = *value < range.low, is_plain = assembly.values.given(path);
    const std::string unit = *range.unit ? " " + std::string(range.unit) : "";
    Diagnostic& d = assembly.findings.warning("implausible", "`" + path + "` = " + shortest(*value) + unit + " is " + (is_low ? range.below : range.above), assembly.at(path));
    if (std::string(range.key) == "friction" && *value < 90) {
        char text[100];
        std::snprintf(text, sizeof text, "a coefficient is wanted, not an angle: tan(%.4g deg) = %.3g", *value, std::tan(*value * std::numbers::pi / 180));
        d.note = text;
        return;
    }
    if (is_plain && *range.meant && *value >= range.meant_low && *value <= range.meant_high) d.hint = "did you mean \"" + shortest(*value) + " " + range.meant + "\"?";
    d.note = "plausible: " + shortest(range.low) + " to " + shortest(range.high) + unit + "; a number without a unit is in SI; it is taken as it stands";
}

/// A strength above the modulus means strains above 1 at the crack, far beyond the small strains that are computed.
void check_strengths(const Assembly& assembly) {
    double stiffest = 0;
    for (const NamedMaterial& material : assembly.scenario.materials) stiffest = std::max(stiffest, material.elastic.E);
    if (!(stiffest >= ranges[0].low)) return;  // said already
    for (const NamedLaw& law : assembly.scenario.laws)
        if (law.law.breakable() && law.law.sigma_c > stiffest)
            assembly.findings.warning("implausible", "`interface." + law.name + ".sigma_c` = " + shortest(law.law.sigma_c) +
                                                         " Pa is above the largest E, " + shortest(stiffest) + " Pa",
                                      assembly.at("interface." + law.name + ".sigma_c")).note = "strains are to be small: a strength is a thousandth of E or less";
}

double largest(const Load& load) {
    if (load.kind == Load::Kind::stress) return std::max({std::abs(load.stress[0]), std::abs(load.stress[1]), std::abs(load.stress[2])});
    return std::hypot(load.value[0].value_or(0), load.value[1].value_or(0));
}

double largest_factor(const TimeFunction& history) {
    double factor = history.time.empty() ? 1 : 0;
    for (const double value : history.value) factor = std::max(factor, std::abs(value));
    return factor;
}

void check_loads(const Assembly& assembly) {
    double softest = infinite, fastest = 0;
    for (const NamedMaterial& material : assembly.scenario.materials) {
        softest = std::min(softest, material.elastic.E);
        if (material.elastic.density > 0) fastest = std::max(fastest, material.elastic.dilatational_speed(assembly.scenario.plane));
    }
    for (std::size_t i = 0; i < assembly.scenario.loads.size(); ++i) {
        const Load& load = assembly.scenario.loads[i];
        const std::string path = item("load", i);
        const double size = largest(load) * largest_factor(load.history);
        if ((load.kind == Load::Kind::traction || load.kind == Load::Kind::stress) && softest >= ranges[0].low && size > 0.1 * softest)
            assembly.findings.warning("implausible", "`" + path + "` puts a stress of " + shortest(size) + " Pa on a material of E = " + shortest(softest) + " Pa",
                                      assembly.at(path)).note =
                "strains are to be small: a stress is a hundredth of E or less";
        if (load.kind == Load::Kind::velocity && fastest > 0 && size > fastest)
            assembly.findings.warning("implausible", "`" + path + "` drives the body at " + shortest(size) + " m/s, faster than waves run in it, " +
                                                         shortest(std::round(fastest)) + " m/s",
                                      assembly.at(path + ".velocity")).note = "a number without a unit is in m/s";
    }
}

/// A table that begins when the run is over never changes anything.
void check_times(const Assembly& assembly) {
    const double end = assembly.scenario.time.end;
    if (!(end > 0)) return;
    const auto check_history = [&](const std::string& path, const TimeFunction& history) {
        if (history.time.empty() || history.time.front() < end) return;
        const char* key = assembly.values.given(path + ".csv") ? ".csv" : ".table";
        assembly.findings.warning("after-the-end", "`" + path + key + "` begins at " + shortest(history.time.front()) +
                                                       " s, and the run ends at " + shortest(end) + " s: its factor is " +
                                                       shortest(history.value.front()) + " all the time",
                                  assembly.at(path + key)).note = "a number without a unit is in seconds";
    };
    for (std::size_t i = 0; i < assembly.scenario.loads.size(); ++i) check_history(item("load", i), assembly.scenario.loads[i].history);
    for (std::size_t i = 0; i < assembly.scenario.obstacles.size(); ++i)
        for (const Drive& drive : assembly.scenario.obstacles[i].drive)
            if (!drive.history.time.empty()) {
                check_history(item("obstacle", i), drive.history);
                break;
            }
    for (std::size_t i = 0; i < assembly.values.count("study.quantity"); ++i) {
        const std::string path = item("study.quantity", i) + ".at";
        if (const auto at = assembly.values.number(path); at && *at > end)
            assembly.findings.warning("after-the-end", "`" + path + "` is " + shortest(*at) + " s, and the run ends at " + shortest(end) + " s: there is no such value",
                                      assembly.at(path));
    }
}

}  // namespace

void assemble_plausibility(Assembly& assembly) {
    for (const Plausible& range : ranges)
        for (const std::string& name : assembly.values.names(range.table)) check(assembly, range, std::string(range.table) + "." + name + "." + range.key);
    check_strengths(assembly);
    check_loads(assembly);
    check_times(assembly);
}

}  // namespace knap
