#include "app/check/law_table.hpp"

#include "base/display_unit.hpp"
#include "base/formatted.hpp"
#include "base/text.hpp"
#include "model/fans.hpp"
#include "scenario/toughness.hpp"
#include "stepper/common/crack_forces.hpp"

#include <algorithm>
#include <array>
#include <map>

namespace knap {
namespace {

using Row = std::array<std::string, 9>;

/// "-10 to 0 K: 1 to 0.001", over the whole table.
std::string text_of(const TemperatureTable& table, double unit = 1, const char* name = "") {
    const auto [low, high] = std::ranges::minmax(table.value);
    return formatted("%.4g to %.4g%s over %.4g to %.4g K", low / unit, high / unit, name, table.temperature.front(),
                     table.temperature.back());
}

/// Coulomb's phi and c of every line of friction over pressure, with the cohesion of the point.
std::string over_pressure_text(const CohesiveLaw& law) {
    const FrictionOverPressure& f = *law.over_pressure;
    std::vector<std::string> parts;
    for (int i = 0; i < f.n_lines(); ++i) {
        const auto& [slope, offset] = f.line(i);
        const double cohesion = law.shear_strength(slope) * law.sigma_c + offset;
        parts.push_back(
            formatted("%.1f degrees and %s", std::atan(slope) / degree, readable(cohesion, "Pa", 4).c_str()) +
            (i + 1 < f.n_lines() ? " up to " + readable(f.start(i + 1), "Pa", 4) : " beyond"));
    }
    return "friction_over_pressure: phi and c " + joined(parts);
}

/// What a law does beyond linear softening with constant traction on unloading, in the words of the keys.
std::string beyond_linear(const NamedLaw& named) {
    const CohesiveLaw& law = named.law;
    std::string text;
    const auto add = [&](const std::string& part) { text += (text.empty() ? "" : "; ") + part; };
    if (law.unloading != Unloading::constant) add(std::string("unloading ") + name_of(law.unloading));
    if (law.has_mode_mix())
        add(formatted("G_II by %s, exponent %.4g", law.mode_mix == ModeMix::power ? "power" : "benzeggagh-kenane",
                      law.mix_exponent));
    if (law.slip_distance > 0)
        add(formatted("friction %.4g after a slip of %s", law.kinetic_friction,
                      readable(law.slip_distance, "m", 4).c_str()));
    if (law.over_pressure) add(over_pressure_text(law));
    if (law.relaxation_time > 0) add(formatted("relaxation_time %s", readable(law.relaxation_time, "s", 4).c_str()));
    if (law.incubation_time > 0) add(formatted("incubation_time %s", readable(law.incubation_time, "s", 4).c_str()));
    if (law.restitution > 0) add(formatted("restitution %.4g", law.restitution));
    if (law.of_temperature && !law.of_temperature->strength.empty())
        add("strength_table " + text_of(law.of_temperature->strength));
    if (law.of_temperature && !law.of_temperature->friction.empty())
        add("friction_table " + text_of(law.of_temperature->friction));
    if (named.over_bedding.any())
        add(formatted("strength times %.4g along to %.4g across the layers", named.over_bedding.strength(0),
                      named.over_bedding.strength(std::numbers::pi / 2)));
    if (named.scatter.kind == Scatter::Kind::weibull) add(formatted("scatter weibull %.4g", named.scatter.modulus));
    else if (named.scatter.any()) add(formatted("scatter %.4g", named.scatter.deviation));
    return text;
}

/// What sliding alone costs, G_c (1 + mu/gamma), without any pressure: friction acts on the cohesion, too, but
/// with the norm.
std::string mode_II_text(const CohesiveLaw& law) {
    const auto [low, high] = law.friction_range();
    if (law.gamma <= 0) return "never breaks";  // sliding alone opens nothing
    const double G = law.has_mode_mix() ? law.G_II : law.G_c;
    const auto cost = [&](double mu) { return G * law.shear_strength(mu) / law.gamma; };
    return low == high ? formatted("%.4g", cost(high)) : formatted("%.4g to %.4g", cost(low), cost(high));
}

/// "120 interfaces, 30 of joints, support[0]"
std::vector<std::string> places_of_laws(const Scenario& scenario, const Mesh& mesh) {
    std::vector<Index> inside(scenario.laws.size(), 0), joints(scenario.laws.size(), 0);
    for (const InteriorEdge& edge : mesh.interior_edges)
        ++(edge.joint >= 0 ? joints : inside)[law_of_edge(scenario, mesh, edge)];
    std::vector<std::string> places;
    for (std::size_t i = 0; i < scenario.laws.size(); ++i) {
        std::vector<std::string> parts;
        if (inside[i] > 0) parts.push_back(formatted("%d edges", inside[i]));
        if (joints[i] > 0) parts.push_back(formatted("%d of joints", joints[i]));
        for (std::size_t s = 0; s < scenario.supports.size(); ++s)
            if (scenario.supports[s].law == static_cast<Index>(i)) parts.push_back(item("support", s));
        places.push_back(parts.empty() ? "nowhere" : joined(parts));
    }
    return places;
}

Row row_of(const NamedLaw& named, const std::string& places, const Values& values) {
    const CohesiveLaw& law = named.law;
    const std::string name = "  " + named.name;  // below the head
    if (!law.breakable()) return {name, places, "never breaks", "", "", "", "", "", beyond_linear(named)};
    const bool from_table = law.of_temperature && !law.of_temperature->friction.empty();
    const std::string friction = from_table          ? "table"
                                 : law.over_pressure ? "over pressure"
                                                     : formatted("%.4g", law.friction);
    if (law.sigma_c <= 0) return {name, places, "no cohesion", "", "", "", friction, "", beyond_linear(named)};
    const auto measured = [](double value) {
        return value > 0 ? formatted(" (%.4g as measured)", value) : std::string();
    };
    return {name,
            places,
            formatted("%.4g", 1e-6 * law.sigma_c) + measured(1e-6 * named.measured_sigma_c),
            formatted("%.4g", law.G_c) + measured(named.measured_G_c) + formatted(", %.4g", 1e6 * law.delta_c()),
            mode_II_text(law),
            formatted("%.4g", law.gamma),
            friction,
            softening_words(*values.find("interface")->find(named.name)),
            beyond_linear(named)};
}

std::string pressure_text(const CrackPressure& fluid) {
    std::string text =
        fluid.is_injected() ? readable(fluid.rate, "m2/s", 4) + ", storage " + readable(fluid.storage, "m2/Pa", 4)
        : fluid.field       ? fluid.field->text
        : fluid.over_temperature.empty() ? readable(fluid.pressure, "Pa", 4)
                                         : "pressure_table " + text_of(fluid.over_temperature, 1e6, " MPa");
    if (fluid.gradient != 0)
        text += ", " + readable(fluid.gradient, "Pa/m", 4) + " below y = " + readable(fluid.level, "m", 4);
    return text;
}

}  // namespace

std::string laws_text(const ReadResult& read, const Model& model) {
    const Scenario& scenario = read.scenario;
    std::vector<Row> rows{{"laws", "act on", "sigma_c/MPa", "G_c/(J/m2), delta_c/um", "G_II/(J/m2)", "gamma",
                           "friction", "softening", ""}};
    const std::vector<std::string> places = places_of_laws(scenario, model.mesh);
    for (std::size_t i = 0; i < scenario.laws.size(); ++i)
        rows.push_back(row_of(scenario.laws[i], places[i], read.values));
    std::array<std::size_t, std::tuple_size_v<Row>> width{};
    for (const Row& row : rows)
        for (std::size_t k = 0; k < row.size(); ++k) width[k] = std::max(width[k], row[k].size());
    std::string text;
    for (const Row& row : rows) {
        std::string line;
        for (std::size_t k = 0; k < row.size(); ++k) line += row[k] + std::string(width[k] - row[k].size() + 2, ' ');
        text += line.substr(0, line.find_last_not_of(' ') + 1) + '\n';
    }
    const std::vector<FluidMoment> start = CrackForces(model).moments(initial_state(model));
    for (std::size_t i = 0; i < scenario.crack_pressures.size(); ++i) {
        const CrackPressure& fluid = scenario.crack_pressures[i];
        text += "  " + item("pressure", i) + ' ' + pressure_text(fluid) +
                (fluid.joint_law >= 0 ? ", in joints of " + scenario.laws[fluid.joint_law].name
                 : fluid.from         ? ", in cracks from its source"
                                      : ", in all cracks") +
                "; " + readable(start[i].length, "m", 4) + " of them at t = 0\n";
    }
    for (std::size_t i = 0; scenario.heat && i < scenario.materials.size(); ++i)
        if (const Thermal& thermal = scenario.heat->materials[i]; thermal.latent_heat > 0)
            text += formatted("  %s latent_heat %.4g J/kg over %.4g to %.4g K\n", scenario.materials[i].name.c_str(),
                              thermal.latent_heat, thermal.freezing_range[0], thermal.freezing_range[1]);
    return text;
}

}  // namespace knap
