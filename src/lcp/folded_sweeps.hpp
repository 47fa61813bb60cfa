#pragma once
// Projected Gauss-Seidel on the folded problem: one unknown after the other to the zero of its row, within its bounds (Cottle, Pang, Stone,
// The Linear Complementarity Problem, 5.2). It needs a positive diagonal.
#include "lcp/fold.hpp"

namespace knap {

bool has_positive_diagonal(const FoldedLcp& problem);

/// The largest |change of x| of the last of n sweeps, in units of the diagonal.
double sweep(const FoldedLcp& problem, Eigen::VectorXd& x, int n_sweeps);

}  // namespace knap
