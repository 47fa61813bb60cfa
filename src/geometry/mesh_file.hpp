#pragma once
// A mesh as a file: Gmsh 2.2 ASCII (.msh), VTK XML ASCII (.vtu), or a picture (.svg).
#include "geometry/mesh.hpp"

#include <string>

namespace knap {

/// Throws std::invalid_argument for another ending than .msh, .vtu, .svg.
std::string mesh_as_text(const Mesh& mesh, const std::string& ending);

}  // namespace knap
