#pragma once
// One interface point over one implicit step: its impulses as a function of its rate w = (w_N, w_T), in augmented form,
// and the derivative. The set-valued law (interface_law.hpp) becomes a resolvent,
//
//     p = max(0, p^ - rho (w_N - bound)),
//     q_T = t^ - rho (w_T - omega)   with   -q_T in F sgn(omega) + G sgn(omega + u_T/h),
//
// with multipliers p^, t^ from the iterate before: a fixed point satisfies the law itself, whatever rho > 0 (method of
// multipliers: Hestenes, Powell, Rockafellar; for contact P. Alart, A. Curnier 1991). Redundant points do no harm, and
// the derivative is definite.
//
// Secant unloading: beta_theta is multiplied by clamp(s/kappa, 0, 1) with s at u + theta h w, the mean of the step for
// theta = 1/2, where its work is then the change of the elastic energy. The resolvent is that of contact, friction and
// ramp together, of the rates omega = w + (q - q^)/rho: however steep a ramp is, rho bounds its stiffness, and where
// a slip reverses the force takes every value between those of its two signs. (With the ramp at w it jumped there, and
// equations with such a point had no solution.)
//
// Vertical unloading: the factor is 0 for s < kappa, 1 for s > kappa and anything in [0, 1] at kappa, with s at the end
// of the step, u + h w. The resolvent finds it there as that of a contact: what is held at kappa has the force that its
// rates ask for. (With a step of some width its slope decided how redundant points round a vertex share their forces,
// and multipliers on softer springs followed it in some hundred rounds.)
//
// A law that is no staircase (norm_law.hpp) is a projection already: with the multipliers q^ its impulse is
// project(q^ - rho w), and -dq/dw is rho times its slope.
#include "base/vec.hpp"
#include "law/interface_law.hpp"
#include "law/norm_law.hpp"
#include "material/cohesive_law.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cstdint>

namespace knap {

/// A step of the theta scheme.
struct ThetaStep {
    double h = 0;                // [s]
    double theta = 0.5;          // [-]
    bool implicit_beta = false;  // cohesion follows the openings at the end of the step

    double kick() const { return theta * h; }                          // [s] impulse times theta, of a force
    double stiffness_factor() const { return theta * theta * h * h; }  // [s2] of K in M_hat
};

/// Impulses are those of the law times theta, as they enter the equation of w [N s].
struct PointLaw {
    double u_N, u_T;  // [m] at the start of the step
    double strength;  // [N s] C = theta h S sigma_c; 0: no cohesion left
    double cohesion;  // [-] beta at its start
    const CohesiveLaw* material;
    double ramp = 0;               // [m] kappa of secant and vertical unloading; 0: none
    bool drops = false;            // vertical unloading
    double below = 0;              // [m] then s - kappa at the start of the step; 0: it is there but for rounding
    double friction;               // [-] Coulomb's mu; 0 where the scheme neglects friction, of a table any other
    PressedFriction pressed = {};  // in place of mu p
    ContactBound contact;
    const ThetaStep* step;
    bool keeps_cohesion = false;  // beta stays that of the start, whatever the openings: a first approximation
    Staircase tangential = {};    // with cohesive weights for beta_theta = 1

