#pragma once
// Rigid motions R of pieces of the body: x, y, and a rotation about the centre of mass. Places are those of the
// undeformed body, with large rotations those of ImplicitBulk::place.
#include "model/model.hpp"

#include <Eigen/Core>

#include <array>
#include <vector>

namespace knap {

class ImplicitBulk;

struct RigidPieces {
    struct Piece {
        Vec2 centre = Vec2::Zero();  // [m] of mass
        double length = 0;           // [m] at this distance the rotation has the speed of the others
        Vec2 motion(int k, const Vec2& place) const {
            return k < 2 ? Vec2(Vec2::Unit(k)) : Vec2(turned_left(place - centre) / length);
        }
    };
    std::vector<Piece> pieces;
    std::vector<Index> of_corner;               // per corner; -1: of none
    std::vector<Eigen::Matrix3d> inertia;       // [kg] per piece: R' M R
    std::vector<std::array<Vec2, 3>> momentum;  // [kg] per corner: M R. M is that of M_hat: with damping (1 + d) M

    void find(const Model& model, const ImplicitBulk& bulk, std::vector<Index> piece_of_corner, Index n_pieces);
    Vec2 motion(Index corner, int k, const Vec2& place) const { return pieces[of_corner[corner]].motion(k, place); }
    /// (R' M R)^-1 R' M of a rate [m/s] per corner, per piece.
    void project(const std::vector<Vec2>& rate, std::vector<Eigen::Vector3d>& along) const;
};

}  // namespace knap
