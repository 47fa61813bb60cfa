#pragma once
// Where triangles lie over each other: the area that a deformed body covers twice.
#include "base/vec.hpp"

#include <span>

namespace knap {

struct CoveredTwice {
    double area = 0;            // [m2] sum over all pairs of triangles of what they have in common
    double largest = 0;         // [m2] of one pair
    double triangles = 0;       // [-] sum of the same areas over that of the smaller triangle of the pair
    Vec2 place = Vec2::Zero();  // [m] the centroid of that
};

/// Triangles of three corners each, of either orientation; those that are no numbers are left out. `vertex`: of the mesh, one a corner. Triangles with a common
/// vertex slide along each other and meet a little by the linearised contact: of two of these counts only what goes deeper than a tenth of the smaller one's
/// height.
CoveredTwice find_covered_twice(std::span<const Vec2> corner, std::span<const Index> vertex);

}  // namespace knap
