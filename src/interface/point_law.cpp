#include "interface/point_law.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

/// beta+ and beta_theta from the openings at the end of the step.
void update_cohesion(const PointLaw& law, double u_N, double u_T, PointResponse& r) {
    r.end_cohesion =
        law.step->implicit_beta ? law.material->next_cohesion(law.cohesion, u_N, u_T, law.step->h) : law.cohesion;
    r.softens = r.end_cohesion < law.cohesion && r.end_cohesion > 0;
    r.breaks = r.end_cohesion < law.cohesion && r.end_cohesion == 0;
    r.piece = r.softens ? law.material->piece_at(law.material->equivalent_opening(u_N, u_T)) : 0;
    r.cohesion_theta = law.step->theta * r.end_cohesion + (1 - law.step->theta) * law.cohesion;
    r.opens = u_N > 0;
    if (!(law.ramp > 0)) return;
    const double theta = law.step->theta, mean_N = law.u_N + theta * (u_N - law.u_N),
                 mean_T = law.u_T + theta * (u_T - law.u_T);
    const double part = law.material->equivalent_opening(mean_N, mean_T) / law.ramp;
    r.on_ramp = part > 0 && part < 1;
    r.opens_on_ramp = mean_N > 0;
    r.ramp_part = std::min(part, 1.0);
    r.cohesion_theta *= r.ramp_part;
}

/// The resolvent of the staircase  -q_T in sum W_i sgn(w_T - kink_i): its force and its signs (0 at their kink).
void find_tangential(const PointLaw& law, const Multipliers& at, double w_T, PointResponse& r) {
    const double p = at.friction_follows ? r.contact : at.pressed;
    const auto weight = [&](const Staircase::Kink& kink) {
        return kink.friction * p + kink.cohesive * r.cohesion_theta;
    };
    double force = 0;  // -q_T
    for (const Staircase::Kink& kink : law.tangential.kinks()) force -= weight(kink);
    r.friction_sign = r.cohesion_sign = 0;
    r.sticks = false;
    bool passed = true;  // all kinks so far
    for (const Staircase::Kink& kink : law.tangential.kinks()) {
        const double W = weight(kink);
        double sign = -1;
        if (std::isinf(at.rho_T)) {
            sign = w_T > kink.rate ? 1 : w_T < kink.rate ? -1 : 0;
            force += (1 + sign) * W;
        } else if (passed) {
            const double at_kink = at.rho_T * (w_T - kink.rate) - at.tangential;  // -q_T for this rate
            sign = at_kink > force + 2 * W ? 1 : at_kink >= force && W > 0 ? 0 : -1;
            force = sign > 0 ? force + 2 * W : sign == 0 ? at_kink : force;
        }
        passed = sign > 0;
        if (sign == 0 && W > 0) r.sticks = true, r.kink = kink.rate;
        if (kink.friction * p > 0) r.friction_sign = sign;
        if (kink.cohesive * r.cohesion_theta > 0) r.cohesion_sign = sign;
    }
    r.tangential = -force;

    // the part of friction is known with its sign; where both signs are free cohesion bears as much as it can
    const double F = law.friction * p, G = law.material->gamma * law.strength * r.cohesion_theta;
    if (F == 0) r.friction_part = 0;
    else if (r.friction_sign != 0) r.friction_part = -F * r.friction_sign;
    else if (r.cohesion_sign != 0) r.friction_part = r.tangential + G * r.cohesion_sign;
    else r.friction_part = r.tangential - std::clamp(r.tangential, -G, G);
}

std::uint32_t piece(const Multipliers& at, const PointResponse& r) {
    const auto digit = [](double sign) { return static_cast<std::uint32_t>(sign + 1); };
    std::uint32_t state = r.closed | (r.sticks << 1);
    if (r.closed && !r.sticks && at.friction_follows) state |= digit(r.friction_sign) << 2;
    if (r.on_ramp) state |= (r.opens_on_ramp << 13) | (1u << 12) | (digit(r.cohesion_sign) << 6);
    if (r.softens)
        state |= 16u | (r.opens << 5) | (digit(r.cohesion_sign) << 6) | (static_cast<std::uint32_t>(r.piece) << 8);
    return state;
}

}  // namespace

