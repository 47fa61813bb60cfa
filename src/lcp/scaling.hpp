#pragma once
// Symmetric equilibration: D M D has entries of order one, q / unit too. With z = unit D z', w = unit D^-1 w' the scaled problem is the
// same complementarity problem, z' . w' is z . w up to one factor, and a semidefinite M stays so. (Ruiz, A scaling algorithm to equilibrate
// both rows and columns norms in matrices, RAL-TR-2001-034.)
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
