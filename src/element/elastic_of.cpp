#include "element/elastic_of.hpp"

#include <map>

namespace knap {

ElasticKinds::ElasticKinds(const Mesh& mesh, const std::vector<Elastic>& materials)
    : all(materials), of_triangle(mesh.region) {
    std::map<std::pair<Index, double>, Index> known;  // by material and angle
    for (Index t = 0; t < std::ssize(mesh.layer_angle); ++t) {
        const Index material = mesh.region[t];
        if (!materials[material].bedding) continue;
        const auto [place, is_new] = known.try_emplace({material, mesh.layer_angle[t]}, static_cast<Index>(all.size()));
        if (is_new) all.push_back(elastic_of(mesh, materials, t));
        of_triangle[t] = place->second;
    }
}

}  // namespace knap
