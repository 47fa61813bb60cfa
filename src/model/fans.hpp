#pragma once
// Interfaces and fans of a mesh.
#include "model/model.hpp"

namespace knap {

/// The support of each boundary edge, or -1; in the order of Mesh::boundary_edges.
using SupportOfEdge = std::vector<Index>;

/// Makes the interfaces of model.mesh, those of its interior edges first and in their order.
void make_interfaces(const ModelInput& input, const SupportOfEdge& support_of_edge, Model& model);

/// The law of an edge between two triangles: its number among the laws of a ModelInput or a Scenario.
template <class Laws>
Index law_of_edge(const Laws& laws, const Mesh& mesh, const InteriorEdge& edge) {
    const Index a = mesh.region[edge.triangle[0]], b = mesh.region[edge.triangle[1]];
    return edge.joint >= 0           ? laws.law_of_joint[edge.joint]
           : mesh.within_grain(edge) ? laws.law_within[a]
                                     : laws.law_of_pair[a][b];
}

/// Makes the fans (anew) from the interfaces that are not gone, and from the masses of the corners.
void make_fans(Model& model);

/// Gives every interface whose law scatters, or follows the angle to the layers, a law of its own, behind the others in
/// model.laws.
void vary_strength(const ModelInput& input, Model& model);

}  // namespace knap
