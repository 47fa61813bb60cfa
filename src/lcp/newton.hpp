#pragma once
// Semismooth Newton on the natural map min(z, M z + q), which is the primal-dual active set method (Hintermueller, Ito, Kunisch 2002;
// Facchinei, Pang, Finite-Dimensional Variational Inequalities, 9). Three safeguards: a proximal term for rank-deficient matrices, a
// nonmonotone line search on the Fischer-Burmeister merit (De Luca, Facchinei, Kanzow 1996), and a start from a few block Gauss-Seidel
// sweeps.
#include "lcp/problem.hpp"

namespace knap {

struct NewtonOptions {
    double tolerance = 1e-11;  // natural residual of the equilibrated problem
    int max_iterations = 100;  // of each start
    int n_starts = 4;          // each after more sweeps than the one before
    Eigen::VectorXd start;     // warm start; empty: zero
};

LcpSolution solve_by_newton(const LcpProblem& problem, const NewtonOptions& options = {});

}  // namespace knap
