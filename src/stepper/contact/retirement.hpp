#pragma once
// When a point leaves its fan: from then on its two sides meet as free faces.
#include "model/state.hpp"

namespace knap {

/// [-] Of the edge: the slip at which a point on the surface of the body retires. Others meet its sides as one vertex
/// at their mean. Below 0.001, which is rounding for the search, nothing is gained.
constexpr double retirement_slip = 0.002;
/// [-] Likewise, of a point inside the body.
constexpr double inner_retirement_slip = 0.015;

/// Marks in end.retired the points that retire: nothing holds them any more (beta = 0), their sides become vertices of
/// their own, and these have moved apart or along each other by more than a part of the edge, or have turned by as many
/// radians. In a fan on the surface this part is 0.002. Inside the body it is 0.015, or 0.002 as soon as corners of the
/// fan that are no neighbours overlap by more than 0.005 of an edge, since its points keep only neighbours apart, or as
/// soon as two of its points have retired: a part between them is a vertex at the mean of its corners for others, so
/// that half of what its own points slip would be overlap once they retire too.
///
/// Inside, earlier is not better: at a kink both faces press, and the wedge between them cracks (its opening, slip
/// times angle, passes the softening length). Free faces press on one side of a kink only, on a vertex as a whole;
/// handed over at 0.002, such cracks stop half-way (contact/README.md).
///
/// Parted are points that still hold while their sides are further apart than 0.02 of the edge or have turned by more
/// than 0.2 rad: a hinge, whose sides are vertices of their own for others, but not for each other. Meeting are all
/// points of a fan that hold where corners that they join, but not as neighbours, overlap by more than 0.005 of an
/// edge, once one with cohesion has slipped by as much: points keep only neighbours apart, so these corners meet as
/// free faces from now on. Positions, velocities and energies are untouched. What leaves its place on a support meets
/// the ground of all supports as others do. `before`: the marks of the step before, another vector; what only turns
/// becomes a hinge the step after the other end of its edge has a mark.
void retire_points(const Model& model, const std::vector<Retirement>& before, State& end);

}  // namespace knap
