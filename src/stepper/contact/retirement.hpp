#pragma once
// When a point leaves its fan: from then on its two sides meet as free faces.
#include "model/state.hpp"

namespace knap {

/// [-] Of the edge. The points of a fan keep neighbours apart. Corners of a star of cracks that are no neighbours
/// overlap by up to three times this before they meet as free faces: by 0.1 edge with 0.05, 0.028 with 0.01, 0.006 with
/// 0.002 (protection_wall), and such overlaps jam. Below 0.001, which is rounding for the search, nothing is gained.
constexpr double retirement_slip = 0.002;

/// Marks in end.retired the points that retire: nothing holds them any more (beta = 0), and their sides have moved
/// apart or along each other by more than this part of the edge, or have turned against each other by more than
/// 0.002 rad. Likewise (2) the points that still hold while their sides are further apart than 0.02 of the edge or have
/// turned by more than 0.2 rad: a hinge, whose sides are vertices of their own for others, but not for each other.
/// The fixed normal of a point errs by (slip/length)^2; penetration in general contact falls with the threshold, forces
/// do not depend on it between 0.02 and 0.5. Positions, velocities and energies are untouched. What leaves its place
/// on a support meets the ground of all supports as others do. `before`: the marks of the step before, another vector;
/// what only turns becomes a hinge the step after the other end of its edge has a mark.
void retire_points(const Model& model, const std::vector<std::uint8_t>& before, State& end);

}  // namespace knap
