#pragma once
// Infeasible primal-dual interior point method with predictor and corrector (Mehrotra 1992; S. Wright, Primal-Dual Interior-Point Methods,
// SIAM 1997, 8). It has a theory for positive semidefinite M only; elsewhere it is a heuristic and may say `stalled`. It ends near the
// middle of a set of solutions, so of two solutions it does not choose a vertex, as the pivoting methods do. No warm start: it would begin
// at the boundary.
#include "lcp/problem.hpp"

namespace knap {

struct InteriorPointOptions {
    double tolerance = 1e-11;  // natural residual of the equilibrated problem
    int max_iterations = 150;
    double crossover = 1e-6;       // residual from which a few active-set steps may finish what the central path cannot
    int max_crossover_steps = 10;
};

LcpSolution solve_by_interior_point(const LcpProblem& problem, const InteriorPointOptions& options = {});

}  // namespace knap
