#include "law/norm_law.hpp"

#include "base/tolerance.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr double root_rounding = 4e-16;

struct ValueAndSlope {
    double value, slope;
};

/// The zero of a growing function of x in [low, high]: Newton's method where its steps halve, else bisection.
template <class Function>
double root_between(double low, double high, double x, const Function& f) {
    double last = infinity;
    for (int i = 0; i < max_iterations && high > low; ++i) {
        const auto [value, slope] = f(x);
        if (value == 0) return x;
        (value > 0 ? high : low) = x;
        double next = x - value / slope;
        if (!(next > low && next < high) || std::abs(next - x) > 0.5 * last) next = 0.5 * (low + high);
        last = std::abs(next - x);
        if (last <= root_rounding * std::abs(x)) return next;
        x = next;
    }
    return x;
}

}  // namespace

double NormLaw::rho(double size) const {
    if (ramp <= 0) return 1;
    if (size <= ramp) return std::min(1.0, 0.5 * (size + start) / ramp);
    return 1 - 0.5 * (ramp - start) * (ramp - start) / (ramp * (size - start));
}

double NormLaw::slope_of_rho(double size) const {
    if (ramp <= 0) return 0;
    if (size <= ramp) return size + start < 2 * ramp ? 0.5 / ramp : 0;
    const double a = (ramp - start) / (size - start);
    return 0.5 * a * a / ramp;
}

/// |W| of W + k rho d|W| = A with A_N > 0:  A_N^2/(S + k rho)^2 + gamma^2 A_T^2/(S + k gamma^2 rho)^2 = 1, whose left
/// side falls with S. The inverse of its root is nearly linear.
double NormLaw::size_after(const Vec2& A, double k) const {
    const double g2 = gamma * gamma;
    const double most = length(A.x(), gamma * A.y());
    const auto missing = [&](double S) -> ValueAndSlope {
        const double force = k * rho(S), growth = k * slope_of_rho(S);
        const double n = A.x() / (S + force), t = gamma * A.y() / (S + g2 * force), norm = length(n, t);
        const double falls = (n * n * (1 + growth) / (S + force) + t * t * (1 + g2 * growth) / (S + g2 * force)) / norm;
        const double value = 1 / norm - 1;
        return {std::abs(value) <= root_rounding ? 0 : value, falls / (norm * norm)};
    };
    return root_between(0, most, std::max(0.0, most - k * std::max(gamma, 1.0) * rho(most)), missing);
}

/// W_T with a given W_N:  r (W_T - A_T) + r k gamma^2 rho W_T/|W| + F sum of the signs of friction = 0.
double NormLaw::slip_after(double W_N, double A_T, double k, double F, double r) const {
    const double N = std::max(W_N, 0.0);
    const auto cohesion = [&](double W_T) -> ValueAndSlope {
        const double S = length(N, gamma * W_T), g2 = gamma * gamma;
        if (S == 0) return {0, 0};
        const double t = gamma * W_T / S, force = k * rho(S);
        return {gamma * force * t, g2 * (force * (1 - t * t) / S + k * slope_of_rho(S) * t * t)};
    };
    // the zero lies between places where the force jumps, or at one of them
    const double set_valued = N == 0 ? k * gamma * rho(0) : 0;
    double most = 2 * std::abs(A_T) + k * gamma;
    for (const Staircase::Kink& kink : sliding.kinks()) most += 2 * F / r * kink.friction;
    double low = -most, high = most;
    const auto friction = [&](double W_T, double& jump) {
        double force = 0;
        for (const Staircase::Kink& kink : sliding.kinks()) {
            const double at = kink.rate + shift.y(), weight = F / r * kink.friction;
            if (at == W_T) jump += weight;
            else force += W_T > at ? weight : -weight;
        }
        return force;
    };
    const auto is_at = [&](double place) {
        double jump = place == 0 ? set_valued : 0;
        const double middle = place - A_T + cohesion(place).value + friction(place, jump);
        if (middle > jump) high = std::min(high, place);
        else if (middle < -jump) low = std::max(low, place);
        else return true;
        return false;
    };
    if (set_valued > 0 && is_at(0)) return 0;
    if (F > 0)
        for (const Staircase::Kink& kink : sliding.kinks())
            if (const double place = kink.rate + shift.y(); is_at(place)) return place;
    double none = 0;
    const double middle = 0.5 * (low + high), constant = friction(middle, none), sign = middle > 0 ? 1 : -1;
    const auto missing = [&](double W_T) -> ValueAndSlope {
        ValueAndSlope at = cohesion(W_T);
        if (W_T == 0 && set_valued > 0) at.value = sign * set_valued;  // of the side of the interval
        const double value = W_T - A_T + at.value + constant,
                     size = std::abs(W_T) + std::abs(A_T) + std::abs(at.value) + std::abs(constant);
        return {std::abs(value) <= root_rounding * size ? 0 : value, 1 + at.slope};  // what is rounding has no sign
    };
    const double guess =
        std::clamp(A_T - constant - (N == 0 ? sign * k * gamma * rho(gamma * std::abs(A_T)) : 0), low, high);
    return root_between(low, high, guess, missing);
}

