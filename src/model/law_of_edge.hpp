#pragma once
// Which law acts on an edge between two triangles.
#include "mesh/mesh.hpp"

namespace knap {

/// Its number among the laws of a ModelInput or a Scenario.
template <class Laws>
Index law_of_edge(const Laws& laws, const Mesh& mesh, const InteriorEdge& edge) {
    const Index a = mesh.region[edge.triangle[0]], b = mesh.region[edge.triangle[1]];
    return edge.joint >= 0           ? laws.law_of_joint[edge.joint]
           : mesh.within_grain(edge) ? laws.law_within[a]
                                     : laws.law_of_pair[a][b];
}

}  // namespace knap
