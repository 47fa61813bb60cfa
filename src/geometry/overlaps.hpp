#pragma once
#include "geometry/mesh.hpp"

#include <array>
#include <optional>

namespace knap {

/// Two triangles that lie over each other though they share no edge: one that has an edge on the boundary, and another. Deeper than a tenth of the smaller
/// one's height; less may be two outlines along one curve.
std::optional<std::array<Index, 2>> find_overlap(const Mesh& mesh);

}  // namespace knap