Vec2 NormLaw::along(const Vec2& W) const {
    const double S = size(W);
    return S > 0 ? Vec2(std::max(W.x(), 0.0) / S, gamma * gamma * W.y() / S) : Vec2(Vec2::Zero());
}

/// H = a q q' + growth d d' with d = d|W|/dW, q = (-W_T, W_N)/|W|, a = curvature gamma^2, q x d = -1. Then
///     I - (I + H)^-1 = (det H I + H)/det(I + H),     det H = a growth
/// without cancellation, however small |W| and large a are, and symmetric to the bit: what is not counts as friction.
Eigen::Matrix2d NormLaw::slope(const Vec2& W, double curvature, double growth, bool closed) const {
    const Vec2 d = along(W), q(-d.y() / (gamma * gamma), d.x());
    const double a = W.x() > 0 ? curvature * gamma * gamma : 0;
    if (closed) {
        const double H = a * q.y() * q.y() + growth * d.y() * d.y();
        return Vec2(1, std::isinf(H) ? 1 : H / (1 + H)).asDiagonal();
    }
    const double unit = std::max(a, 1.0), stiff = a / unit, soft = growth / unit;  // of a and growth, over unit
    const Eigen::Matrix2d numerator = stiff * growth * Eigen::Matrix2d::Identity() +
                                      Eigen::Matrix2d(stiff * (q * q.transpose()) + soft * (d * d.transpose()));
    return numerator / (1 / unit + stiff * q.squaredNorm() + soft * d.squaredNorm() + stiff * growth);
}

NormLaw::Response NormLaw::respond(const Vec2& Q, double r) const {
    Response found;
    const Vec2 A = shift - Q / r;
    const double k = cohesive / r, bound = contact.rate + shift.x();
    const auto finish = [&](const Vec2& W) {
        found.rate = W - shift, found.size = size(W);
        return found;
    };
    Vec2 W = A;
    if (A.x() > 0 && k > 0) {
        const double S = length(A.x(), A.y() / gamma) <= k * rho(0) ? 0 : size_after(A, k), force = k * rho(S);
        found.sticks = S == 0;
        W = found.sticks ? Vec2(Vec2::Zero()) : Vec2(A.x() * S / (S + force), A.y() * S / (S + gamma * gamma * force));
    } else if (k > 0 && !(contact.may_touch && A.x() < bound)) {
        W.y() = slip_after(A.x(), A.y(), k, 0, r);
    }
    found.closed = contact.may_touch && W.x() < bound;
    if (found.sticks && !found.closed) {
        found.at = {.impulse = -r * A, .slope = Eigen::Matrix2d::Identity()};
        found.cohesion = found.at.impulse;
        return finish(W);
    }
    found.sticks = false;
    double pressure = 0, F = 0;  // on the closed sides, and that of their friction
    double steepness = 1;        // [-] of F over it
    if (found.closed) {
        pressure = r * (bound - A.x()), F = pressed >= 0 ? pressed : std::max(pressure, 0.0);
        if (over_pressure) steepness = over_pressure.slope(F), F = over_pressure(F);
        W.x() = bound;
        W.y() = slip_after(bound, A.y(), k, F, r);
    }
    const double S = size(W);
    const bool is_held = S == 0 && k > 0;  // by cohesion, along T
    if (S > 0 && k > 0) {
        found.cohesion = -cohesive * rho(S) * along(W);
        found.at.slope = slope(W, k * rho(S) / S, k * slope_of_rho(S), found.closed);
    } else {
        found.at.slope = Vec2(found.closed ? 1 : 0, is_held ? 1 : 0).asDiagonal();
        if (is_held) found.cohesion.y() = -r * A.y();
    }
    found.at.impulse = found.cohesion;
    if (!found.closed) return finish(W);

    found.sticks = is_held;
    double signs = 0;  // of friction
    for (const Staircase::Kink& kink : sliding.kinks()) {
        const double at = kink.rate + shift.y();
        if (F > 0 && W.y() == at) found.sticks = true;
        else signs += W.y() > at ? kink.friction : -kink.friction;
    }
    found.at.impulse.x() = pressure;
    if (found.sticks) {
        const double T = r * (W.y() - A.y()), most = gamma * cohesive * rho(0);
        if (is_held) found.cohesion.y() = F > 0 ? std::clamp(T, -most, most) : T;
        found.friction = T - found.cohesion.y();
        found.at.impulse.y() = T;
        found.at.slope.row(1) << 0, 1;
    } else if (F > 0) {
        found.friction = -F * signs;
        found.friction_sign = signs > 0 ? 1 : -1;
        found.at.impulse.y() += found.friction;
        if (pressed < 0) found.at.slope(1, 0) = -steepness * signs * (1 - found.at.slope(1, 1));
    }
    return finish(W);
}

}  // namespace knap
