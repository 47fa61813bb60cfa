#pragma once
// What a friction over slip or over pressure depends on, for all schemes.
#include "model/state.hpp"

namespace knap {

/// [m2] The area on which the friction over pressure of a point finds its pressure: that of the point, unless one other
/// point of its vertex joins the same two parts along the same face (same_face_beyond). Where the face is bent one of
/// the two bears what both would bear on a straight one, which of them may change from step to step, and on straight
/// ones they may share it in any way; the sum of two concave thresholds depends on that. What counts is the pressure of
/// the vertex, so each of them has the part of both areas that it had of both contact impulses in the last step,
///
///     S_i = (S_1 + S_2) p_i/(p_1 + p_2),   and no less than a tenth of S_1 + S_2
///
/// so that S_1 f(p_1/S_1) + S_2 f(p_2/S_2) = (S_1 + S_2) f((p_1 + p_2)/(S_1 + S_2)), however they share it.
double pressed_area(const Model& model, const State& begin, const Fan& fan, const FanPoint& point);

/// Friction of a law changes with the way of the slip.
inline bool follows_slip(const Model& model) {
    return std::ranges::any_of(model.laws, [](const CohesiveLaw& law) { return law.slip_distance > 0; });
}
/// The ways of all slips over a step, PointState::slid of `end`, where friction follows them: of points and of sides
/// that were one point before it retired.
void follow_slip(const Model& model, const State& begin, State& end);

}  // namespace knap
