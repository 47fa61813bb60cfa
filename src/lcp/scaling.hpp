#pragma once
// Symmetric equilibration: D M D has entries of order one, q / unit too. With z = unit D z', w = unit D^-1 w' the scaled problem is the
// same complementarity problem, z' . w' is z . w up to one factor, and a semidefinite M stays so.
//     rows with a diagonal       |D M D| = 1 on it: that fixes what z' = 1 means
//     rows without one           bounds and their multipliers: the largest coupling is 1 (Ruiz, RAL-TR-2001-034)
// The diagonal comes first, since the size of the entries alone leaves an impulse and its bound (r_T and chi, p_T and zeta) a common factor
// free, (x, 1/x): in a short step it can hide the rate of the point beside the bound. Where a matrix is not monotone a diagonal can be
// small beside its row; such a row is scaled by its largest entry.
#include "lcp/problem.hpp"

namespace knap {

struct ScaledLcp {
    LcpProblem problem;
    Eigen::VectorXd factor;  // diagonal of D
    double unit = 1;

    Eigen::VectorXd original_z(const Eigen::VectorXd& scaled_z) const { return unit * factor.cwiseProduct(scaled_z); }
    Eigen::VectorXd scaled_z(const Eigen::VectorXd& z) const { return z.cwiseQuotient(factor) / unit; }
    Eigen::VectorXd scaled_w(const Eigen::VectorXd& w) const { return factor.cwiseProduct(w) / unit; }
};

ScaledLcp equilibrated(const LcpProblem& problem);

}  // namespace knap
