#pragma once
// The state of a link: closed or open, and where on the staircase of its tangential law (interface_law.hpp) it is, between two kinks or
// at one. States are guessed from the motion before the step; what violates its law names the state that would mend it.
#include "interface/fan_problem.hpp"
#include "interface/fan_scales.hpp"
#include "interface/interface_law.hpp"

namespace knap {

/// Friction has two signs, those of the end velocity and of the mean velocity: together they never do positive work and let a sliding
/// point come to exact rest (fan_problem.hpp). The tangential cohesion has the sign of the slip at the end of the step.
/// `tolerance` [m/s]: kinks that are nearer to each other are one.
InterfaceLaw law_of(const FanLink& link, const Vec2& velocity_before, double h, double tolerance);

struct LinkState {
    InterfaceLaw law;  // not of an unbreakable link: that one is closed and sticks for ever
    StaircasePiece tangential;
    int tangential_state = 0;
    bool closed = false;
    bool imposed = false;  // both sides fully prescribed: nothing to decide
    bool led = false;      // both sides prescribed in one component: its normal velocity says how fast it slides

    bool holds() const { return closed && tangential.stick; }
    bool sticks() const { return holds() && !imposed; }
    bool partial() const { return closed != tangential.stick && !imposed; }  // one component of its impulse is to be found

    void set(bool to_closed, int to_tangential_state);
    int state_of(bool if_closed, double rate_T, double tolerance) const { return law.staircase(if_closed).state_of(rate_T, tolerance); }
    /// The motion goes on as before the step.
    void guess(const FanProblem& problem, const FanLink& link, const FanScales& scales);
    /// The state that comes nearest to this relative velocity [m/s] and impulse [N s]: between kinks that rounding cannot tell apart only the force decides.
    void fit(const FanLink& link, const Vec2& velocity, const Vec2& impulse, const FanScales& scales);

    Vec2 target(const FanLink& link) const;           // [m/s] relative velocity of a link that sticks
    Vec2 known_impulse(const FanLink& link) const;    // [N s] of a link that does not stick, without its multiplier
    double friction_part(const FanLink& link) const;  // [N s] of the results in the link
};

struct StateChange {
    double violation = 0;  // of the law, relative; 0: no change
    double unmended = 0;   // relative: must hold, and no state mends it
    bool closed = false;
    int tangential_state = 0;
};

/// What the law asks for at this relative velocity [m/s] and impulse [N s]; not for unbreakable links.
StateChange change_of(const LinkState& state, const FanLink& link, const Vec2& velocity, const Vec2& impulse, const FanScales& scales);

}  // namespace knap
