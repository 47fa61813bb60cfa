#include "interfaces/point_law.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

/// beta+ and beta_theta from the openings at the end of the step.
void lose_cohesion(const PointLaw& law, double u_N, double u_T, PointResponse& r) {
    r.end_cohesion = law.cohesion;
    r.softens = r.breaks = false;
    if (law.implicit_beta && law.cohesion > 0) {
        const double loaded = 1 - (std::max(u_N, 0.0) + law.gamma * std::abs(u_T)) / law.delta_c;
        r.softens = loaded < law.cohesion && loaded > 0;
        r.breaks = loaded <= 0;
        r.end_cohesion = std::clamp(loaded, 0.0, law.cohesion);
    }
    r.cohesion_theta = law.theta * r.end_cohesion + (1 - law.theta) * law.cohesion;
    r.opens = u_N > 0;
}

/// The staircase -q_T in F sgn(omega) + G sgn(omega + u_T/h): where it stands, and both signs (0 at their kink).
void find_tangential(const PointLaw& law, double w_T, PointResponse& r) {
    const double F = law.friction * (law.friction_follows ? r.contact : law.pressed), G = law.gamma * law.strength * r.cohesion_theta;
    const double crossing = law.u_T == 0 ? 0 : -law.u_T / law.h;
    struct Kink {
        double rate, weight;
    };
    Kink low{0, F}, high{crossing, G};  // in ascending order; where they coincide they are one
    if (high.rate < low.rate) std::swap(low, high);
    if (low.rate == high.rate) low.weight += high.weight, high.weight = 0;
    const double both = low.weight + high.weight, between = low.weight - high.weight;
    r.friction_sign = r.cohesion_sign = 0;
    r.sticks = false;
    r.tangential = r.friction_part = 0;
    if (both == 0) return;

    bool at_low = false, at_high = false, above_low = false, above_high = false;
    double force;  // -q_T
    if (std::isinf(law.rho_T)) {
        at_low = w_T == low.rate, at_high = high.weight > 0 && w_T == high.rate;
        above_low = w_T > low.rate, above_high = w_T > high.rate;
        force = (at_low ? 0 : above_low ? 1 : -1) * low.weight + (at_high ? 0 : above_high ? 1 : -1) * high.weight;
    } else {
        const double trial = law.rho_T * w_T - law.tangential_guess;
        const double at_first = trial - law.rho_T * low.rate, at_second = trial - law.rho_T * high.rate;  // -q_T if it stood at the kink
        above_low = at_first > between, above_high = at_second > both;
        at_low = !above_low && at_first >= -both && low.weight > 0;
        at_high = above_low && !above_high && at_second >= between && high.weight > 0;
        force = at_low ? at_first : at_high ? at_second : above_high ? both : above_low ? between : -both;
    }
    r.tangential = -force;
    r.sticks = at_low || at_high;
    r.kink = at_high ? high.rate : low.rate;

    // friction's share: where its sign is known it is known; where both signs are free cohesion takes what it can
    const double low_sign = at_low ? 0 : above_low ? 1 : -1, high_sign = at_high ? 0 : above_high ? 1 : -1;
    const bool merged = crossing == 0;
    r.friction_sign = F == 0 ? 0 : merged || low.rate == 0 ? low_sign : high_sign;
    r.cohesion_sign = G == 0 ? 0 : merged || low.rate == crossing ? low_sign : high_sign;
    if (F == 0) return;
    if (r.friction_sign != 0)
        r.friction_part = -F * r.friction_sign;
    else if (r.cohesion_sign != 0)
        r.friction_part = r.tangential + G * r.cohesion_sign;
    else
        r.friction_part = r.tangential - std::clamp(r.tangential, -G, G);
}

std::uint32_t piece(const PointLaw& law, const PointResponse& r) {
    const auto digit = [](double sign) { return static_cast<std::uint32_t>(sign + 1); };
    std::uint32_t state = r.closed | (r.sticks << 1);
    if (r.closed && !r.sticks && law.friction_follows) state |= digit(r.friction_sign) << 2;
    if (r.softens) state |= 16u | (r.opens << 5) | (digit(r.cohesion_sign) << 6);
    return state;
}

}  // namespace

PointResponse respond(const PointLaw& law, double w_N, double w_T) {
    PointResponse r;
    r.contact = law.may_touch ? std::max(0.0, law.contact_guess - law.rho_N * (w_N - law.bound)) : 0;
    r.closed = r.contact > 0;
    // what is closed, or sticks, is where it is held, not where the augmentation has it
    const double u_N = law.u_N + law.h * (r.closed ? law.bound : w_N);
    lose_cohesion(law, u_N, law.u_T + law.h * w_T, r);
    find_tangential(law, w_T, r);
    if (r.sticks) {
        lose_cohesion(law, u_N, r.kink == 0 ? law.u_T : 0, r);
        const double kink = r.kink;
        find_tangential(law, w_T, r);
        if (r.kink != kink) lose_cohesion(law, u_N, law.u_T + law.h * w_T, r);
    }
    r.state = piece(law, r);
    return r;
}

double softening_modulus(const PointLaw& law) { return law.strength * law.theta * law.h / law.delta_c; }

Vec2 loss_direction(const PointLaw& law, const PointResponse& r) {
    return {r.opens && !r.closed ? 1.0 : 0.0, r.sticks ? 0 : law.gamma * r.cohesion_sign};
}

Eigen::Matrix2d tangent(const PointLaw& law, const PointResponse& r, Softening softening) {
    Eigen::Matrix2d D = Eigen::Matrix2d::Zero();
    if (r.closed) D(0, 0) = law.rho_N;
    if (r.sticks)
        D(1, 1) = std::isinf(law.rho_T) ? 0 : law.rho_T;
    else if (r.closed && law.friction > 0 && law.friction_follows && softening != Softening::at_all)
        D(1, 0) = -law.friction * r.friction_sign * law.rho_N;  // -q_T = mu p sgn + ..., dp = -rho dw_N
    if ((softening != Softening::none && r.softens) || (softening == Softening::at_all && r.breaks)) {
        // q = -C beta_theta (1, gamma sgn), d beta_theta = -theta h/delta_c (opens, gamma sgn) . dw
        const Vec2 loss = loss_direction(law, r);
        D -= softening_modulus(law) * loss * loss.transpose();
        // what is closed carries the lost pull in its contact, and rubs with it
        if (r.closed && law.friction > 0 && law.friction_follows && softening != Softening::at_all) D(0, 1) -= softening_modulus(law) * loss.y();
    }
    return D;
}

}  // namespace knap
