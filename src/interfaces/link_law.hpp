#pragma once
// The law of one link over one step, as a staircase in its relative velocity (fan_problem.hpp has the formulas).
#include "interfaces/fan_problem.hpp"

#include <algorithm>
#include <array>
#include <span>

namespace knap {

/// -P_T = at + contact * p between two kinks; at a kink P_T = -(at + contact p) + lambda with |lambda| <= play + contact_play p.
struct TangentialLaw {
    bool stick;
    double velocity;                  // [m/s] V_T at the kink
    double low, high;                 // [m/s] bounds of V_T between kinks
    double at = 0, contact = 0;       // [N s], [-]
    double play = 0, contact_play = 0;
};

/// Kinks of the tangential staircase, ascending; kinks within `tolerance` [m/s] of each other are one.
class LinkLaw {
public:
    struct Kink {
        double velocity, cohesive, contact;  // weights [N s], [-] of the sign function that jumps here
    };

    LinkLaw() = default;
    LinkLaw(const FanLink& link, const Vec2& velocity_before, double drift_time, double tolerance);

    bool may_touch() const { return may_touch_; }
    double bound() const { return bound_; }  // [m/s] b
    void forget_rebound() { bound_ = std::min(bound_, 0.0); }
    void forget_friction() { closed_ = open_; }

    /// States of a closed or open link are numbered 0 .. 2 n_kinks: even between kinks, odd at kink state/2.
    int n_states(bool closed) const { return 2 * side(closed).n_kinks + 1; }
    TangentialLaw tangential(bool closed, int state) const;
    /// The state that holds V_T; a kink takes what lies within `tolerance` of it.
    int state_of(bool closed, double v_T, double tolerance) const;

    /// The sign functions of a closed or open link:  -P_T in sum (cohesive + contact p) sgn(V_T - velocity).
    std::span<const Kink> kinks(bool closed) const { return {side(closed).kinks.data(), static_cast<std::size_t>(side(closed).n_kinks)}; }

private:
    struct Side {
        std::array<Kink, 3> kinks;
        int n_kinks = 0;
        void add(const Kink& kink, double tolerance);
    };
    const Side& side(bool closed) const { return closed ? closed_ : open_; }

    Side open_, closed_;
    bool may_touch_ = false;
    double bound_ = 0;
};

}  // namespace knap
