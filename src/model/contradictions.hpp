#pragma once
// Loads that cannot both hold: two prescribed motions of one component of a node that differ, and a traction or force on a component whose
// motion is prescribed, which the support alone would carry.
//
// Lawful are the same motion twice (a corner that two held boundaries share), tractions that add up, and a traction on one boundary beside
// a motion on its neighbour: its part on the node that they share goes to the support.
#include "model/model.hpp"

#include <array>
#include <cstddef>
#include <vector>

namespace knap {

struct Contradiction {
    enum class Kind { motions, traction, force };
    Kind kind;
    std::array<std::size_t, 2> load;  // numbers in the list of loads, ascending
    int component;                    // 0 = x, 1 = y
    Vec2 where;                       // [m] first place found
};

/// Each pair of loads once for each component.
std::vector<Contradiction> find_contradictions(const Model& model, const std::vector<Load>& loads);

}  // namespace knap
