#pragma once
// Projected block Gauss-Seidel: the blocks are solved one after the other by Lemke, the rest of z frozen (Cottle, Pang, Stone, The Linear
// Complementarity Problem, 5.2; Jean 1999, nonsmooth contact dynamics). Blocks of one are the classical projected method, which needs a
// positive diagonal. By default an unknown without one is put in a block with what its row couples to: multipliers with their bounds.
#include "lcp/problem.hpp"

#include <vector>

namespace knap {

struct GaussSeidelOptions {
    double tolerance = 1e-11;  // natural residual of the equilibrated problem
    int max_sweeps = 20000;
    std::vector<std::vector<int>> blocks;  // a partition of the unknowns; empty: from the matrix
    Eigen::VectorXd start;                 // warm start; empty: zero
};

/// Unknowns joined through the rows with a zero on the diagonal.
std::vector<std::vector<int>> blocks_of_zero_diagonal(const LcpMatrix& M);

LcpSolution solve_by_gauss_seidel(const LcpProblem& problem, const GaussSeidelOptions& options = {});

}  // namespace knap
