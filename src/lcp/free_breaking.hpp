#pragma once
// Free bond breaking, an unphysical solution of problems with tangential cohesion: chi stands for |u_T| but is only bound from below, so
// where the bond vanishes a large chi pays for its breaking, with a residual of exactly zero. Only for problems whose unknowns are
//   [ S A (m) | S beta (m) | p_N (c) | p_T+, p_T- by point (2c) | theta zeta (c) | r_T+, r_T- by point (2m) | chi (m) ].
#include "lcp/problem.hpp"

#include <optional>

namespace knap {

struct CohesiveLayout {
    int n_cohesive = 0, n_contacts = 0;  // m and c: n = 5 m + 4 c

    int first_beta() const { return n_cohesive; }
    int first_tangential() const { return 2 * n_cohesive + 4 * n_contacts; }  // r_T+ of the first point, then its r_T-
    int first_chi() const { return 4 * n_cohesive + 4 * n_contacts; }
};

/// The layout, where the pattern of zeros of M is that of such a problem with at least one cohesive point.
std::optional<CohesiveLayout> cohesive_layout(const LcpProblem& problem);

struct FreeBreaking {
    int n_loose = 0;             // points with chi > |u_T|
    int n_free = 0;              // of these, points whose bond would not have vanished with chi = |u_T|
    Eigen::VectorXd tightened;   // z with chi = |u_T| everywhere; a solution as good as z where n_free is 0
    double largest_excess = 0;   // of chi over |u_T|, in the equilibrated problem
};

/// A loose point is harmless where chi can be lowered to |u_T| and all conditions still hold: then its bond broke by itself. So is one
/// whose bond was gone before.
FreeBreaking free_breaking(const LcpProblem& problem, const Eigen::VectorXd& z, const CohesiveLayout& layout, double tolerance = 1e-8);

}  // namespace knap
