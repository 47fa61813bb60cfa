#pragma once
// Shapes that the tests share.
#include "mesh/shape.hpp"
#include "support/relative.hpp"

namespace knap::testing {

using tests::relative;

/// 0.1 m x 0.04 m, sides named bottom, right, top, left.
inline Shape block() {
    Shape shape;
    shape.boundary_names = {"bottom", "right", "top", "left", "hole"};
    shape.outer = {{{0, 0}, {0.1, 0}, {0.1, 0.04}, {0, 0.04}}, {0, 1, 2, 3}};
    return shape;
}

inline void add_hole(Shape& shape, const std::vector<Vec2>& points) {
    shape.holes.push_back({points, std::vector<Index>(points.size(), 4)});
}

}  // namespace knap::testing
