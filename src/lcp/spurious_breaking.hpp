#pragma once
// Spurious bond breaking, an unphysical solution of problems with tangential cohesion: chi stands for |u_T| but is
// bounded from below only, so where a bond vanishes a large chi can pay for its breaking, with a residual of exactly
// zero. Only for problems with the unknowns (m cohesive points, c contacts)
//   [ S A (m) | S beta (m) | p_N (c) | p_T+, p_T- by point (2c) | theta zeta (c) | r_T+, r_T- by point (2m) | chi (m) ]
#include "lcp/scaling.hpp"

#include <optional>

namespace knap {

struct CohesiveLayout {
    int n_cohesive = 0, n_contacts = 0;  // m and c: n = 5 m + 4 c

    int beta(int i) const { return n_cohesive + i; }
    int first_tangential() const { return 2 * n_cohesive + 4 * n_contacts; }
    int tangential(int i) const { return first_tangential() + 2 * i; }  // r_T+ of a point; its r_T- is the next one
    int chi(int i) const { return 4 * n_cohesive + 4 * n_contacts + i; }
};

/// The layout, where the pattern of zeros of M is that of such a problem with at least one cohesive point.
std::optional<CohesiveLayout> cohesive_layout(const LcpProblem& problem);

struct SpuriousBreaking {
    int n_excess = 0;           // points with chi > |u_T|
    int n_spurious = 0;         // of these, points whose bond would not have vanished with chi = |u_T|
    Eigen::VectorXd tightened;  // z with chi = |u_T| everywhere; a solution as good as z where n_spurious is 0
};

/// An excess is harmless where chi can be lowered to |u_T| and all conditions still hold: the bond broke under its
/// load, or it was broken before. `tolerance`: of the equilibrated problem.
SpuriousBreaking spurious_breaking(const LcpProblem& problem, const Eigen::VectorXd& z, const CohesiveLayout& layout,
                                   double tolerance = 1e-8);

/// The same with the scaling of the problem.
SpuriousBreaking spurious_breaking(const LcpProblem& problem, const LcpScaling& scaling, const Eigen::VectorXd& z,
                                   const CohesiveLayout& layout, double tolerance = 1e-8);

}  // namespace knap
