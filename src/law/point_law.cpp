#include "law/point_law.hpp"

#include "base/tolerance.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace knap {
namespace {

constexpr double rounding = 2e-16;

/// beta+ and beta_theta from the openings at the end of the step.
void update_cohesion(const PointLaw& law, double u_N, double u_T, PointResponse& r) {
    r.end_cohesion = law.may_soften() ? law.material->next_cohesion(law.cohesion, u_N, u_T, law.step->h) : law.cohesion;
    r.softens = r.end_cohesion < law.cohesion && r.end_cohesion > 0;
    r.breaks = r.end_cohesion < law.cohesion && r.end_cohesion == 0;
    r.piece = r.softens ? law.material->piece_at(law.material->damage_opening(u_N, u_T)) : 0;
    r.damage = law.material->damage_slope(u_N, u_T);
    r.cohesion_theta = law.step->theta * r.end_cohesion + (1 - law.step->theta) * law.cohesion;
    r.opens = u_N > 0;
}

/// The resolvent of the staircase  -q_T in sum W_i sgn(w_T - kink_i): its force and its signs (0 at their kink).
void find_tangential(const PointLaw& law, const Multipliers& at, double w_T, PointResponse& r) {
    const double p = at.friction_follows ? r.contact : at.pressed;
    const double rubbed = law.pressed ? law.pressed(p) : p;
    const auto weight = [&](const Staircase::Kink& kink) {
        return kink.friction * rubbed + kink.cohesive * r.cohesion_theta;
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
        if (kink.friction * rubbed > 0) r.friction_sign = sign;
        if (kink.cohesive * r.cohesion_theta > 0) r.cohesion_sign = sign;
    }
    r.tangential = -force;

    // the part of friction is known with its sign; where both signs are free cohesion bears as much as it can
    const double F = law.rubbing(p), G = law.material->gamma * law.strength * r.cohesion_theta;
    if (F == 0) r.friction_part = 0;
    else if (r.friction_sign != 0) r.friction_part = -F * r.friction_sign;
    else if (r.cohesion_sign != 0) r.friction_part = r.tangential + G * r.cohesion_sign;
    else r.friction_part = r.tangential - std::clamp(r.tangential, -G, G);
}

/// Of friction over pressure, whose derivative it has.
std::uint32_t line_of(const PointLaw& law, const PointResponse& r) {
    return law.pressed ? static_cast<std::uint32_t>(law.pressed.line_at(r.contact)) : 0;
}

std::uint32_t piece(const PointLaw& law, const Multipliers& at, const PointResponse& r) {
    const auto digit = [](double sign) { return static_cast<std::uint32_t>(sign + 1); };
    std::uint32_t state = r.closed | (r.sticks << 1) | ((r.ramp_part == 0 && !r.on_ramp) << 17);
    if (r.closed && !r.sticks && at.friction_follows) state |= digit(r.friction_sign) << 2 | line_of(law, r) << 18;
    state |= (r.lands << 16) | (r.opens_on_ramp << 13);
    if (r.on_ramp) state |= (digit(r.end_sign) << 14) | (1u << 12);
    if (r.on_ramp) state |= digit(r.cohesion_sign) << 6;
    if (r.softens)
        state |= 16u | (r.opens << 5) | (digit(r.cohesion_sign) << 6) | (static_cast<std::uint32_t>(r.piece) << 8);
    return state;
}

/// The response if the cohesive impulse is c, at the rates omega that it leaves. Returned: s where the ramp looks at
/// it; with vertical unloading s - kappa, without cancellation.
double opening_under(const PointLaw& law, const Multipliers& at, double w_N, double w_T, double c, PointResponse& r) {
    const double h = law.step->h, kick = law.reach(), held = at.contact - law.strength * law.cohesion;
    r = {.cohesion_theta = c / law.strength};
    double omega_N = w_N, omega_T = w_T;
    // along N the sides are open, at rest where the opening is zero, overlapping, or stopped by the contact
    if (!law.contact.may_touch) {
        r.pull = law.u_N + kick * w_N > 0;
    } else {
        const double at_bound = held - at.rho_N * (w_N - law.contact.rate),  // q_N there
            landing = -law.u_N / kick, open = w_N - (held + c) / at.rho_N, overlapping = w_N - held / at.rho_N;
        const bool may_overlap = law.may_overlap();
        r.contact = std::max(0.0, at_bound + (may_overlap ? 0 : c));
        r.closed = r.contact > 0;
        r.lands = may_overlap && !r.closed && open <= landing && overlapping >= landing;
        omega_N = r.closed ? law.contact.rate : r.lands ? landing : open;
        if (may_overlap && !r.lands && open <= landing) {
            r.pull = 0;
            if (!r.closed) omega_N = overlapping;
        }
        if (r.lands && c > 0) r.pull = (at.rho_N * (w_N - landing) - held) / c;
    }
    find_tangential(law, at, w_T, r);
    if (r.sticks) omega_T = r.kink;
    else if (!std::isinf(at.rho_T)) omega_T += (r.tangential - at.tangential) / at.rho_T;
    const bool has_no_slip = r.sticks && r.cohesion_sign == 0 && law.material->gamma * c > 0;
    const double mean_N = r.lands ? 0 : law.u_N + kick * omega_N, mean_T = has_no_slip ? 0 : law.u_T + kick * omega_T,
                 end_T = law.u_T + h * omega_T;
    const auto sign = [](double x) { return x > 0 ? 1.0 : x < 0 ? -1.0 : 0.0; };
    update_cohesion(law, law.u_N + h * omega_N, end_T, r);
    r.full_cohesion = std::exchange(r.cohesion_theta, c / law.strength);
    r.opens_on_ramp = mean_N > 0;
    r.cohesion_sign = sign(mean_T), r.end_sign = sign(end_T);
    if (!law.drops) return law.material->equivalent_opening(mean_N, mean_T);
    const double grows_N = mean_N > 0 && law.u_N > 0 ? kick * omega_N : std::max(mean_N, 0.0) - std::max(law.u_N, 0.0),
                 grows_T = mean_T * law.u_T > 0 ? kick * omega_T * sign(law.u_T) : std::abs(mean_T) - std::abs(law.u_T);
    return law.below + grows_N + law.material->gamma * grows_T;
}

/// [m] Of the ramp, where c is a function of s: what is held at kappa is not.
double ramp_width(const PointLaw& law, const PointResponse& r) { return law.drops && r.on_ramp ? 0 : law.ramp; }

/// [kg m] kappa dc/d omega of c = C beta_theta min(s/kappa, 1), s in the middle of the step, beta_theta of its end. At
/// the kappa of vertical unloading its direction alone counts.
Vec2 ramp_slope(const PointLaw& law, const PointResponse& r, Softening softening) {
    const double gamma = law.material->gamma;
    Vec2 slope = Vec2::Zero();
    if (r.on_ramp)
        slope = law.strength * r.full_cohesion * law.reach() * Vec2(r.opens_on_ramp, gamma * r.cohesion_sign);
    if (law.drops && r.on_ramp) return slope;
    if ((softening != Softening::none && r.softens) || (softening == Softening::at_all && r.breaks))
        slope -= law.ramp * r.ramp_part * softening_modulus(law, r, softening) *
                 Vec2(r.opens ? r.damage.x() : 0, r.damage.y() * r.end_sign);
    return slope;
}

/// [1/kg] -d omega/dc. `rubs`: mu sgn of friction that follows p = pull c + ...
Vec2 rates_of_cohesion(const PointLaw& law, const Multipliers& at, const PointResponse& r, double rubs) {
    return {r.closed || !r.opens_on_ramp || !law.contact.may_touch ? 0 : 1 / at.rho_N,
            r.sticks ? 0 : (law.material->gamma * r.cohesion_sign + r.pull * rubs) / at.rho_T};
}

double rubs(const PointLaw& law, const PointResponse& r) {
    return r.closed ? law.rubbing_slope(r.contact) * r.friction_sign : 0;
}

/// The resolvent of a ramp: c falls with the rates that it leaves, of which it is an increasing function.
PointResponse respond_on_ramp(const PointLaw& law, const Multipliers& at, double w_N, double w_T) {
    PointResponse r;
    const double full = law.strength * law.cohesion;
    double low = 0, high = full, c = full;
    for (int i = 0; i < max_iterations; ++i) {
        const double s = opening_under(law, at, w_N, w_T, c, r);
        r.on_ramp = s < law.ramp && s >= 0, r.ramp_part = std::clamp(s / law.ramp, 0.0, 1.0);
        const double beyond = law.ramp * c - law.strength * r.full_cohesion * std::clamp(s, 0.0, law.ramp);
        (beyond > 0 ? high : low) = c;
        const Vec2 moves = rates_of_cohesion(law, at, r, at.friction_follows ? rubs(law, r) : 0);
        double next = c - beyond / (law.ramp + ramp_slope(law, r, Softening::now).dot(moves));
        if (std::abs(next - c) <= rounding * full || high - low <= rounding * full) break;
        if (!(next > low && next < high)) next = 0.5 * (low + high);
        c = next;
    }
    r.state = piece(law, at, r);
    return r;
}

/// Vertical unloading: c = C beta_theta beyond kappa, 0 below, and between them the c that leaves kappa. s falls with
/// c, and c - C beta_theta grows.
PointResponse respond_at_largest(const PointLaw& law, const Multipliers& at, double w_N, double w_T) {
    PointResponse r;
    const double full = law.strength * law.cohesion;
    double low = 0, high = full, c = full;
    bool held = false;  // with the cohesion `high` it is below kappa, and with less it is not
    for (int i = 0; i < max_iterations; ++i) {
        const double beyond = opening_under(law, at, w_N, w_T, c, r), excess = c - law.strength * r.full_cohesion;
        r.ramp_part = beyond >= 0;
        if (beyond < 0 ? c == 0 : std::abs(excess) <= rounding * full) {
            held = false;
            break;
        }
        held = beyond < 0 || (held && excess < 0);
        (beyond < 0 || excess > 0 ? high : low) = c;
        const Vec2 moves = rates_of_cohesion(law, at, r, at.friction_follows ? rubs(law, r) : 0);
        const double opens =  // [m/(N s)] -ds/dc
            law.reach() * (r.opens_on_ramp * moves.x() + law.material->gamma * r.cohesion_sign * moves.y());
        double next = opens > 0 ? c + beyond / opens : beyond < 0 ? low : high;
        if (beyond >= 0) {
            const double soft = c - excess / (1 + ramp_slope(law, r, Softening::now).dot(moves) / law.ramp);
            next = excess > 0 ? soft : std::min(soft, next);
        }
        if (std::abs(next - c) <= rounding * full || high - low <= rounding * full) break;
        if (i == 0 && beyond < 0) next = 0;  // most are far below
        else if (i % 4 == 3 || !(next > low && next < high)) next = 0.5 * (low + high);
        c = next;
    }
    r.on_ramp = held;
    if (held) {
        if (law.material->relaxation_time == 0) {
            r.full_cohesion = r.end_cohesion = law.cohesion;
            r.softens = r.breaks = false;
        }
        r.ramp_part = r.full_cohesion > 0 ? c / (law.strength * r.full_cohesion) : 0;
    }
    r.state = piece(law, at, r);
    return r;
}

/// omega = w + (q - q^)/rho where it is free, q = (p - pull c, -gamma c sgn - mu p sgn), dc = slope . d omega/kappa.
Eigen::Matrix2d ramp_tangent(const PointLaw& law, const Multipliers& at, const PointResponse& r, Softening softening,
                             double friction) {
    Vec2 slope = ramp_slope(law, r, softening);
    const double falls = ramp_width(law, r) + slope.dot(rates_of_cohesion(law, at, r, friction));
    slope = falls > 0 ? Vec2(slope / falls) : Vec2(Vec2::Zero());
    if (r.closed) slope.x() = friction * at.rho_N / at.rho_T * slope.y();
    if (r.lands || (r.closed && r.sticks)) slope.x() = 0;
    if (r.sticks) slope.y() = 0;
    const Vec2 along(r.pull, r.sticks ? 0 : law.material->gamma * r.cohesion_sign + r.pull * friction);
    Eigen::Matrix2d D = along * slope.transpose();
    if (r.closed || r.lands) D.row(0) << at.rho_N, 0;
    if (r.closed && !r.sticks) D(1, 0) -= friction * at.rho_N;
    if (r.sticks) D(1, 1) = std::isinf(at.rho_T) ? 0 : at.rho_T;
    if (std::abs(D(0, 1) - D(1, 0)) <= 8 * rounding * std::abs(D(0, 1))) D(1, 0) = D(0, 1);
    return D;
}

/// The direction in which an opening lowers the cohesion: that of its loss, unless slip has its own fracture energy.
Vec2 damage_direction(const PointResponse& r) {
    return {r.opens && !r.closed ? r.damage.x() : 0.0, r.sticks ? 0 : r.damage.y() * r.cohesion_sign};
}

constexpr double imposed_weight = 1e5;  // [-] where both sides are driven, the rate alone decides

/// The norm at the end of the step, with the cohesion beta_theta; the ramp of secant unloading over the step.
class SofteningNorm final : public NormLaw {
public:
    explicit SofteningNorm(const PointLaw& point) : point_(point) {
        const double h = point.step->h;
        cohesive = point.strength, gamma = point.material->gamma;
        contact = point.contact;
        add_friction_theta(point.pressed ? 1 : point.friction, sliding);
        over_pressure = point.pressed;
        shift = Vec2(point.u_N, point.u_T) / h;
        ramp = point.ramp / h, start = std::min(ramp, NormLaw::size(shift));
    }
    double borne(double size) const { return NormLaw::rho(size); }
    double steepness(double size) const { return NormLaw::slope_of_rho(size); }
    double cohesion_theta(double size) const {
        const double theta = point_.step->theta;
        return theta * end_cohesion(size) + (1 - theta) * point_.cohesion;
    }
    double rho(double size) const override { return cohesion_theta(size) * borne(size); }
    double slope_of_rho(double size) const override {
        const ThetaStep& step = *point_.step;
        const double end = end_cohesion(size), rises = cohesion_theta(size) * steepness(size);
        if (end == 0 || end >= point_.cohesion) return rises;
        return rises - borne(size) * step.theta * step.h * point_.material->relaxed_part(step.h) /
                           point_.material->piece_length(point_.material->piece_at(step.h * size));
    }

private:
    double end_cohesion(double size) const {
        if (size == last_size_) return last_end_;  // rho and its slope are asked together
        const ThetaStep& step = *point_.step;
        last_size_ = size;
        return last_end_ = point_.may_soften()
                               ? point_.material->next_cohesion(point_.cohesion, step.h * size, 0, step.h)
                               : point_.cohesion;
    }
    const PointLaw& point_;
    mutable double last_size_ = -1, last_end_ = 0;
};

/// Stiffness and direction change with the rates: what is within some hundredths has one state.
std::uint32_t state_of_curved(const PointLaw& law, const PointResponse& r, const Vec2& along) {
    std::uint32_t state = r.closed | (r.sticks << 1) | (r.softens << 4) | (static_cast<std::uint32_t>(r.piece) << 8);
    if (r.sticks || r.curvature == 0) return state;
    if (r.closed) state |= line_of(law, r) << 28;
    const auto angle = static_cast<std::uint32_t>(8 * (std::atan2(along.y(), along.x()) + 4)),
               size = static_cast<std::uint32_t>(std::clamp(64 + 4 * std::log2(r.curvature), 0.0, 255.0));
    return state | (angle << 12) | (size << 20);
}

PointResponse respond_by_norm(const PointLaw& law, const Multipliers& at, double w_N, double w_T) {
    SofteningNorm norm(law);
    norm.pressed = at.friction_follows ? -1 : at.pressed;
    const double weight = std::isinf(at.rho_T) ? imposed_weight * at.rho_N : at.rho_N;
    const Vec2 Q(at.contact - law.strength * law.cohesion - weight * w_N, at.tangential - weight * w_T);
    const NormLaw::Response found = norm.respond(Q, weight);
    PointResponse r;
    update_cohesion(law, found.size * law.step->h, 0, r);
    const Vec2 W = found.rate + norm.shift, q = found.at.impulse;
    const bool is_rigid = found.sticks && !found.closed;   // in both components, as what is closed and sticks
    const bool floats = !found.closed && found.size == 0;  // between overlap and contact: it sticks along T alone
    r.closed = found.closed || is_rigid;
    r.sticks = found.sticks || floats;
    r.kink = r.sticks ? found.rate.y() : 0;
    r.tangential = q.y(), r.friction_part = found.friction, r.friction_sign = found.friction_sign;
    r.cohesion_sign = W.y() > 0 ? 1 : W.y() < 0 ? -1 : 0;
    r.opens = W.x() > 0;
    r.opening_rate = W;
    r.full_cohesion = r.cohesion_theta, r.ramp_part = norm.borne(found.size), r.on_ramp = r.ramp_part < 1;
    r.cohesion_theta *= r.ramp_part;
    const double full = law.strength * r.cohesion_theta;
    r.pull = full > 0 ? -found.cohesion.x() / full : 0;
    r.contact = found.closed ? std::max(0.0, q.x() + full * r.pull) : 0;
    r.curvature = found.size > 0 ? full / (found.size * weight) : 0;
    r.state = state_of_curved(law, r, norm.along(W));
    return r;
}

Eigen::Matrix2d tangent_of_norm(const PointLaw& law, const Multipliers& at, const PointResponse& r,
                                Softening softening) {
    const SofteningNorm norm(law);
    Eigen::Matrix2d D = Eigen::Matrix2d::Zero();
    if (std::isinf(at.rho_T)) return D;  // both sides are driven
    const double weight = at.rho_N;
    const bool falls =
        (softening == Softening::now && r.softens) || (softening == Softening::at_all && (r.softens || r.breaks));
    const double rises = law.strength * r.full_cohesion * norm.steepness(norm.size(r.opening_rate)) / weight,
                 modulus = falls ? r.ramp_part * softening_modulus(law, r, softening) : 0;
    const bool is_small = softening == Softening::now && 2 * modulus < weight;  // in the derivative of the projection
    D = weight * norm.slope(r.opening_rate, r.curvature, rises - (is_small ? modulus / weight : 0), r.closed);
    if (modulus > 0 && !is_small && !r.sticks) {
        Vec2 loss = norm.along(r.opening_rate);
        if (r.closed) loss.x() = 0;
        D -= modulus * (loss * loss.transpose());
    }
    D(1, 0) = D(0, 1);  // but for rounding, and what is not symmetric to the bit is solved as friction
    if (r.sticks) D.row(1) << 0, weight;
    else if (r.closed && r.friction_sign != 0 && at.friction_follows && softening != Softening::at_all)
        D(1, 0) = -rubs(law, r) * weight * (1 - D(1, 1) / weight);
    return D;
}

}  // namespace

