#pragma once
// A fan with links on ramps of secant unloading, of which some may pass kappa within the step. With the opening s- in
// the middle of the last step and s+ = 2 (mean opening) - s- in that of this one, the part r of the cohesion C is the
// quotient of the changes of the energy C w(s)/k and of s, so that the work of the force is this change whatever the
// step, where the slip keeps its sign:
//
//     w = s^2/(2 kappa)  (|s| < kappa),   s - kappa/2  (above)        s- <= kappa
//     s+ <= kappa:  r = (s+ + s-)/(2 kappa), the ramp of fan_problem.hpp at the mean opening
//     s+ >  kappa:  r = 1 - a^2/(2 kappa d),   a = kappa - s-,   d = s+ - s-
//
// r grows with s+, is concave and has no kink at kappa, so Newton's method converges: a link that passes kappa gets
// the tangent of its r as its ramp.
#include "nonsmooth/fan_solver.hpp"

namespace knap {

/// FanSolver::solve, repeated with other ramps until every link bears its r to 1e-12. What is left is part of the
/// residual.
FanSolution solve_on_ramps(SolvedFan& fan, FanSolver& solver, double rest = 0);

}  // namespace knap
