#include "interfaces/point_law.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

double sign(double x) { return (x > 0) - (x < 0); }

struct Kink {
    double rate, weight;
};

}  // namespace

PointResponse respond(const PointLaw& law, double w_N, double w_T) {
    PointResponse r;
    r.contact = law.may_touch ? std::max(0.0, law.contact_guess - law.rho_N * (w_N - law.bound)) : 0;
    r.closed = r.contact > 0;

    // beta+ and beta_theta
    const double u_N = law.u_N + law.h * w_N, u_T = law.u_T + law.h * w_T;
    r.end_cohesion = law.cohesion;
    if (law.implicit_beta && law.cohesion > 0) {
        const double loaded = 1 - (std::max(u_N, 0.0) + law.gamma * std::abs(u_T)) / law.delta_c;
        r.softens = loaded < law.cohesion && loaded > 0;
        r.end_cohesion = std::clamp(loaded, 0.0, law.cohesion);
    }
    r.cohesion_theta = law.theta * r.end_cohesion + (1 - law.theta) * law.cohesion;

    // the staircase -q_T in F sgn(omega) + G sgn(omega + u_T/h): kinks in ascending order, rest first where they coincide
    const double F = law.friction * r.contact, G = law.gamma * law.strength * r.cohesion_theta;
    Kink low{0, F}, high{-law.u_T / law.h, G};
    bool swapped = false;
    if (high.rate < low.rate) std::swap(low, high), swapped = true;
    if (low.rate == high.rate) low.weight += high.weight, high.weight = 0;
    const double both = low.weight + high.weight, between = low.weight - high.weight;
    int piece = 0;  // 0 below, 1 at the low kink, 2 between, 3 at the high kink, 4 above
    double force = 0;  // -q_T
    if (both > 0 && std::isinf(law.rho_T)) {
        piece = w_T < low.rate ? 0 : w_T == low.rate ? 1 : w_T < high.rate ? 2 : w_T == high.rate ? 3 : 4;
        force = piece == 0 ? -both : piece == 1 ? -high.weight : piece == 2 ? between : piece == 3 ? low.weight : both;
    } else if (both > 0) {
        const double trial = law.rho_T * w_T - law.tangential_guess;
        const auto pull = [&](const Kink& kink) { return trial - law.rho_T * kink.rate; };  // -q_T, if it stood at this kink
        if (pull(low) < -both) piece = 0, force = -both;
        else if (low.weight > 0 && pull(low) <= between) piece = 1, force = pull(low);
        else if (pull(high) < between) piece = 2, force = between;
        else if (high.weight > 0 && pull(high) <= both) piece = 3, force = pull(high);
        else piece = 4, force = both;
    }
    r.tangential = -force;
    r.sticks = piece == 1 || piece == 3;
    r.kink = piece == 3 ? high.rate : low.rate;

    // friction's share: where its sign is known it is known; where both signs are free cohesion takes what it can
    const auto sign_at = [&](double rate) {
        if (rate == low.rate && (piece == 1 || (low.rate == high.rate && piece == 3))) return 0.0;
        if (rate == high.rate && piece == 3) return 0.0;
        return rate == low.rate ? (piece >= 2 ? 1.0 : -1.0) : (piece >= 4 ? 1.0 : -1.0);
    };
    const double friction_sign = F > 0 ? sign_at(0) : 0, cohesion_sign = G > 0 ? sign_at(-law.u_T / law.h) : 0;
    if (F > 0) {
        if (friction_sign != 0) r.friction_part = -F * friction_sign;
        else if (cohesion_sign != 0) r.friction_part = r.tangential + G * cohesion_sign;
        else r.friction_part = r.tangential - std::clamp(r.tangential, -G, G);
    }
    const double slip_sign = r.sticks && cohesion_sign == 0 ? 0 : sign(u_T);
    r.state = static_cast<std::uint32_t>(r.closed) | (piece << 1) | (swapped << 4) | (r.softens << 5) | ((u_N > 0) << 6) |
              (static_cast<std::uint32_t>(slip_sign + 1) << 7) | (static_cast<std::uint32_t>(friction_sign + 1) << 9) |
              (static_cast<std::uint32_t>(cohesion_sign + 1) << 11) | ((both > 0) << 13);
    return r;
}

Eigen::Matrix2d tangent(const PointLaw& law, const PointResponse& r, bool softening) {
    const auto stored_sign = [&](int shift) { return static_cast<double>((r.state >> shift) & 3) - 1; };
    const double slip_sign = stored_sign(7), friction_sign = stored_sign(9), cohesion_sign = stored_sign(11);
    const double opens = (r.state >> 6) & 1;
    Eigen::Matrix2d D = Eigen::Matrix2d::Zero();
    if (r.closed) D(0, 0) = law.rho_N;
    if (r.sticks)
        D(1, 1) = std::isinf(law.rho_T) ? 0 : law.rho_T;
    else if (r.closed)
        D(1, 0) = -law.friction * friction_sign * law.rho_N;  // -q_T = mu p sgn + ..., dp = -rho dw_N
    if (softening && r.softens) {
        // q = -C beta_theta (1, gamma sgn), d beta_theta = -theta h/delta_c (opens, gamma sgn) . dw
        const double modulus = law.strength * law.theta * law.h / law.delta_c;
        const Vec2 loss(opens, law.gamma * slip_sign), force(1, r.sticks ? 0 : law.gamma * cohesion_sign);
        if (!r.sticks) D -= modulus * force * loss.transpose();
        else D(0, 0) -= modulus * opens;
    }
    return D;
}

}  // namespace knap
