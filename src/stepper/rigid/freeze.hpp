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
/// [m/s] The slowest blow that may break the piece (rigid_scheme.hpp); infinite where none can.
double least_blow(const FrozenBody::Piece& piece, const RigidOptions& options);
/// [-] The mean speed of what moves in a piece beside its rigid motion, of energy `vibration` [J], over the slowest
/// blow that may break it, or over what is small beside the rigid motion, if that is more. It is a wave after a blow,
/// or parts that turn about the last whole point between them, as long as the piece flies: above 1 it is no rigid one.
double unrest(const FrozenBody::Piece& piece, const RigidPiece& motion, double vibration, const RigidOptions& options);

/// Writes places and velocities of the nodes of a state from the motion of its pieces that are not deformable.
void place_nodes(const Model& model, State& state);

}  // namespace knap
