#pragma once
// Methods on the box form of an LCP, of which the solvers of solvers.hpp are made. Each takes x as the starting point
// and leaves the last iterate in it, for every status; `count` is increased by the sweeps or linear solves.
#include "lcp/presolve.hpp"

namespace knap {

/// n projected Gauss-Seidel sweeps, for a positive diagonal: one unknown after the other moves to the zero of its row
/// within its bounds. Returns the largest |change of x| of the last sweep, in units of the diagonal. In
/// gauss_seidel.cpp.
double sweep(const BoxLcp& box, Eigen::VectorXd& x, int n_sweeps);

/// Until the largest entry of the natural map is `tolerance` or less. In newton.cpp.
LcpStatus solve_box_by_newton(const BoxLcp& box, double tolerance, int max_iterations, Eigen::VectorXd& x, int& count);

/// For capped unknowns whose rows have a negative curvature; starts from intact bonds, x = upper, whatever x is.
LcpStatus solve_box_by_proximal_points(const BoxLcp& box, double tolerance, Eigen::VectorXd& x, int& count);

}  // namespace knap
