#pragma once
// Proof that a problem has no solution because its inequalities contradict each other. By Farkas' lemma
//     M z + q >= 0, z >= 0  for no z      if and only if      y >= 0, M'y <= 0, q'y < 0  for some y,
// since such a ray y makes 0 <= y'(M z + q) <= q'y < 0. (Problems whose inequalities hold for some z may have no
// solution either; nothing short of trying all bases proves that.)
#include "lcp/problem.hpp"

namespace knap {

/// Whether y proves it: y >= 0, and in the equilibrated problem the positive entries of M'y are rounding compared with
/// -q'y; a solution would be ten orders of magnitude larger than the scale of the problem.
bool proves_infeasibility(const LcpProblem& problem, const Eigen::VectorXd& y);

/// A ray that proves it; empty where none was found.
Eigen::VectorXd find_infeasible_ray(const LcpProblem& problem);

}  // namespace knap