void PointLaw::set_staircase() {
    tangential = {};
    add_friction_theta(friction, tangential);
    const double until = ramp > 0 ? step->theta * step->h : step->h;  // [s] the slip at this time has the sign
    tangential.add({.rate = u_T == 0 ? 0 : -u_T / until, .cohesive = material->gamma * strength, .friction = 0}, 0);
}

PointResponse respond(const PointLaw& law, const Multipliers& at, double w_N, double w_T) {
    PointResponse r;
    r.contact = law.contact.may_touch ? std::max(0.0, at.contact - at.rho_N * (w_N - law.contact.rate)) : 0;
    r.closed = r.contact > 0;
    // a closed or sticking component has the rate of its bound or kink, not the one of the augmentation
    const double u_N = law.u_N + law.step->h * (r.closed ? law.contact.rate : w_N), u_T = law.u_T + law.step->h * w_T;
    update_cohesion(law, u_N, u_T, r);
    find_tangential(law, at, w_T, r);
    if (r.sticks) {
        update_cohesion(law, u_N, law.ramp > 0 ? law.u_T + law.step->h * r.kink : r.kink == 0 ? law.u_T : 0, r);
        const double kink = r.kink;
        find_tangential(law, at, w_T, r);
        if (!r.sticks || r.kink != kink) update_cohesion(law, u_N, u_T, r);
    }
    r.state = piece(at, r);
    return r;
}

double softening_modulus(const PointLaw& law, const PointResponse& r, Softening softening) {
    const bool one_piece = r.softens && softening == Softening::now;
    return law.material->relaxed_part(law.step->h) * law.strength * law.step->theta * law.step->h /
           (one_piece ? law.material->piece_length(r.piece) : law.material->softening_length(law.cohesion));
}

Vec2 loss_direction(const PointLaw& law, const PointResponse& r) {
    return {r.opens && !r.closed ? 1.0 : 0.0, r.sticks ? 0 : law.material->gamma * r.cohesion_sign};
}

Eigen::Matrix2d tangent(const PointLaw& law, const Multipliers& at, const PointResponse& r, Softening softening) {
    const bool with_friction = r.closed && law.friction > 0 && at.friction_follows && softening != Softening::at_all;
    Eigen::Matrix2d D = Eigen::Matrix2d::Zero();
    if (r.closed) D(0, 0) = at.rho_N;
    if (r.sticks) D(1, 1) = std::isinf(at.rho_T) ? 0 : at.rho_T;
    else if (with_friction) D(1, 0) = -law.friction * r.friction_sign * at.rho_N;  // -q_T = mu p sgn, dp = -rho dw_N
    if ((softening != Softening::none && r.softens) || (softening == Softening::at_all && r.breaks)) {
        // q = -C beta_theta (1, gamma sgn), d beta_theta = theta h d beta/ds (opens, gamma sgn) . dw
        const Vec2 loss = loss_direction(law, r);
        const double modulus = r.ramp_part * softening_modulus(law, r, softening);
        D -= modulus * loss * loss.transpose();
        // the contact of a closed point carries the lost tension, and its friction grows with it
        if (with_friction) D(0, 1) -= modulus * loss.y();
    }
    if (r.on_ramp) {  // q = -C beta r (1, gamma sgn), dr = theta h/kappa (opens, gamma sgn) . dw
        const Vec2 along(r.opens_on_ramp && !r.closed ? 1.0 : 0.0,
                         r.sticks ? 0 : law.material->gamma * r.cohesion_sign);
        const double stiffness =
            law.strength * r.cohesion_theta / r.ramp_part * law.step->theta * law.step->h / law.ramp;
        D += stiffness * along * along.transpose();
        if (with_friction) D(0, 1) += stiffness * along.y();
    }
    return D;
}

}  // namespace knap
