#include "app/setup.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace knap {

Model build_model(const Scenario& scenario) {
    ModelInput input;
    input.mesh = scenario.given ? scenario.given->mesh : triangulate(scenario.shape, scenario.mesh);
    input.plane = scenario.plane;
    input.thickness = scenario.thickness;
    for (const NamedMaterial& material : scenario.materials) input.materials.push_back(material.elastic);
    for (const NamedLaw& law : scenario.laws) input.laws.push_back(law.law);
    input.law_of_pair = scenario.law_of_pair;
    input.loads = scenario.loads;
    input.foundations = scenario.foundations;
    input.initial_velocities = scenario.initial_velocities;
    return make_model(std::move(input));
}

StepPlan plan_steps(const Scenario& scenario, double stable_step, double until) {
    const TimeOptions& time = scenario.time;
    const double end = std::min(time.end, until);
    if (time.step > stable_step) {
        char text[160];
        std::snprintf(text, sizeof text, "time.step = %.3g s is beyond the stable step of the explicit bulk, %.3g s", time.step, stable_step);
        throw UserError("unstable-step", text, "use step = \"auto\", a smaller step, or a coarser mesh");
    }
    const double wanted = time.step > 0 ? time.step : time.safety * stable_step;
    const std::int64_t n = std::max<std::int64_t>(1, static_cast<std::int64_t>(std::ceil(time.end / wanted * (1 - 1e-12))));
    const double step = time.end / static_cast<double>(n);  // the same step whatever `until` is: a shorter run is the begin of the longer one
    return {step, std::min(n, static_cast<std::int64_t>(std::ceil(end / step * (1 - 1e-12)))), stable_step};
}

std::vector<Resolution> judge_resolution(const Scenario& scenario, double mean_edge) {
    std::vector<Resolution> found;
    for (std::size_t a = 0; a < scenario.materials.size(); ++a)
        for (std::size_t b = a; b < scenario.materials.size(); ++b) {
            const NamedLaw& law = scenario.laws[scenario.law_of_pair[a][b]];
            if (!law.law.breakable() || law.law.sigma_c <= 0) continue;
            const Elastic &one = scenario.materials[a].elastic, &other = scenario.materials[b].elastic;
            const double modulus = std::min(one.plane_modulus(scenario.plane), other.plane_modulus(scenario.plane));
            const double length = modulus * law.law.G_c / (law.law.sigma_c * law.law.sigma_c);
            const double zone = 9 * std::numbers::pi / 32 * length;
            const std::string material = a == b ? scenario.materials[a].name : scenario.materials[a].name + "-" + scenario.materials[b].name;
            found.push_back({material, law.name, length, zone, zone / mean_edge});
        }
    return found;
}

double mean_edge(const Mesh& mesh) {
    double sum = 0;
    for (const InteriorEdge& edge : mesh.interior_edges)
        sum += (mesh.corner(edge.triangle[0], edge.side[0]) - mesh.corner(edge.triangle[0], (edge.side[0] + 1) % 3)).norm();
    return mesh.interior_edges.empty() ? 0 : sum / static_cast<double>(mesh.interior_edges.size());
}

double finest_edge(const Scenario& scenario, double mean_edge) {
    for (const RefineBox& box : scenario.mesh.refine) mean_edge = std::min(mean_edge, box.size);
    return mean_edge;
}

double rayleigh_speed(const Scenario& scenario) { return scenario.materials.front().elastic.rayleigh_speed(scenario.plane); }

}  // namespace knap
