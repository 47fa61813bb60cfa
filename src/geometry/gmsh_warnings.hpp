#pragma once
#include "geometry/mesh.hpp"

#include <string>
#include <vector>

namespace knap {

/// What is probably not meant in a mesh that was made elsewhere: pieces that do not hang together, vertices on top of each other.
std::vector<std::string> mesh_warnings(const Mesh& mesh);

}  // namespace knap
