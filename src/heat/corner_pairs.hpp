#pragma once
// Pairs of corners of a triangle between which heat flows, and how well: of the linear triangle its sides, of order 2
// those of its six linear triangles.
#include "mesh/mesh.hpp"

#include <array>
#include <span>

namespace knap {

using CornerPair = std::array<Index, 2>;
inline constexpr std::array<CornerPair, 3> linear_pairs{{{0, 1}, {1, 2}, {2, 0}}};
/// Halves of the edges, then spokes to the centre: the sides of the six linear triangles round it.
inline constexpr std::array<CornerPair, 12> quadratic_pairs{
    {{0, 3}, {3, 1}, {1, 4}, {4, 2}, {2, 5}, {5, 0}, {0, 6}, {1, 6}, {2, 6}, {3, 6}, {4, 6}, {5, 6}}};
std::span<const CornerPair> corner_pairs(Index order);
/// [-] w/(k t) of these pairs in triangle t: half the cotangents of the opposite angles.
std::array<double, 12> half_cotangents(const Mesh& mesh, Index t);

}  // namespace knap
