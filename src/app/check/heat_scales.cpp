#include "app/check/heat_scales.hpp"

#include "app/check/findings.hpp"
#include "app/setup/setup.hpp"
#include "base/display_unit.hpp"
#include "base/formatted.hpp"
#include "mesh/polygon.hpp"
#include "model/selections.hpp"
#include "output/outputs.hpp"

#include <algorithm>
#include <cmath>

namespace knap {

double HeatScales::layer() const { return std::sqrt(diffusivity * std::min(duration, passage)); }

namespace {

/// [m] The way of heat through the body: its smaller side, unless that is insulated; then the largest distance from
/// where heat comes or goes, or the side along which the temperature varies.
double way_of_heat(const Scenario& scenario, const Mesh& mesh) {
    const Heat& heat = *scenario.heat;
    const Box box = bounding_box(mesh.vertices);
    const Vec2 sides = box.extent();
    if (heat.exchanges.empty()) {
        const auto varies = [&](int k) {
            constexpr int n = 8;
            double low = infinity, high = -infinity;
            for (int i = 0; i <= n; ++i) {
                Vec2 place = 0.5 * (box.low + box.high);
                place[k] = box.low[k] + sides[k] * i / n;
                const double T = heat.field_at(place, 0);
                low = std::min(low, T), high = std::max(high, T);
            }
            return high - low > 1e-9 * (std::abs(low) + std::abs(high));
        };
        const bool x = varies(0), y = varies(1);
        return x == y ? sides.minCoeff() : x ? sides.x() : sides.y();
    }
    std::vector<Vec2> given;
    for (const HeatExchange& exchange : heat.exchanges) {
        using Kind = HeatExchange::Kind;
        if (exchange.kind == Kind::source) {
            for (const Index t : selected_triangles(mesh, exchange.on)) given.push_back(mesh.centroid(t));
        } else if (exchange.kind == Kind::temperature) {
            const std::vector<char> selected = selected_corners(mesh, exchange.on);
            for (Index c = 0; c < mesh.n_corners(); ++c)
                if (selected[c]) given.push_back(mesh.corner(c));
        } else {
            for (const std::size_t e : selected_edges(mesh, exchange.on))
                given.push_back(mesh.corner(mesh.boundary_edges[e].triangle, mesh.boundary_edges[e].side));
        }
    }
    constexpr std::size_t many = 1024;  // of each are enough for a length
    const std::size_t every_given = given.size() / many + 1, every_vertex = mesh.vertices.size() / many + 1;
    double depth = 0;
    for (std::size_t v = 0; v < mesh.vertices.size() && !given.empty(); v += every_vertex) {
        double nearest = infinity;
        for (std::size_t g = 0; g < given.size(); g += every_given)
            nearest = std::min(nearest, (given[g] - mesh.vertices[v]).squaredNorm());
        depth = std::max(depth, std::sqrt(nearest));
    }
    return std::max(sides.minCoeff(), depth);
}

}  // namespace

std::vector<HeatScales> judge_heat(const Scenario& scenario, const Mesh& mesh, double step) {
    std::vector<HeatScales> found;
    if (!scenario.heat || !scenario.heat->conduction) return found;
    const Heat& heat = *scenario.heat;
    double transfer = 0;  // [W/(m2 K)] largest
    for (const HeatExchange& exchange : heat.exchanges) transfer = std::max(transfer, exchange.transfer);
    const double edge = scenario.finest_edge(mean_edge(mesh)), way = way_of_heat(scenario, mesh);
    const SchemeOptions& scheme = scenario.time.scheme;
    const bool implicit = scheme.takes_implicit_steps(), damped = scheme.damping * scenario.time.end >= 10 ||
                                                                  (implicit && scheme.theta > 0.5) ||
                                                                  !scheme.absorbing.empty();
    for (std::size_t i = 0; i < scenario.materials.size(); ++i) {
        if (std::ranges::count(mesh.region, static_cast<Index>(i)) == 0) continue;
        const Elastic& elastic = scenario.materials[i].elastic;
        const Thermal& thermal = heat.materials[i];
        const double kappa = thermal.conductivity / (elastic.density * thermal.heat_capacity);
        found.push_back({.material = scenario.materials[i].name,
                         .diffusivity = kappa,
                         .passage = way * way / kappa,
                         .duration = heat.time_factor * scenario.time.end,
                         .edge = edge,
                         .convection = transfer > 0 ? thermal.smallest_conductivity() / transfer : 0,
                         .c_R = elastic.rayleigh_speed(scenario.plane),
                         .step = implicit ? step : 0,
                         .damped = damped});
    }
    return found;
}

namespace {

/// The field at one moment over the vertices of a mesh, and its strains as the stresses that they are where prevented.
struct FieldExtremes {
    double lowest = infinity, highest = -infinity;  // [K]
    double strain = 0;                              // [-] largest |e(T) - e(reference)|
    double stress = 0;                              // [Pa] E e/(1 - nu) in plane stress, E e/(1 - 2 nu) in plane strain
};

FieldExtremes field_extremes(const Scenario& scenario, const Mesh& mesh, double t) {
    FieldExtremes found;
    const Heat& heat = *scenario.heat;
    for (Index triangle = 0; triangle < mesh.n_triangles(); ++triangle) {
        const Index region = mesh.region[triangle];
        const Elastic& elastic = scenario.materials[region].elastic;
        const Expansion& expansion = heat.materials[region].expansion;
        const double prevented = elastic.E / (1 - (scenario.plane == PlaneModel::strain ? 2 : 1) * elastic.nu);
        for (const Index vertex : mesh.triangles[triangle]) {
            const double T = heat.field_at(mesh.vertices[vertex], t),
                         strain = std::abs(expansion(T) - expansion(heat.reference));
            found.lowest = std::min(found.lowest, T), found.highest = std::max(found.highest, T);
            found.strain = std::max(found.strain, strain);
            found.stress = std::max(found.stress, prevented * strain);
        }
    }
    return found;
}

/// "20 C", "20 to 400 C"
std::string range_text(const FieldExtremes& field, const char* unit) {
    const std::string low = formatted("%.6g", field.lowest), high = formatted("%.6g", field.highest);
    return (low == high ? low : low + " to " + high) + " " + unit;
}

/// [Pa] The smallest sigma_c of the laws with cohesion that can break; infinite without one.
double smallest_strength(const Scenario& scenario) {
    double smallest = infinity;
    for (const NamedLaw& named : scenario.laws)
        if (named.law.breakable() && named.law.sigma_c > 0) smallest = std::min(smallest, named.law.sigma_c);
    return smallest;
}

}  // namespace

std::array<double, 2> temperatures_of_run(const Scenario& scenario, const Mesh& mesh) {
    const Heat& heat = *scenario.heat;
    const double end = scenario.time.end;
    FieldExtremes found = field_extremes(scenario, mesh, 0);
    const auto include = [&](double T) {
        found.lowest = std::min(found.lowest, T), found.highest = std::max(found.highest, T);
    };
    if (!heat.conduction && !heat.field.is_constant()) {
        constexpr int n_samples = 8;
        std::vector<double> times;
        for (int i = 1; i <= n_samples; ++i) times.push_back(end * i / n_samples);
        for (const double t : heat.field.history.time)
            if (t > 0 && t < end && times.size() < 3 * n_samples) times.push_back(t);
        for (const double t : times) {
            const FieldExtremes at = field_extremes(scenario, mesh, t);
            include(at.lowest), include(at.highest);
        }
    }
    for (const HeatExchange& exchange : heat.exchanges) {
        using Kind = HeatExchange::Kind;
        const bool gives = exchange.kind == Kind::flux || exchange.kind == Kind::source;
        for (const double factor : exchange.history.range(0, end))
            if (!gives) include(heat.follow(exchange.value, factor));
            else if (const double heating = exchange.value * factor; heating != 0)
                include(std::copysign(infinity, heating));
    }
    return {found.lowest, found.highest};
}

std::string heat_text(const Scenario& scenario, const Mesh& mesh, double step) {
    if (!scenario.heat) return "";
    const Heat& heat = *scenario.heat;
    const char* const unit = unit_of_temperature("K", heat.celsius).data();
    if (heat.field.frozen)
        return formatted("heat\n  temperatures stay those of the other run; reference %.6g %s\n", heat.reference, unit);
    const FieldExtremes start = field_extremes(scenario, mesh, 0);
    std::string text = "heat\n  temperature  " + range_text(start, unit) + " at t = 0";
    FieldExtremes largest = start;
    if (!heat.conduction && !heat.field.is_constant()) {
        largest = field_extremes(scenario, mesh, scenario.time.end);
        text += ", " + range_text(largest, unit) + " at the end";
        if (start.stress > largest.stress) largest = start;
    }
    text += formatted("; reference %.6g %s", heat.reference, unit);
    if (largest.strain > 0) {
        text += formatted(": strains up to %.3g, as stresses, where prevented, ", largest.strain) +
                readable(largest.stress, "Pa");
        if (const double strength = smallest_strength(scenario); std::isfinite(strength))
            text += formatted(", %.3g times the smallest strength", largest.stress / strength);
    }
    text += "\n";
    for (const HeatScales& s : judge_heat(scenario, mesh, step)) {
        const double factor = heat.time_factor;
        text += formatted(
            "  %-12s kappa_T %.3g m2/s; heat crosses the body in %s; the run is %s of heat (time_factor %g)\n",
            s.material.c_str(), s.diffusivity, readable(s.passage, "s").c_str(), readable(s.duration, "s").c_str(),
            factor);
        text += formatted("  %-12s its layer sqrt(kappa_T t) at the end %s, %.1f edges", "",
                          readable(s.layer(), "m").c_str(), s.layer() / s.edge);
        if (s.convection > 0)
            text += formatted("; k over transfer %s, %.1f edges", readable(s.convection, "m").c_str(),
                              s.convection / s.edge);
        text += formatted(
            "\n  %-12s cracks that follow it over an edge run at %s, here %.2g of c_R, the part of their energy that "
            "they radiate; time_factor up to %.2g keeps it below %.2g%s\n",
            "", readable(s.crack_speed(), "m/s", 2).c_str(), s.radiated(factor), std::max(1.0, s.largest_time_factor()),
            s.largest_speed(), s.damped ? "" : ", since nothing damps these waves");
        if (s.step > 0)
            text += formatted("  %-12s steps of backward Euler: %.3g in the time that heat takes through the body%s\n",
                              "", s.passage / (factor * s.step),
                              scenario.time.scheme.theta > 0.5 ? "; a point that breaks within one has no cohesive "
                                                                 "work (theta > 0.5), its G_c counts as scheme "
                                                                 "dissipation: limits.law_lag"
                                                               : "");
    }
    return text;
}

std::vector<Diagnostic> findings_of_hot_start(const ReadResult& read, const Model& model) {
    const Scenario& scenario = read.scenario;
    if (!scenario.heat || scenario.time.start_in_equilibrium || !scenario.time.start_run.empty()) return {};
    const Heat& heat = *scenario.heat;
    const FieldExtremes start = field_extremes(scenario, model.mesh, 0);
    const double strength = smallest_strength(scenario);
    if (!(start.stress > strength / 3)) return {};
    const char* const unit = unit_of_temperature("K", heat.celsius).data();
    return {read.at(
        "heat.temperature",
        {.severity = Diagnostic::Severity::warning,
         .code = "hot-start",
         .message = formatted(
             "at t = 0 the body is undeformed at %s, and without thermal strain at a `heat.reference` of %.6g %s: "
             "stresses up to %s at once, %.2g times the smallest strength, as by a blow",
             range_text(start, unit).c_str(), heat.reference, unit, readable(start.stress, "Pa").c_str(),
             start.stress / strength),
         .note = formatted("reference = \"%.6g %s\" if it is free of stress then; start = \"equilibrium\" in [time] if "
                           "it has been at rest with these strains; ramp or table in [heat] if they come in the run",
                           heat.field_at(model.mesh.vertices.front(), 0), unit)})};
}

}  // namespace knap
