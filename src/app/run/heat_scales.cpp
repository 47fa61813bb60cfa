#include "app/run/heat_scales.hpp"

#include "app/run/setup.hpp"
#include "base/formatted.hpp"
#include "mesh/polygon.hpp"

#include <algorithm>
#include <cmath>

namespace knap {

double HeatScales::layer() const { return std::sqrt(diffusivity * std::min(duration, passage)); }

std::vector<HeatScales> judge_heat(const Scenario& scenario, const Mesh& mesh, double step) {
    std::vector<HeatScales> found;
    if (!scenario.heat || !scenario.heat->conduction) return found;
    const Heat& heat = *scenario.heat;
    double transfer = 0;  // [W/(m2 K)] largest
    for (const HeatExchange& exchange : heat.exchanges) transfer = std::max(transfer, exchange.transfer);
    const double edge = scenario.finest_edge(mean_edge(mesh)), side = bounding_box(mesh.vertices).extent().minCoeff();
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
                         .passage = side * side / kappa,
                         .duration = heat.time_factor * scenario.time.end,
                         .edge = edge,
                         .convection = transfer > 0 ? thermal.smallest_conductivity() / transfer : 0,
                         .c_R = elastic.rayleigh_speed(scenario.plane),
                         .step = implicit ? step : 0,
                         .damped = damped});
    }
    return found;
}

std::string heat_text(const Scenario& scenario, const Mesh& mesh, double step) {
    std::string text;
    for (const HeatScales& s : judge_heat(scenario, mesh, step)) {
        const double factor = scenario.heat->time_factor;
        text += formatted(
            "  %-12s kappa_T %.3g m2/s; heat crosses the body in %.3g s; the run is %.3g s of heat (time_factor %g)\n",
            s.material.c_str(), s.diffusivity, s.passage, s.duration, factor);
        text += formatted("  %-12s its layer sqrt(kappa_T t) at the end %.3g mm, %.1f edges", "", 1e3 * s.layer(),
                          s.layer() / s.edge);
        if (s.convection > 0)
            text += formatted("; k over transfer %.3g mm, %.1f edges", 1e3 * s.convection, s.convection / s.edge);
        text += formatted(
            "\n  %-12s cracks that follow it over an edge run at %.2g m/s, here %.2g of c_R, the part of their energy "
            "that they radiate; time_factor up to %.2g keeps it below %.2g%s\n",
            "", s.crack_speed(), s.radiated(factor), std::max(1.0, s.largest_time_factor()), s.largest_speed(),
            s.damped ? "" : ", since nothing damps these waves");
        if (s.step > 0)
            text += formatted("  %-12s steps of backward Euler: %.3g in the time that heat takes through the body%s\n",
                              "", s.passage / (factor * s.step),
                              scenario.time.scheme.theta > 0.5 ? "; a point that breaks within one has no cohesive "
                                                                 "work (theta > 0.5), its G_c counts as scheme "
                                                                 "dissipation: limits.law_lag"
                                                               : "");
    }
    return text.empty() ? text : "heat\n" + text;
}

}  // namespace knap