void PointLaw::set_staircase() {
    tangential = {};
    add_friction_theta(pressed ? 1 : friction, tangential);
    tangential.add({.rate = u_T == 0 ? 0 : -u_T / reach(), .cohesive = material->gamma * strength, .friction = 0}, 0);
}

PointResponse respond(const PointLaw& law, const Multipliers& at, double w_N, double w_T) {
    if (law.is_curved()) return respond_by_norm(law, at, w_N, w_T);
    if (law.ramp > 0) return law.drops ? respond_at_largest(law, at, w_N, w_T) : respond_on_ramp(law, at, w_N, w_T);
    PointResponse r;
    r.contact = law.contact.may_touch ? std::max(0.0, at.contact - at.rho_N * (w_N - law.contact.rate)) : 0;
    r.closed = r.contact > 0;
    // a closed or sticking component has the rate of its bound or kink, not the one of the augmentation
    const double u_N = law.u_N + law.step->h * (r.closed ? law.contact.rate : w_N), u_T = law.u_T + law.step->h * w_T;
    update_cohesion(law, u_N, u_T, r);
    find_tangential(law, at, w_T, r);
    if (r.sticks) {
        update_cohesion(law, u_N, r.kink == 0 ? law.u_T : 0, r);
        const double kink = r.kink;
        find_tangential(law, at, w_T, r);
        if (!r.sticks || r.kink != kink) update_cohesion(law, u_N, u_T, r);
    }
    r.state = piece(law, at, r);
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
    if (law.is_curved()) return tangent_of_norm(law, at, r, softening);
    const bool with_friction = r.closed && law.friction > 0 && at.friction_follows && softening != Softening::at_all;
    if (law.ramp > 0) return ramp_tangent(law, at, r, softening, with_friction ? rubs(law, r) : 0);
    Eigen::Matrix2d D = Eigen::Matrix2d::Zero();
    if (r.closed) D(0, 0) = at.rho_N;
    if (r.sticks) D(1, 1) = std::isinf(at.rho_T) ? 0 : at.rho_T;
    else if (with_friction) D(1, 0) = -rubs(law, r) * at.rho_N;  // -q_T = mu p sgn, dp = -rho dw_N
    if ((softening != Softening::none && r.softens) || (softening == Softening::at_all && r.breaks)) {
        // q = -C beta_theta (1, gamma sgn), d beta_theta = theta h d beta/ds d s_d/du . dw
        const Vec2 loss = loss_direction(law, r), damage = damage_direction(r);
        const double modulus = softening_modulus(law, r, softening);
        D -= modulus * loss * damage.transpose();
        // the contact of a closed point carries the lost tension, and its friction grows with it
        if (with_friction) D(0, 1) -= modulus * damage.y();
    }
    return D;
}

}  // namespace knap
