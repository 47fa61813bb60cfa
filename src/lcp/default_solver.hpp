#pragma once
// The solver to use where nothing is known of the problem. It folds the problem, lets sweeps find most of the states and Newton the rest.
// Where both fail, as in steps beyond Assumption 1, proximal points are tried, then every other solver on the whole problem, until the judge accepts an
// answer: so it is never worse than any of them, and a problem that none solves takes as long as all of them. Never forms a dense matrix of a large problem.
#include "lcp/problem.hpp"

namespace knap {

struct DefaultSolverOptions {
    double tolerance = 1e-11;  // natural residual of the folded problem, whose diagonal and q are of order one
    double acceptable = 5e-11;  // of the best iterate, where all have come to a standstill at a degenerate solution
    double largest_residual = 1e-10;  // scaled (residual.hpp), of an answer that is accepted
    bool every_solver = true;  // false: after proximal points only three paths of Lemke, whatever they come to
    int largest_dense = 3000;  // unknowns up to which solvers with a dense matrix are tried
    Eigen::VectorXd start;     // warm start; empty: zero
};

LcpSolution solve_by_default(const LcpProblem& problem, const DefaultSolverOptions& options = {});

}  // namespace knap
