#pragma once
// Triangles that lie over each other, in a mesh that was made elsewhere and in a deformed body.
#include "mesh/mesh.hpp"

#include <optional>

namespace knap {

/// Two triangles of a mesh that overlap though they share no edge: one with an edge on the boundary, and another. Only
/// overlaps deeper than a tenth of the smaller height count; shallower ones may be two outlines along one curve. `mesh`
/// needs its edges.
std::optional<std::array<Index, 2>> find_overlap(const Mesh& mesh);

struct CoveredTwice {
    double area = 0;            // [m2] sum of the common areas over all pairs of triangles
    double largest = 0;         // [m2] of one pair
    double triangles = 0;       // [-] sum of the same areas over that of the smaller triangle of the pair
    Vec2 place = Vec2::Zero();  // [m] the centroid of the largest common area
};

/// The area that a deformed body covers twice. `corner` [m] has three points for each triangle, in either orientation;
/// triangles with coordinates that are not finite are left out. `vertex` is the vertex of the mesh at each corner:
/// triangles with a common vertex slide along each other and overlap a little by the linearised contact, so of two of
/// these only an overlap deeper than a tenth of the smaller height counts.
CoveredTwice find_covered_twice(std::span<const Vec2> corner, std::span<const Index> vertex);

}  // namespace knap
