#pragma once
// The nonsmooth problem of one fan in one step of the explicit bulk: a chain of bodies (corners) linked by interface
// points, with the cohesion beta frozen over the step (explicit beta).
//
//     v_i+ = v_i_free + m_i^-1 (P_left - P_right)          P = impulse of a point, acting on the body after it and
//     P = P_N N + P_T T,      V = v_after+ - v_before+,    opposite on the body before it
//     P_N = -C + p,           0 <= p  perp  V_N - b >= 0   where the point may touch, else p = 0;  C = k S beta sigma_c
//    -P_T in gamma C sgn(u_T + h V_T) + mu p 1/2 [ sgn(V_T) + sgn(V_T + V_T-) ]
//
// Secant unloading: C r instead of C, with the part r that belongs to the mean of the openings s- and s+ in the middles
// of the last step and of this one, and the sign of the slip at the end of this interval,
//
//     r = clamp((s- + s+)/(2 kappa), 0, 1),    s = u_N + gamma |u_T| at  u - h- V-/2  and  u + h V/2     h-: last step
//     -P_T has the sign of u_T + h V_T/2
//
// It is the derivative of a convex function of V, so the law stays monotone. Its work is exactly the change of
// C s^2/(2 k kappa) where the slip keeps its sign and h- = h, and more than that where the slip crosses zero (crossing
// loss). A step that passes kappa takes the quotient of the changes of energy and opening (fan_ramps.hpp).
//
// Vertical unloading: C r with the r of the openings at the end of the step, so that what has come to rest at kappa
// stays there,
//
//     r = clamp(1 + (s+ - kappa)/(h d), 0, 1),     s+ = u_N + gamma |u_T| at  u + h V
//
// a ramp, too. Its width d [m/s] is so small a speed that r is anything in [0, 1] at kappa; links of a vertex that are
// redundant share their forces by it.
//
// k is the time over which forces act on the velocity, h the time over which the velocity moves the points (equal at
// constant step). The bound b and the two signs of friction make the work of every contact with the mean velocity
// (V+ + V-)/2 non-positive, as the leapfrog energy requires, and still let a sliding point come to exact rest.
#include "base/vec.hpp"
#include "material/cohesive_law.hpp"

#include <cmath>
#include <vector>

namespace knap {

/// A corner. A component with zero inverse_mass is prescribed: its velocity is free_velocity.
struct FanBody {
    Vec2 velocity;       // [m/s] before the step
    Vec2 free_velocity;  // [m/s] after the step if no interface acted
    Vec2 inverse_mass;   // [1/kg] per component

    /// [kg] per component; 0 where the motion is prescribed.
    Vec2 mass() const {
        return {inverse_mass.x() > 0 ? 1 / inverse_mass.x() : 0, inverse_mass.y() > 0 ? 1 / inverse_mass.y() : 0};
    }
};

/// An interface point of the chain.
struct FanLink {
    Index before, after;             // neighbouring bodies, or -1 = support (at rest)
    Vec2 normal;                     // N; T = turned_left(N)
    double u_N, u_T;                 // [m] opening and slip before the step
    double cohesive;                 // [N s] C
    double gamma;                    // [-]
    double friction;                 // [-]
    double restitution;              // [-]
    bool unbreakable;                // sticks for ever
    double given = 0;                // [m/s] the speed with which a surface gives way
    double ramp = 0;                 // [m/s] 4 kappa/h of secant unloading; 0: the cohesion is C at all openings
    Vec2 ramp_start = Vec2::Zero();  // [m/s] (4/h of the mean opening without V_N and the slip at the end, 2 u_T/h)
    double floor = 0;       // [m] kappa of vertical unloading: `ramp` is d, ramp_start (d + (u_N - kappa)/h, u_T/h)
    double ramp_shift = 0;  // [m/s] part of ramp_start: a ramp that is a tangent begins elsewhere than at 0
    double kappa = 0;       // [m] of secant unloading
    Vec2 middle = Vec2::Zero();  // [m] likewise: (u_N, u_T) in the middle of the last step
    Coupling coupling = Coupling::sum;
    Vec2 last_impulse =
        Vec2::Zero();              // [N s] (N, T) in the step before, of a curved link or with friction over pressure
    PressedFriction pressed = {};  // in place of friction p

    Vec2 tangent() const { return turned_left(normal); }
    void set_ramp(double h) { ramp = 4 / h * kappa; }
    void set_floor(double h, double width) {
        ramp = width;
        ramp_start = Vec2(width + (u_N - floor) / h, u_T / h);
    }
    /// [-] r at this relative velocity, where it is between 0 and 1.
    double ramp_part(const Vec2& velocity) const {
        return (ramp_start.x() + normal.dot(velocity) + gamma * std::abs(ramp_start.y() + tangent().dot(velocity))) /
               ramp;
    }
    Vec2 vector(double along_normal, double along_tangent) const {
        return along_normal * normal + along_tangent * tangent();
    }
};

struct FanProblem {
    std::vector<FanBody> bodies;
    std::vector<FanLink>
        links;  // in the order of the chain; of a closed one the first joins the last body to the first
    bool closed = false;
    bool has_ramps = false;  // of some link whose law is a staircase
    bool is_curved = false;  // some link has a law that is no staircase (curved_fan.hpp)
    bool turns = false;      // large rotations: its normals turn from step to step
    double drift_time = 0;   // [s] h

    // per body, the support included
    Vec2 inverse_mass(Index body) const { return body < 0 ? Vec2::Zero() : bodies[body].inverse_mass; }
    Vec2 velocity_before(Index body) const { return body < 0 ? Vec2::Zero() : bodies[body].velocity; }
    Vec2 free_velocity(Index body) const { return body < 0 ? Vec2::Zero() : bodies[body].free_velocity; }
};

struct FanVelocities {
    std::vector<Vec2> velocity;  // [m/s] after the step, per body

    Vec2 velocity_of(Index body) const { return body < 0 ? Vec2::Zero() : velocity[body]; }
    Vec2 across(const FanLink& link) const { return velocity_of(link.after) - velocity_of(link.before); }
};

/// Velocities and impulses while a solver works on them.
struct FanMotion : FanVelocities {
    std::vector<Vec2> impulse;             // [N s] per link
    std::vector<double> cohesive_impulse;  // [N s] per link on its ramp: C r
};

/// The impulse of a link and its parts.
struct LinkResult {
    Vec2 impulse = Vec2::Zero();  // [N s] P
    double cohesive_impulse = 0;  // [N s] cohesion: C, or its part on the ramp
    double contact = 0;           // [N s] p
    double tangential = 0;        // [N s] P_T = cohesive part + friction
    double friction_part = 0;     // [N s] friction of P_T
    bool stuck = false;           // closed, at a kink of its staircase
};

/// The solution of a problem.
struct FanResult : FanVelocities {
    std::vector<LinkResult> links;
};

struct SolvedFan {
    FanProblem problem;
    FanResult result;
};

}  // namespace knap
