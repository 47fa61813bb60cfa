#pragma once
// Absorbing boundaries: dashpots that take up waves as the body would if it went on (J. Lysmer and R. L. Kuhlemeyer,
// J. Eng. Mech. Div. ASCE 95, EM4 (1969) 859). Exact for plane waves of normal incidence; others return in part.
//
//     traction = -rho c_p v_n n - rho c_s v_t t                   C: lumped at the corners of the boundary
//     explicit    M (v+ - v) = k (F - C (v + v+)/2) + H' P        at the mean velocity they never give energy back and
//     implicit    M (v+ - v) = h (F - C w) + H' P                 leave the stable step as it is; likewise at w
#include "model/model.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <span>

namespace knap {

/// On a corner: the force -C v.
struct Dashpot {
    Index fan, corner;
    Eigen::Matrix2d C;  // [kg/s] symmetric
};

/// In the order of (fan, corner). Throws UserError where a selection is empty, and where a support holds or a motion
/// leads the boundary.
std::vector<Dashpot> dashpots_on(const Model& model, const std::vector<Selection>& boundaries);

}  // namespace knap
