#pragma once
// Names of edges from the lines of a Gmsh file: boundaries, and lines inside the body.
#include "geometry/gmsh_file.hpp"
#include "geometry/gmsh_mesh.hpp"
#include "geometry/gmsh_node_numbers.hpp"

namespace knap {

/// Fills boundary names and inner lines of a mesh that has its edges; `vertex_of_node` is -1 for nodes without triangles. Lines of a
/// group that are no side of a triangle go into the warnings.
void name_edges(const GmshSource& source, const GmshFile& file, const GmshNodeNumbers& numbers, const std::vector<Index>& vertex_of_node,
                GmshMesh& made);

}  // namespace knap
