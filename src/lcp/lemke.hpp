#pragma once
// Lemke's pivots on a condensed tableau of n (n + 2) numbers (C. E. Lemke 1965; Cottle, Pang, Stone, The Linear Complementarity Problem,
// 4.4 and 4.9). Ties are broken lexicographically, so that it cannot cycle. Two tolerances make it reliable on degenerate and redundant
// problems: a pivot must not be small beside its column, and ratios closer than rounding are a tie. Where the path ends on a ray,
// paths from other covering vectors are tried. The reference solver: dense; a path of k pivots costs k^2 n / 2
// operations (pivots are carried out on a column when it enters), k is about n / 2 here.
#include "lcp/problem.hpp"

namespace knap {

struct LemkeOptions {
    double pivot_tolerance = 1e-11;  // of the largest entry of the entering column
    double tie_tolerance = 1e-12;    // of ratios, in the equilibrated problem
    double largest_residual = 1e-10;  // of a solution, in the equilibrated problem: pivots that lost more are a path that leads nowhere
    int max_pivots_per_unknown = 50;
    int n_covering_vectors = 30;
};

LcpSolution solve_by_lemke(const LcpProblem& problem, const LemkeOptions& options = {});

/// For small problems: z alone, without equilibration, so M and q should be of order one; the caller judges it. False when every path ends on a ray: then
/// there is hardly a solution. A hundred unknowns need no memory but the stack.
bool solve_lcp_by_lemke(const Eigen::Ref<const Eigen::MatrixXd>& M, const Eigen::Ref<const Eigen::VectorXd>& q, Eigen::Ref<Eigen::VectorXd> z);
/// Empty instead of false.
Eigen::VectorXd solve_lcp_by_lemke(const Eigen::MatrixXd& M, const Eigen::VectorXd& q);

}  // namespace knap
