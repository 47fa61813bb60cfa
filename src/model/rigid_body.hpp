#pragma once
// Pieces of the meshed body that move as rigid bodies ([rigid], stepper/rigid).
#include "base/vec.hpp"

#include <cstdint>
#include <memory>
#include <vector>

namespace knap {

/// How the body moves in the next step: always by the forces of its triangles; so for a while, with [rigid]; or as
/// rigid pieces.
enum class Motion : std::uint8_t { deformable, thawed, rigid };

/// Deformable: it steps by itself, in an island (stepper/islands). Asleep: it lies still and takes no part in a step
/// until it is hit.
enum class PieceState : std::uint8_t { deformable, rigid, asleep };
constexpr const char* name_of(PieceState state) {
    return state == PieceState::deformable ? "deformable" : state == PieceState::rigid ? "rigid" : "asleep";
}

/// The motion of a piece: x = centre + R(angle) arm, v = velocity + spin x (x - centre). The velocities are those of
/// the leapfrog, in the middle of its last step; of a deformable piece the means at this moment.
struct RigidPiece {
    PieceState state = PieceState::rigid;
    Vec2 centre = Vec2::Zero();    // [m] of mass
    double angle = 0;              // [rad] since it became rigid
    Vec2 velocity = Vec2::Zero();  // [m/s]
    double spin = 0;               // [rad/s]
    double slow_since = 0;         // [s] from when on it has been slower than the speed of sleep
    double last_step = 0;          // [s] 0: the velocities are those of this moment
    double struck = 0;             // [s] of a deformable piece: the last blow, or loss of cohesion
    Vec3 slow_at = Vec3::Zero();   // [m, m, rad] its place at slow_since

    Vec3 rates() const { return {velocity.x(), velocity.y(), spin}; }
    Vec3 place() const { return {centre.x(), centre.y(), angle}; }
    void begin_slow(double time) { slow_since = time, slow_at = place(); }
    template <class Archive>
    void serialize(Archive& archive) {
        archive(state, centre, angle, velocity, spin, slow_since, last_step, struck, slow_at);
    }
};

/// What stays as it is while the pieces are rigid.
struct FrozenBody {
    struct Piece {
        Index first_triangle;  // its lowest one
        Index n_triangles = 0;
        double area = 0;      // [m2]
        double mass = 0;      // [kg]
        double inertia = 0;   // [kg m2] about the centre of mass
        double radius = 0;    // [m] of its corners about the centre of mass
        double weakest = 0;   // [m/s] smallest sigma_c/(rho c) of its points that may break; infinite: there is none
        double strength = 0;  // [Pa] sigma_c there
        double strain = 0;    // [J] elastic energy in its shape
        bool held = false;    // by a support or a prescribed motion: it stands still

        double size() const;  // [m] diameter of the circle of the same area
        double edge() const;  // [m] of the equilateral triangle of the mean area
        template <class Archive>
        void serialize(Archive& archive) {
            archive(first_triangle, n_triangles, area, mass, inertia, radius, weakest, strength, strain, held);
        }
    };
    std::vector<Piece> pieces;             // in the order of their lowest triangles
    std::vector<Index> piece_of_triangle;  // into `pieces`
    std::vector<Index> piece_of_node;
    std::vector<Vec2> arm;  // [m] per node, from the centre of mass of its piece, when it became rigid
    double dissipated = 0, recoverable = 0, interface_elastic = 0;  // [J] as in StepReport

    template <class Archive>
    void serialize(Archive& archive) {
        archive(pieces, piece_of_triangle, piece_of_node, arm, dissipated, recoverable, interface_elastic);
    }
};
using SharedFrozenBody = std::shared_ptr<const FrozenBody>;

}  // namespace knap
