#pragma once
// Reactions round a closed chain that sticks everywhere are known up to one free 2-vector c, added to every point: the chain stays
// bound if and only if some c makes every point admissible (static theorem of limit analysis; formulation: node binding).
#include "base/vec.hpp"

#include <array>
#include <vector>

namespace knap {

/// value + gradient . c >= 0
struct HalfPlane {
    double value;
    Vec2 gradient;
    Index link;
    int kind;  // 0 = tension, +1 / -1 = shear in the direction of +T / -T
};

struct Circulation {
    Vec2 c = Vec2::Zero();
    double slack = 0;                 // smallest of all half planes at c; >= 0: admissible
    std::array<Index, 3> binding{};   // the half planes that prevent more, when slack < 0: they are the opening mechanism
    int n_binding = 0;
};

/// Climbs the smallest slack (concave, piecewise linear) from `start` by steepest ascent; stops as soon as it is >= 0, or at the maximum.
Circulation find_circulation(const std::vector<HalfPlane>& planes, const Vec2& start);

}  // namespace knap
