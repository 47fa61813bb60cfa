#pragma once
// A piece is a largest set of triangles that points with cohesion, unbreakable ones, or a vertex that is not split yet
// connect. It is held where such a point joins it to a support, where a component of its motion is prescribed, and
// where waves leave it through an absorbing boundary (the ground goes on there). Contacts, with supports, obstacles or
// other pieces, hold nothing.
#include "model/state.hpp"
#include "stepper/common/dashpots.hpp"

namespace knap {

/// Which triangles are of one piece.
struct PiecesOfBody {
    std::vector<Index> first;        // per triangle: the lowest one of its piece
    std::vector<std::uint8_t> held;  // [0/1] per triangle: something holds its piece, or it has vanished
};
/// What parted points (Retirement::parted) are: they hold the sides of a wide crack together, which turn about them.
enum class Hinges : std::uint8_t { join, part };
PiecesOfBody pieces_of_body(const Model& model, const State& state, std::span<const Dashpot> dashpots,
                            Hinges hinges = Hinges::join);

}  // namespace knap
