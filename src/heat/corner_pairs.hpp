#pragma once
// Pairs of corners of a triangle between which heat flows, and how well: of the linear triangle its sides, of order 2
// those of its six linear triangles.
#include "mesh/mesh.hpp"

#include <array>
#include <span>

namespace knap {

using CornerPair = std::array<Index, 2>;
std::span<const CornerPair> corner_pairs(Index order);
/// [-] w/(k t) of these pairs in triangle t: half the cotangents of the opposite angles.
std::array<double, 12> half_cotangents(const Mesh& mesh, Index t);

}  // namespace knap
