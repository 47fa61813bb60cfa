#pragma once
// A mesh as a file: Gmsh 2.2 ASCII (.msh), VTK XML ASCII (.vtu), or a picture (.svg).
#include "mesh/mesh.hpp"

#include <string>
#include <vector>

namespace knap {

/// Throws std::invalid_argument for another ending than .msh, .vtu, .svg. A .msh file has a physical group for each
/// boundary, for each region (`region0` ... without names), for the cracks (`crack`) and for each joint set (`joint0`).
/// A picture has a legend of what is named: regions, and joint sets, of which those of one name have one colour.
std::string mesh_as_text(const Mesh& mesh, const std::string& ending, const std::vector<std::string>& region_names = {},
                         const std::vector<std::string>& joint_names = {});

}  // namespace knap
