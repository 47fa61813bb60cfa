#pragma once
// The body becomes rigid pieces, and deformable again.
//
//     freeze    P = sum m v, c = sum m x/M, L = sum m (x - c) x v;  V = P/M, w = L/J, J = sum m |x - c|^2
//               booked: the kinetic energy of the vibration, 1/2 sum m |v - V - w x (x - c)|^2
//               the strain energy U stays in the shape of the piece: x - c = R(angle) arm
//     thaw      x and v of all nodes are those of the piece, and its strain works again
//
// Momentum, angular momentum and energy are exact to rounding. The surface does not move at either change.
#include "model/state.hpp"
#include "stepper/common/step_report.hpp"
#include "stepper/common/step_scheme.hpp"

#include <numeric>

namespace knap {

/// The mean motions of pieces: M, c, V, J and w as above.
struct MeanMotions {
    std::vector<double> mass, inertia, spin;
    std::vector<Vec2> centre, velocity;
};
/// `near` [m] per piece: a place whose distance to its corners has little rounding. `for_corners(visit)` calls
/// visit(piece, m, x, v) for the corners of pieces; others stay as they are.
template <class ForCorners>
MeanMotions mean_motions(const std::vector<Vec2>& near, const ForCorners& for_corners) {
    const std::size_t n = near.size();
    MeanMotions mean{.mass = std::vector<double>(n, 0),
                     .inertia = std::vector<double>(n, 0),
                     .spin = std::vector<double>(n, 0),
                     .centre = near,
                     .velocity = std::vector<Vec2>(n, Vec2::Zero())};
    std::vector<Vec2> first_moment(n, Vec2::Zero());
    for_corners([&](Index p, double m, const Vec2& x, const Vec2& v) {
        mean.mass[p] += m, first_moment[p] += m * (x - near[p]), mean.velocity[p] += m * v;
    });
    for (std::size_t p = 0; p < n; ++p)
        if (mean.mass[p] > 0) mean.centre[p] += first_moment[p] / mean.mass[p], mean.velocity[p] /= mean.mass[p];
    for_corners([&](Index p, double m, const Vec2& x, const Vec2& v) {
        const Vec2 arm = x - mean.centre[p];
        mean.inertia[p] += m * arm.squaredNorm(), mean.spin[p] += m * cross(arm, Vec2(v - mean.velocity[p]));
    });
    for (std::size_t p = 0; p < n; ++p)
        if (mean.inertia[p] > 0) mean.spin[p] /= mean.inertia[p];
    return mean;
}

/// The rigid motion of the pieces of a deformable state between two steps of the leapfrog. Pieces are those of
/// stepper/common/pieces_of_body.hpp. `report` gets what becomes of its energies.
struct FrozenPieces {
    SharedFrozenBody body;
    std::vector<RigidPiece> pieces;
    std::vector<double> vibration;  // [J] per piece, that would be booked
    double kinetic = 0;             // [J] that stays
    double strain = 0;              // [J] of all

    double all_vibration() const { return std::accumulate(vibration.begin(), vibration.end(), 0.0); }
};
/// Fans with a point that never had cohesion split, so that what it parts are two pieces.
FrozenPieces freeze(const Model& model, State& state);

/// A point of the piece may break, if blows are hard enough.
inline bool can_break(const FrozenBody::Piece& piece, const RigidOptions& options) {
    return piece.weakest < infinity && piece.size() >= options.smallest;
}

/// Writes places and velocities of the nodes of a state from the motion of its pieces that are not deformable.
void place_nodes(const Model& model, State& state);

}  // namespace knap
