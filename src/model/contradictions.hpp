#pragma once
// Loads that contradict each other: two different prescribed motions of one component of a node, and a traction or
// force on a component with prescribed motion, which the drive alone would carry.
//
// Allowed are equal motions (of a corner that two driven boundaries share), tractions that add up, and a traction on a
// boundary next to a driven one: its part on the common node goes to the drive.
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

/// One per pair of loads, component and kind.
std::vector<Contradiction> find_contradictions(const Model& model, const std::vector<Load>& loads);

}  // namespace knap
