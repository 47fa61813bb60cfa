#pragma once
// Where the folded problem has a symmetric, positive semidefinite matrix and constant bounds, it is the optimum of the convex problem
//     min 1/2 x'M x + q'x,   lower <= x <= upper
// e.g. frictionless contact with the cohesion frozen, or mode I without contact. Projected Newton on the unknowns that are not held by a
// bound, with a search along the projected step (Bertsekas, SIAM J. Control Optim. 20, 1982): the objective falls in every iteration, so
// that it cannot cycle, and a small proximal term makes rank-deficient matrices harmless. For other problems it is not applicable.
#include "lcp/problem.hpp"

namespace knap {

struct ConvexQpOptions {
    double tolerance = 1e-11;  // natural residual of the folded problem
    int max_iterations = 300;
    Eigen::VectorXd start;  // warm start; empty: zero
};

LcpSolution solve_by_convex_qp(const LcpProblem& problem, const ConvexQpOptions& options = {});

}  // namespace knap
