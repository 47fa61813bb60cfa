#pragma once
// Damping of the pieces that nothing holds. It stands for the loss of vibrations, so it acts on the mean velocity minus
// the rigid motion W of the piece: a flight, a fall, a roll and a slide are braked by impacts and friction alone, which
// have laws of their own.
//
//     M (v+ - v) = k (F - K u - alpha M ((v + v+)/2 - W)) + H' P,     W(x) = V + omega x (x - x_c)
//     M_piece V = p + (p - p_before)/2,     I omega = L + (L - L_before)/2
//
// p and L are momentum and angular momentum (about the centre of mass x_c) of the piece at the start of the step,
// p_before and L_before those one step earlier: W is the rigid motion in the middle of the step where the forces on the
// piece stay as they are. With d = k alpha/2, and J the impulse that loads and contacts give to the piece in step n,
//
//     p_n+1 - p_n = J_n - d ((p_n+1 - p_n) - (p_n - p_n-1))
//     summed up: p - p_start = sum of J - d (last change of p)
//
// so nothing is lost, and p follows J by the time d h (1e-6 of a step is usual); likewise L. A piece at rest bears its
// weight and no more. With small rotations x is the place in the undeformed body, as in the elastic forces.
#include "stepper/common/pieces_of_body.hpp"
#include "stepper/common/step_scheme.hpp"

namespace knap {

class FreePieces {
public:
    /// `dashpots` must outlive this.
    FreePieces(const Model& model, const SchemeOptions& scheme, std::span<const Dashpot> dashpots)
        : model_(model),
          leaves_motion_(scheme.damping > 0 && scheme.damping_of == DampingOf::vibration),
          dashpots_(dashpots) {}

    /// For a step from `begin` with `damping` d [-]: (1 - decay) W [m/s] per node, zero where a piece is held. Null
    /// where all are, and where damping is none or one of the motion as a whole. Writes the motions of the pieces at
    /// this moment to `now`. The same bits for every number of threads.
    const Vec2* carried(const State& begin, double damping, std::vector<PieceMotion>& now);

private:
    /// The corners of a fan that belong to one piece.
    struct Member {
        Vec2 place;    // [m] in the undeformed body
        double mass;   // [kg] of all
        Index corner;  // one of them
        Index fan;     // its corners are all of this fan; -1: that corner alone
    };
    struct Piece {
        Index first_triangle;
        double mass;         // [kg]
        std::size_t member;  // the first one of `members_`
    };
    struct Block {  // of members of one piece
        Index piece;
        std::size_t first, last;
    };
    struct Motion {
        Vec2 origin, centre, velocity;  // [m] a place, and x_c from there; [m/s] V
        double spin;                    // [rad/s] omega
    };
    /// Of a piece: sums of m, m y, m v, m y x v, m y . y with y = x - origin.
    struct Sums {
        double mass = 0, angular = 0, inertia = 0;
        Vec2 first = Vec2::Zero(), momentum = Vec2::Zero();
        Sums& operator+=(const Sums& other);
    };
    void find(const State& begin);
    template <class Visit>
    void for_nodes(const State& begin, const Member& member, const Visit& visit) const;
    Vec2 arm(const State& begin, const Member& member, Index node, const Vec2& origin) const;

    const Model& model_;
    bool leaves_motion_;  // of free pieces alone
    std::span<const Dashpot> dashpots_;
    std::ptrdiff_t n_broken_ = -1;  // points without cohesion for which the pieces were found
    std::vector<Piece> pieces_;     // that are free
    std::vector<Member> members_;   // piece by piece
    std::vector<Block> blocks_;
    std::vector<Sums> of_block_;
    std::vector<Motion> motions_;
    std::vector<Vec2> carried_;
    std::size_t n_split_ = 0;  // fans, for which nodes have these numbers
};

}  // namespace knap
