#pragma once
// Symmetric equilibration, and the residual that judges every answer. D M D and q / unit have entries of order one.
// With z = unit D z' and w = unit D^-1 w' the scaled problem is the same complementarity problem, and a semidefinite M
// stays semidefinite. The factors are powers of two, which cause no rounding. Where z_i w_i has the same unit in all
// rows (an energy in the problems of knap), other units give the same scaled problem, bit by bit.
//     rows with a diagonal entry     |D M D| = 1 there
//     rows without one (bounds)      the largest coupling is 1 (Ruiz, RAL-TR-2001-034)
//     bounds among themselves        the same, and their largest |D q| is that of the other rows before it is balanced
// The diagonal is scaled first because the sizes of the entries alone leave a common factor (x, 1/x) to an impulse and
// its bound (r_T and chi, p_T and zeta), which in a short step can hide the rate of a point. Where a diagonal entry is
// small compared with its row (M not monotone), the largest entry of the row scales it.
#include "lcp/problem.hpp"

namespace knap {

struct LcpScaling {
    Eigen::VectorXd factor;  // diagonal of D
    double unit = 1;

    Eigen::VectorXd original_z(const Eigen::VectorXd& scaled_z) const { return unit * factor.cwiseProduct(scaled_z); }
    Eigen::VectorXd scaled_z(const Eigen::VectorXd& z) const { return z.cwiseQuotient(factor) / unit; }
    Eigen::VectorXd scaled_w(const Eigen::VectorXd& w) const { return w.cwiseProduct(factor) / unit; }
};

LcpScaling scaling_of(const LcpProblem& problem);

/// Scales the problem in place.
LcpScaling equilibrate(LcpProblem& problem);

/// max |min(z, M z + q)|; 0 for the empty problem, infinite where z is not finite or of the wrong size.
double natural_residual(const LcpProblem& problem, const Eigen::VectorXd& z);

/// The natural residual of the equilibrated problem, which depends neither on units nor on what a solver reports.
/// As the factors are powers of two, it is found without the scaled problem.
double scaled_residual(const LcpProblem& problem, const Eigen::VectorXd& z);

/// The same with the scaling of the problem and w = M z + q, for callers that judge several answers.
double scaled_residual(const LcpScaling& scaling, const Eigen::VectorXd& z, const Eigen::VectorXd& w);

}  // namespace knap
