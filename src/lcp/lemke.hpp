#pragma once
// The linear complementarity problem  w = M z + q,  0 <= w  perp  z >= 0,  by Lemke's pivots on a dense tableau (C. E. Lemke 1965; Cottle,
// Pang, Stone, The Linear Complementarity Problem, 4.4). Ties are broken lexicographically, so that it cannot cycle. Where the path
// of the pivots ends on a ray, paths from other covering vectors are tried. Small problems only: a tableau of n (2n + 2) numbers.
#include <Eigen/Core>

namespace knap {

/// M and q should be of order one. Empty when every path ends on a ray: then there is hardly a solution.
Eigen::VectorXd solve_lcp_by_lemke(const Eigen::MatrixXd& M, const Eigen::VectorXd& q);

}  // namespace knap
