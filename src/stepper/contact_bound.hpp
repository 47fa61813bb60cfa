#pragma once
// The contact bound of an implicit step (implicit_scheme.hpp):  w_N >= c.
#include "model/state.hpp"

#include <algorithm>
#include <optional>

namespace knap {

/// Openings are differences of displacements: what is this small beside them is rounding, and the sides touch. Without it a point with
/// restitution that is held closed loses its contact in every step that leaves u_N = +1e-17, and its cohesion pulls the sides into each
/// other.
constexpr double touching_tolerance = 1e-11;

/// [m] What u_N of a point is a difference of: displacements, gap and delta_c.
inline double length_behind_opening(const FanPoint& point, const CohesiveLaw& law, const State& state) {
    const auto moved = [&](Index corner) { return corner == ground ? 0 : state.displacement[state.node_of_corner[corner]].norm(); };
    return moved(point.before) + moved(point.after) + point.gap + law.delta_c();
}

/// [-] e of a point in a step that begins with cohesion `beta`. Restitution is for faces that meet: what is thrown back must first touch, and by then cohesion
/// would pull a damaged point into the other side by the whole of its approach.
inline double restitution_in_step(const CohesiveLaw& law, double beta) { return beta > 0 ? 0 : law.restitution; }

/// [m/s] c, or nothing: the point cannot touch within the step. `length` [m]: length_behind_opening.
inline std::optional<double> contact_bound(double u_N, double V_N, double length, double restitution, double h, double theta) {
    const double approach = std::max(-V_N, 0.0);
    if (u_N <= touching_tolerance * length) return -(1 - theta * (1 + restitution)) * approach;  // Newton's law against an approach
    if (restitution > 0) return std::nullopt;                                                    // it must touch first
    return std::min(-u_N / h, -(1 - theta) * approach);                                          // lands, or stops at the wall
}

}  // namespace knap
