#pragma once
// The law of an interface point over one step: a bound of the normal rate and a staircase of the tangential rate.
//
//     contact       0 <= p  perp  rate_N - bound >= 0
//     tangential   -P_T in sum (cohesive_i + friction_i p) sgn(rate_T - kink_i)      at most three kinks
//
// Friction over pressure (material/friction_over_pressure.hpp) has friction_i (mu p + c) in place of friction_i p, with
// the line mu, c of its polygon that is lowest at p: the solvers exchange lines as they do states.
//
// Four solvers use it: the active set of a fan (link_state.hpp), complementarity rows (staircase_lcp.hpp), the
// resolvent of the augmented Lagrangian (point_law.hpp) and clusters of contacts between free faces
// (contact_cluster.hpp). The rate is the end velocity V+ with the explicit bulk, the mean rate w in the theta scheme.
#include "base/vec.hpp"
#include "material/friction_over_pressure.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace knap {

/// Bound of the normal rate; without `may_touch` the sides cannot meet in this step.
struct ContactBound {
    bool may_touch = false;
    double rate = 0;  // [m/s]
};

/// Explicit bulk, V+ >= bound. Touching: Newton's law V+ = -e V- for an approach. Apart: without restitution no
/// penetration at the end of the step; with it the sides must touch first. A separating point may at most be thrown
/// back at its own speed, so that the work of the mean velocity stays <= 0. `touching` [m]: rounding of a closed gap.
/// `given` [m/s]: the speed with which a surface gives way.
ContactBound contact_bound_explicit(double u_N, double V_N, double restitution, double h, double touching,
                                    double given = 0);

/// Theta scheme, w >= bound. Touching: Newton's law V+ = -e V- for an approach, else w >= 0. Apart: as above, or the
/// point stops when the gap is closed.
ContactBound contact_bound_theta(double u_N, double V_N, double restitution, double h, double theta, double touching);

/// Whether sides that approach with a speed [m/s] come to rest within the step, since their lasting pressure causes the
/// approach `push` [m/s] in a step. A ball rests after infinitely many rebounds, in 2 e |V_N|/((1 - e) push) steps.
inline bool rests_under(double restitution, double approach, double push) {
    return 2 * restitution * std::max(approach, 0.0) < (1 - restitution) * push;
}

/// Admissible tangential impulses with a contact impulse p:
///     |P_T + offset + line_offset + contact_offset p| <= jump + line_jump + contact_jump p
/// with the constant parts of cohesion and of a line of friction.
struct TangentialRange {
    double offset = 0, contact_offset = 0;  // [N s], [-]
    double jump = 0, contact_jump = 0;      // [N s], [-]
    double line_offset = 0, line_jump = 0;  // [N s]
};

/// Part of a staircase: at a kink, or between two kinks, where the jumps are zero.
struct StaircasePiece : TangentialRange {
    bool stick = true;         // at a kink
    double kink = 0;           // [m/s] the rate there
    double low = 0, high = 0;  // [m/s] bounds of the rate between kinks
};

class Staircase {
public:
    struct Kink {
        double rate, cohesive, friction;  // [m/s]; weights [N s], [-] of the sign function that jumps here
    };

    /// In place of p: mu p + c [N s].
    FrictionLine line = {1, 0};

    /// Kinks are ascending; those within `tolerance` [m/s] of each other are merged.
    void add(const Kink& kink, double tolerance);

    std::span<const Kink> kinks() const { return {kinks_.data(), static_cast<std::size_t>(n_kinks_)}; }
    /// States are numbered 0 .. 2 n_kinks: even between kinks, odd at kink state/2.
    int n_states() const { return 2 * n_kinks_ + 1; }
    /// [N s] P_T with which V_T = free + mobility P_T obeys it under the contact impulse p: it is monotone, so there is
    /// one.
    double impulse(double p, double free, double mobility) const;
    StaircasePiece piece(int state) const;
    /// The state of a rate; a kink takes all rates within `tolerance` of it.
    int state_of(double rate, double tolerance) const;

private:
    std::array<Kink, 3> kinks_;
    int n_kinks_ = 0;
};

// Clusters of contacts read them in every sweep.

inline StaircasePiece Staircase::piece(int state) const {
    const bool stick = state % 2 == 1;
    const int here = state / 2;  // the kink, or the number of kinks below
    StaircasePiece piece;
    piece.stick = stick;
    piece.kink = stick ? kinks_[here].rate : 0;
    piece.low = here > 0 ? kinks_[here - 1].rate : -infinity;
    piece.high = here < n_kinks_ ? kinks_[here].rate : infinity;
    for (int i = 0; i < n_kinks_; ++i) {
        if (stick && i == here) {
            piece.jump = kinks_[i].cohesive;
            piece.contact_jump = kinks_[i].friction * line.slope;
            piece.line_jump = kinks_[i].friction * line.offset;
            continue;
        }
        const double sign = i < here ? 1 : -1;
        piece.offset += sign * kinks_[i].cohesive;
        piece.contact_offset += sign * kinks_[i].friction * line.slope;
        piece.line_offset += sign * kinks_[i].friction * line.offset;
    }
    return piece;
}

inline int Staircase::state_of(double rate, double tolerance) const {
    int state = 0;
    for (int i = 0; i < n_kinks_; ++i) {
        if (std::abs(rate - kinks_[i].rate) <= tolerance) return 2 * i + 1;
        if (rate > kinks_[i].rate) state = 2 * i + 2;
    }
    return state;
}

/// Friction of the explicit bulk under the contact impulse p, after the rate V_T [m/s] before the step: mu p
/// 1/2 [sgn(V_T+ - kept V_T) + sgn(V_T+ + V_T)]. With kept = 0 the signs of the end velocity and of the mean velocity
/// together never do positive work and let a sliding point come to exact rest; of the others 0 < kept <= 1 a part of
/// the slip is left.
void add_friction_explicit(double friction, double V_T, double tolerance, Staircase& staircase, double kept = 0);

/// Friction of the theta scheme: mu p sgn(w_T).
void add_friction_theta(double friction, Staircase& staircase);

/// With the explicit bulk, where closed and open points have different staircases.
struct InterfaceLaw {
    ContactBound contact;
    Staircase open, closed;

    const Staircase& staircase(bool is_closed) const { return is_closed ? closed : open; }
};

}  // namespace knap
