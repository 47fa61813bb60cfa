#pragma once
// The state of a link: closed or open, and its place on the staircase of its tangential law (interface_law.hpp),
// between two kinks or at one. States are guessed from the motion before the step; a violated law names the next state.
#include "base/tolerance.hpp"
#include "law/interface_law.hpp"
#include "law/norm_law.hpp"
#include "nonsmooth/fan_problem.hpp"

namespace knap {

/// Units of the impulses and velocities of one fan, and its tolerances.
struct FanScales {
    double impulse = 1;            // [N s] the largest that can occur
    double speed = 1;              // [m/s]
    double impulse_tolerance = 0;  // [N s]
    double speed_tolerance = 0;    // [m/s]
    double rest = 0;               // [m/s] kinks of a staircase that are nearer to each other are merged
    double separation = 0;         // [m/s] a smaller one before the step counts as none
};

/// Slips, and in a fan that turns separations, below `rest` times the largest speed come to rest.
FanScales scales_of(const FanProblem& problem, double rest);

/// The law of a link over the step. The tangential cohesion has the sign of the slip at its end. `tolerance` [m/s]:
/// kinks that are nearer to each other are merged.
InterfaceLaw link_law(const FanLink& link, const Vec2& velocity_before, double h, double tolerance);
/// Likewise, of a curved link. A law that is no staircase either has its name in Coupling and its row here.
NormLaw norm_law(const FanLink& link, const Vec2& velocity_before, double h, double tolerance);

/// How much of its cohesion a link on a ramp bears: all, a part in proportion to its opening, nothing.
enum class Bearing { full, part, none };

struct LinkState {
    InterfaceLaw law;  // not of an unbreakable link, which is closed and sticks permanently
    StaircasePiece tangential;
    int tangential_state = 0;
    Bearing bearing = Bearing::full;
    double part = 1;  // [-] of the cohesion that is borne; of the last solution
    int line = 0;     // of a friction over pressure
    bool closed = false;
    bool imposed = false;  // both sides fully prescribed: nothing to decide
    bool slip_follows_normal =
        false;  // both sides prescribed in one component: the normal velocity determines the slip

    bool holds() const { return closed && tangential.stick; }
    bool sticks() const { return holds() && !imposed; }
    /// One component of its impulse is unknown.
    bool partial() const { return closed != tangential.stick && !imposed; }

    void set(bool to_closed, int to_tangential_state);
    /// Before `set`.
    void set_line(const FanLink& link, int to_line);
    /// [N s]
    double cohesive_impulse(const FanLink& link) const { return part * link.cohesive; }
    /// The tangential law with the cohesion that is borne.
    TangentialRange range() const {
        return {part * tangential.offset, tangential.contact_offset, part * tangential.jump,
                tangential.contact_jump,  tangential.line_offset,    tangential.line_jump};
    }
    /// An impulse along the ramp is unknown; of a link that sticks it follows from the velocity.
    bool is_on_ramp(const FanLink& link) const {
        return link.ramp > 0 && link.cohesive > 0 && bearing == Bearing::part && !sticks();
    }
    /// Finds `part` from what a link on its ramp bears [N s], and of a link that sticks part and bearing from its
    /// relative velocity [m/s].
    void find_part(const FanLink& link, const Vec2& velocity, double on_ramp);
    int state_of(bool if_closed, double rate_T, double tolerance) const {
        return law.staircase(if_closed).state_of(rate_T, tolerance);
    }
    /// The state if the motion continues as before the step.
    void guess(const FanProblem& problem, const FanLink& link, const FanScales& scales);
    /// The state that is nearest to this relative velocity [m/s] and impulse [N s]: between kinks that rounding cannot
    /// tell apart only the force decides.
    void fit(const FanLink& link, const Vec2& velocity, const Vec2& impulse, const FanScales& scales,
             double on_ramp = 0);

    Vec2 target(const FanLink& link) const;         // [m/s] relative velocity of a link that sticks
    Vec2 known_impulse(const FanLink& link) const;  // [N s] of a link that does not stick, without its multiplier
    /// [N s] Of P_T, with a contact impulse p.
    double friction_part(double p, double P_T) const;
};

struct StateChange {
    double violation = 0;    // of the law, relative; 0: no change
    double irreparable = 0;  // violation that no state removes, relative
    bool closed = false;
    int tangential_state = 0;
    Bearing bearing = Bearing::full;
    int line = 0;
};

void follow(const StateChange& change, const FanLink& link, LinkState& state);

/// The state that the law requires at this relative velocity [m/s] and impulse [N s]; not for unbreakable links.
StateChange change_of(const LinkState& state, const FanLink& link, const Vec2& velocity, const Vec2& impulse,
                      const FanScales& scales);

}  // namespace knap
