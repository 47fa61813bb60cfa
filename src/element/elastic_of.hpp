#pragma once
// The elastic constants of a triangle: those of its material, with layers in the direction that they have there.
#include "material/elastic.hpp"
#include "mesh/mesh.hpp"

namespace knap {

inline Elastic elastic_of(const Mesh& mesh, const std::vector<Elastic>& materials, Index triangle) {
    Elastic elastic = materials[mesh.region[triangle]];
    if (elastic.bedding && !mesh.layer_angle.empty()) elastic.bedding->angle = mesh.layer_angle[triangle];
    return elastic;
}

/// Those of all triangles, each once: the materials, then one for every other angle of layers.
struct ElasticKinds {
    ElasticKinds(const Mesh& mesh, const std::vector<Elastic>& materials);

    std::vector<Elastic> all;
    std::vector<Index> of_triangle;
};

}  // namespace knap
