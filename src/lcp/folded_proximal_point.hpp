#pragma once
// Proximal point method on the folded problem, for steps beyond Assumption 1: where softening outweighs inertia and stiffness the rows of
// the capped unknowns (cohesion, which the openings it allows wear away) have a negative curvature, sweeps have no zero to go to and
// Newton's steps lead anywhere. Instead
//     x_next solves the problem with  F + D (x - x_last),   D >= 0 on capped unknowns, large enough to outweigh that curvature
// as in the minimisation of a function that is not convex by convex ones that touch it from above (Rockafellar 1976; Hunter, Lange 2004).
// It starts from intact bonds. Such a step has several solutions; which one is found is not decided here, so a run should cut its step instead.
#include "lcp/fold.hpp"

namespace knap {

struct FoldedProximalPointOptions {
    double tolerance = 1e-11;  // largest entry of the natural map
    int max_rounds = 40;
};

/// Whether there is an unknown that needs it.
bool softens(const FoldedLcp& problem);

/// x is the last iterate where the status is another than `solved`.
LcpStatus solve_folded_by_proximal_points(const FoldedLcp& problem, const FoldedProximalPointOptions& options, Eigen::VectorXd& x, int& count);

}  // namespace knap
