#pragma once
// Any convex law between the rate V and the impulse P of a row, as a projection in the plane (N, T):
//
//     P = project(P - r V)      for one r > 0 [kg], and then for all
//
// An associated law, -V in the normal cone of a convex set K at P, is the projection on K; a friction below f(p) is
// p = max(0, Q_N), P_T = clamp(Q_T, -f(p), f(p)) with Q = P - r V. A rate other than 0 to which the law pulls, as the
// bound b of a contact, is a shift of Q by r times it; a dashpot V = c P + ... is a slope below 1. The laws of today's
// contacts and points are straight lines, whose states have solvers of their own (interface_law.hpp).
#include "base/vec.hpp"

#include <Eigen/Core>

namespace knap {

class RowLaw {
public:
    struct Projection {
        Vec2 impulse;           // [N s]
        Eigen::Matrix2d slope;  // [-] its derivative: of one side where it has a kink
    };
    virtual ~RowLaw() = default;
    virtual Projection project(const Vec2& Q, double r) const = 0;

    /// The law near V and P as two equations, exact where it is straight: of_rate V + of_impulse P = right.
    struct Tangent {
        Eigen::Matrix2d of_rate, of_impulse;  // [kg], [-]
        Vec2 right;                           // [N s]
    };
    Tangent tangent(const Vec2& V, const Vec2& P, double r) const;
    /// [N s] P with V = free + W P, of a definite W [1/kg]; the search starts at `guess`.
    Vec2 impulse(const Eigen::Matrix2d& W, const Vec2& free, const Vec2& guess) const;
};

}  // namespace knap
