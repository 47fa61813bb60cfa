#pragma once
// The solver to use where nothing is known of the problem. It folds the problem, lets sweeps find most of the states, Newton the rest, and
// asks Lemke where both fail. Never forms a dense matrix of a large problem.
#include "lcp/problem.hpp"

namespace knap {

struct DefaultSolverOptions {
    double tolerance = 1e-11;  // natural residual of the folded problem, whose diagonal and q are of order one
    int largest_dense = 3000;  // unknowns up to which Lemke is the last resort
    Eigen::VectorXd start;     // warm start; empty: zero
};

LcpSolution solve_by_default(const LcpProblem& problem, const DefaultSolverOptions& options = {});

}  // namespace knap
