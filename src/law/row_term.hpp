#pragma once
// How a row moves and drives what it acts on, a corner or a rigid body.
#include "base/vec.hpp"

namespace knap {

/// Of a row on something that moves with the velocities v: V += (along_N . v, along_T . v), and the impulse P acts on
/// it with the wrench p along_N + P_T along_T. So along = n, t of a corner, and (n, arm x n), (t, arm x t) of a rigid
/// body.
template <class Velocities>
struct RowTerm {
    Index body;
    Velocities along_N, along_T;

    Vec2 rate(const Velocities& v) const { return {along_N.dot(v), along_T.dot(v)}; }
    Velocities wrench(const Vec2& P) const { return P.x() * along_N + P.y() * along_T; }
};
using CornerTerm = RowTerm<Vec2>;
using ClusterTerm = RowTerm<Vec3>;  // of a rigid body

}  // namespace knap
