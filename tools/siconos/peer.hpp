#pragma once
// The LCP solvers of Siconos numerics behind the contract of src/lcp.
#include "lcp/problem.hpp"

namespace peer {

struct Outcome {
    Eigen::VectorXd z;
    double seconds = 0;  // of processor time, without building the matrix in their format
    bool claimed = false;
};

Outcome lemke(const knap::LcpProblem& problem);
Outcome newton_min(const knap::LcpProblem& problem);

/// Block Gauss-Seidel with Lemke on the blocks; a block is a cohesive point with its contact. `start` may be empty.
Outcome block_gauss_seidel(const knap::LcpProblem& problem, const Eigen::VectorXd& start);

}  // namespace peer
