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

/// Block Gauss-Seidel with Lemke on the blocks: the cohesive rows of a point, its contact rows. (With both in one block
/// it fails, since friction and tangential cohesion of a sticking point are then one impulse too many.) `start` may be
/// empty.
Outcome block_gauss_seidel(const knap::LcpProblem& problem, const Eigen::VectorXd& start);

}  // namespace peer
