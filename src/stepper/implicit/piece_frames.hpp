#pragma once
// Large rotations in the matrix of an implicit step: the stiffness of a triangle turns with its frame A,
//
//     M_hat = M + theta^2 h^2 A K A',     A = R Q
//
// R is the frame of the piece: of the polar decomposition of the mass-weighted sum of F over its triangles, in the
// middle of the step. Unknowns of its nodes are components along R, so blocks of triangles with Q = 1 are those of the
// undeformed body, and a factor stays however far the piece turns. Q is the turn of a triangle against its piece at the
// start of the step, in multiples of `own_frame`: a body that bends is factorised again where it does.
//
// A node keeps the axes x and y where one of its components is prescribed, or a dashpot acts. Blocks of its triangles
// then change with R, which is that of the start of the step, in multiples of `held_frame`: such a piece is held and
// hardly turns.
//
// Frames are approximations in the matrix alone; forces are those of GreenStep. They follow from the state at the start
// of the step and the motion, whatever was before.
#include "element/green_step.hpp"
#include "model/state.hpp"
#include "stepper/common/dashpots.hpp"

namespace knap {

class PieceFrames {
public:
    /// [rad] A step is too large where a piece turns by more: a turn of a in the theta scheme is short by a^3/12.
    static constexpr double largest_turn = 0.3;

    PieceFrames(const Model& model, std::span<const Dashpot> dashpots);

    /// The pieces at the start of a step, in which nothing changes in `motion`.
    void begin(const State& begin, const GreenStep& green, const GreenStep::Motion& motion);
    /// The frames in the middle of a motion from there.
    void find(const GreenStep& green, const GreenStep::Motion& motion);

    const Rotation& of_triangle(Index triangle) const { return of_triangle_[triangle]; }  // A
    /// The axes of the unknowns of its node: R, or the identity.
    Rotation of_corner(Index corner) const {
        return has_fixed_axes_[corner] ? Rotation{} : of_piece_[piece_of_triangle_[corner / 3]];
    }
    /// A along the axes of the unknowns of its nodes. It follows from the multiples alone, so that a block has the same
    /// bits whenever it is made.
    std::array<Rotation, 3> along_nodes(Index triangle) const;
    /// Along them its stiffness is not that of the undeformed body.
    bool is_turned(Index triangle) const { return multiple_[triangle] != std::array<std::int16_t, 2>{0, 0}; }
    /// Triangles whose blocks along the axes of their nodes changed since this was called, ascending.
    std::vector<Index> take_changed();

    Index n_pieces() const { return static_cast<Index>(of_piece_.size()); }
    Index piece_of(Index triangle) const { return piece_of_triangle_[triangle]; }
    double turn(Index piece) const;  // [rad] in the motion
    double turn_of(Index triangle) const { return turn(piece_of_triangle_[triangle]); }
    /// A triangle of a piece that turns by more than `largest_turn`, or -1.
    Index turns_far() const;

private:
    static constexpr double own_frame = 0.1, held_frame = 0.04;  // [rad]

    void find_pieces(const State& begin);
    void add_up(const GreenStep& green, const GreenStep::Motion& motion, std::vector<Rotation>& of_piece);
    bool is_at_fixed_axes(Index triangle) const {
        return has_fixed_axes_[3 * triangle] || has_fixed_axes_[3 * triangle + 1] || has_fixed_axes_[3 * triangle + 2];
    }
    Rotation own_turn(Index triangle) const { return Rotation::by(own_frame * multiple_[triangle][0]); }  // Q

    const Model& model_;
    std::span<const Dashpot> dashpots_;
    std::vector<std::uint8_t> has_fixed_axes_;  // [0/1] per corner
    std::size_t n_split_ = 0;
    std::ptrdiff_t n_broken_ = -1;                       // of the pieces
    std::vector<Index> piece_of_triangle_;               // into of_piece_
    std::vector<std::uint8_t> is_held_;                  // [0/1] per piece: some of its nodes have fixed axes
    std::vector<Rotation> of_piece_;                     // R
    std::vector<Rotation> at_begin_, in_middle_;         // per piece: of its polar decomposition
    std::vector<Rotation> of_triangle_;                  // A
    std::vector<std::array<std::int16_t, 2>> multiple_;  // per triangle: of Q; of R where its nodes have fixed axes
    std::vector<std::uint8_t> is_changed_;               // [0/1] per triangle
    std::vector<Vec2> direction_, sum_;                  // per triangle, per piece
};

}  // namespace knap
