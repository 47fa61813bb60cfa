#pragma once
// The judge of all solvers: it knows M, q and z, and nothing that a solver says.
#include "lcp/problem.hpp"

namespace knap {

/// max |min(z, M z + q)| of the equilibrated problem, whose M and q are of order one; 0 for the empty problem and infinite where z is
/// not finite or of the wrong size. Without the equilibration the figure would depend on the units.
double scaled_residual(const LcpProblem& problem, const Eigen::VectorXd& z);

/// max |min(z, M z + q)| as the problem is written.
double natural_residual(const LcpProblem& problem, const Eigen::VectorXd& z);

}  // namespace knap
