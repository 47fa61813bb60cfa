#pragma once
// Which fans surely stay in one piece, by the stress of their triangles (of order 2: by the forces on their corners, |f_i| <= s L_i) alone.
//
// With |sigma|_F <= s in all its triangles, a fan that moves as one has reactions R_j = sum_i a_ji f_i (walk of the chain and least-norm
// self-stress), |f_i| <= s L_i (force_of_unit_stress). A point holds every reaction up to
// S sigma_c min(1, (gamma + mu)/sqrt(1 + mu^2)): the distance of its strength polygon from the origin. So the fan holds if
//     s <= min_j  S_j rho_j / sum_i |a_ji| L_i.
#include "model/model.hpp"

#include <vector>

namespace knap {

/// [Pa^2] per fan: no test is needed while |sigma|_F^2 stays at or below. Infinite for a fan that cannot break, negative (always test)
/// for one that is split from the start, loaded, or driven.
std::vector<double> stress_thresholds(const Model& model);

/// [N] the largest reaction, in any direction, that a point of this law and area [m2] surely holds.
double sure_strength(const CohesiveLaw& law, double area);

}  // namespace knap
