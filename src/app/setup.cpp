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
    input.mesh.order = scenario.order;
    input.plane = scenario.plane;
    input.thickness = scenario.thickness;
    for (const NamedMaterial& material : scenario.materials) input.materials.push_back(material.elastic);
    for (const NamedLaw& law : scenario.laws) input.laws.push_back(law.law);
    input.law_of_pair = scenario.law_of_pair;
    input.loads = scenario.loads;
    input.foundations = scenario.foundations;
    input.initial_velocities = scenario.initial_velocities;
    input.obstacles = scenario.obstacles;
    return make_model(std::move(input));
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
            found.push_back({material, law.name, length, zone, zone / mean_edge,
                             std::max(one.dilatational_speed(scenario.plane), other.dilatational_speed(scenario.plane))});
        }
    return found;
}

double assumption_1_step(const Resolution& resolution, double edge, double theta) {
    return 0.43 / theta * std::sqrt(resolution.cohesive_length / edge) * edge / resolution.wave_speed;
}

double mean_edge(const Mesh& mesh) {
    double sum = 0;
    for (const InteriorEdge& edge : mesh.interior_edges)
        sum += (mesh.corner(edge.triangle[0], edge.side[0]) - mesh.corner(edge.triangle[0], (edge.side[0] + 1) % 3)).norm();
    return mesh.interior_edges.empty() ? 0 : sum / static_cast<double>(mesh.interior_edges.size());
}

double finest_edge(const Scenario& scenario, double mean_edge) {
    for (const RefineBox& box : scenario.mesh.refine) mean_edge = std::min(mean_edge, box.size);
    return mean_edge / scenario.order;
}

double rayleigh_speed(const Scenario& scenario) { return scenario.materials.front().elastic.rayleigh_speed(scenario.plane); }

}  // namespace knap