    /// [N s] Under the contact impulse p, and [-] its slope there.
    double rubbing(double p) const { return pressed ? pressed(p) : friction * p; }
    double rubbing_slope(double p) const { return pressed ? pressed.slope(p) : friction; }
    /// [N s] Between two contact impulses.
    double rubbing_between(double p, double q) const {
        return pressed ? std::abs(pressed(p) - pressed(q)) : friction * std::abs(p - q);
    }
    /// The kinks of the tangential law, when the law over the step is known.
    void set_staircase();
    /// Its beta follows the openings at the end of the step.
    bool may_soften() const { return strength > 0 && step->implicit_beta && !keeps_cohesion; }
    /// No staircase: its impulse is a projection.
    bool is_curved() const { return material->coupling != Coupling::sum && strength > 0; }
    /// The multiplier p^ has the cohesion that is not borne, too.
    bool holds_cohesion() const { return ramp > 0 || is_curved(); }
    /// [s] From the start of the step to where the cohesion looks at the opening.
    double reach() const { return reach_part() * step->h; }
    double reach_part() const { return ramp > 0 && !drops ? step->theta : 1; }
    /// [m] The energy that the traction of full cohesion gives back, over it.
    double stored(double s) const { return drops ? std::max(s - ramp, 0.0) : CohesiveLaw::stored_opening(ramp, s); }
    /// With a ramp: its sides may overlap where it looks at them.
    bool may_overlap() const { return u_N + reach() * contact.rate < -1e-12 * material->delta_c(); }
    /// [kg] What is held at kappa is as stiff as a contact: the multipliers find its force.
    double ramp_stiffness() const { return ramp > 0 && !drops ? strength * cohesion * step->kick() / ramp : 0; }
};

/// The iterate of the method of multipliers.
struct Multipliers {
    double contact = 0;            // [N s] p^ >= 0; where holds_cohesion that of PointResponse::held
    double tangential = 0;         // [N s] t^
    double rho_N = 0, rho_T = 0;   // [kg]; infinite rho_T: the rate itself decides (prescribed on both sides)
    bool friction_follows = true;  // friction is bounded by mu p, else by mu `pressed` (Tresca, a step towards Coulomb)
    double pressed = 0;            // [N s]
};

struct PointResponse {
    double contact = 0;                           // [N s] p >= 0
    double tangential = 0;                        // [N s] q_T
    double friction_part = 0;                     // [N s] friction of q_T
    double cohesion_theta = 0, end_cohesion = 0;  // [-] beta_theta, beta+
    // with a ramp: full_cohesion times ramp_part is cohesion_theta
    double full_cohesion = 0, ramp_part = 1;  // [-]
    bool on_ramp = false;                     // ramp_part grows with s; vertical unloading: it is held at kappa
    bool opens_on_ramp = false;               // u_N > 0 where the ramp looks at it
    double end_sign = 0;                      // of the slip at the end of the step
    double pull = 1;          // [-] part of the cohesion that acts along N: none where the ramp overlaps
    bool lands = false;       // the ramp rests where the overlap begins, and pull is what it takes
    int piece = 0;            // of the softening branch, where it softens
    std::uint32_t state = 0;  // identifies the smooth piece of the law
    bool closed = false, sticks = false, softens = false, breaks = false, opens = false;
    double friction_sign = 0, cohesion_sign = 0;  // of the two tangential forces, negative; 0 where they are free
    double kink = 0;                              // [m/s] where it sticks
    Vec2 opening_rate = Vec2::Zero();             // [m/s] of a curved law: W of norm_law.hpp
    double curvature = 0;                         // [-] likewise: C rho/(|W| weight)

    Vec2 damage = Vec2(1, 0);  // [-] d s_d/d(u_N, |u_T|) at the end of the step, where it softens

    bool loses_cohesion() const { return softens || breaks; }
    double normal(const PointLaw& law) const { return contact - law.strength * cohesion_theta * pull; }  // [N s] q_N
    /// [N s] What the multiplier p^ becomes: p, with a ramp or a curved law and the cohesion that is not borne.
    double held(const PointLaw& law) const {
        return law.holds_cohesion() ? normal(law) + law.strength * law.cohesion : contact;
    }
};

PointResponse respond(const PointLaw& law, const Multipliers& at, double w_N, double w_T);

enum class Softening {
    none,
    now,    // of points on the descending branch
    at_all  // of points that lost all their cohesion in the step, too: the branch that they came down. Without the
            // friction that the contact carries, which does not affect definiteness
};

/// Slope of the cohesive impulse on the descending branch [kg] and its direction; a fixed component takes no part. The
/// slope is that of the piece at the end of the step, or, where all cohesion was lost or `at_all`, the steepest one of
/// the cohesions that the step may pass. Delayed softening takes the relaxed part of it.
double softening_modulus(const PointLaw& law, const PointResponse& response, Softening softening);
Vec2 loss_direction(const PointLaw& law, const PointResponse& response);

/// -dq/dw in (N, T) of the piece of `response`; with softening it may be indefinite.
Eigen::Matrix2d tangent(const PointLaw& law, const Multipliers& at, const PointResponse& response, Softening softening);

}  // namespace knap
