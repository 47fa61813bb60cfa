#pragma once
// One softening of every shape but the linear one, by name.
#include "material/softening_shape.hpp"

#include <string>
#include <utility>
#include <vector>

namespace knap::tests {

inline std::vector<std::pair<std::string, std::shared_ptr<const SofteningShape>>> all_softening_shapes() {
    using Shape = SofteningOptions::Shape;
    return {{"petersson", make_softening({.shape = Shape::petersson})},
            {"mc2010", make_softening({.shape = Shape::mc2010})},
            {"exponential", make_softening({.shape = Shape::exponential})},
            {"trapezoid", make_softening({.shape = Shape::trapezoid, .plateau = 0.5})},
            {"power 2", make_softening({.shape = Shape::power, .exponent = 2})},
            {"table", make_softening({.shape = Shape::table, .table = {{0, 3}, {2, 2}, {4, 2}, {5, 0.5}, {9, 0}}})}};
}

}  // namespace knap::tests
