#pragma once
// Symmetric equilibration, and the residual by which every answer is judged. D M D has entries of order one, q / unit
// too. With z = unit D z' and w = unit D^-1 w' the scaled problem is the same complementarity problem: z' . w' is z . w
// up to one factor, and a semidefinite M stays semidefinite.
//     rows with a diagonal       |D M D| = 1 on it: this fixes what z' = 1 means
//     rows without one           bounds and their multipliers: the largest coupling is 1 (Ruiz, RAL-TR-2001-034)
// The diagonal comes first: the size of the entries alone leaves an impulse and its bound (r_T and chi, p_T and zeta) a
// common factor, (x, 1/x), which in a short step can hide the rate of the point beside the bound. Where a matrix is not
// monotone, a diagonal can be small beside its row; such a row is scaled by its largest entry.
#include "lcp/problem.hpp"

namespace knap {

struct ScaledLcp {
    LcpProblem problem;
    Eigen::VectorXd factor;  // diagonal of D
    double unit = 1;

    Eigen::VectorXd original_z(const Eigen::VectorXd& scaled_z) const { return unit * factor.cwiseProduct(scaled_z); }
    Eigen::VectorXd scaled_z(const Eigen::VectorXd& z) const { return z.cwiseQuotient(factor) / unit; }
};

ScaledLcp equilibrated(const LcpProblem& problem);

/// max |min(z, M z + q)|; 0 for the empty problem, infinite where z is not finite or of the wrong size.
double natural_residual(const LcpProblem& problem, const Eigen::VectorXd& z);

/// The same of the equilibrated problem: independent of units and of what a solver reports.
double scaled_residual(const LcpProblem& problem, const Eigen::VectorXd& z);

inline constexpr double max_scaled_residual = 1e-10;  // of an answer that counts as a solution

}  // namespace knap
