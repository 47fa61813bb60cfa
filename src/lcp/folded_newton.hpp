#pragma once
// Semismooth Newton on the natural map of the folded problem: every unknown is free, at its lower or at its upper bound, and in given states
// the problem is linear (Hintermueller, Ito, Kunisch 2002). A proximal term makes rank-deficient and indefinite matrices harmless and goes
// away with convergence (Rockafellar 1976); a nonmonotone line search on the norm of the map keeps it on its way.
#include "lcp/fold.hpp"

namespace knap {

struct FoldedNewtonOptions {
    double tolerance = 1e-12;  // largest entry of the natural map
    int max_iterations = 60;
    double proximal = 1e-10;   // at the start
};

/// From x to the solution: x is the last iterate where the status is another.
LcpStatus solve_folded_by_newton(const FoldedLcp& problem, const FoldedNewtonOptions& options, Eigen::VectorXd& x, int& n_solves);

}  // namespace knap
