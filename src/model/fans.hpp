#pragma once
// Interfaces and fans of a mesh: who meets whom at every edge and round every vertex.
#include "model/model.hpp"

namespace knap {

/// Which support each boundary edge stands on, or -1; same order as Mesh::boundary_edges.
using SupportOfEdge = std::vector<Index>;

/// Fills interfaces, fans, fan_corners, fan_points, fan_of_corner, fan_point_of from model.mesh.
void make_interfaces_and_fans(const ModelInput& input, const SupportOfEdge& support_of_edge, Model& model);

}  // namespace knap
