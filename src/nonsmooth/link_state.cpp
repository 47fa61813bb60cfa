#include "nonsmooth/link_state.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

Bearing bearing_of(double part) { return part >= 1 ? Bearing::full : part > 0 ? Bearing::part : Bearing::none; }

// of speed [m/s] and impulse [N s]: far ahead of a wave explicit steps leave motions whose squares are no normal
// numbers
constexpr double at_rest = 1e-150;
constexpr double found_at = 1e-9;  // of speed and impulse: a link within this distance of a kink is at it

}  // namespace

FanScales scales_of(const FanProblem& problem, double rest) {
    double impulse = 0, speed = 0, mass = 0;
    for (const FanBody& body : problem.bodies) {
        const Vec2 m = body.mass();
        impulse = std::max(impulse, m.cwiseProduct(body.free_velocity - body.velocity).cwiseAbs().maxCoeff());
        speed = std::max({speed, body.free_velocity.cwiseAbs().maxCoeff(), body.velocity.cwiseAbs().maxCoeff()});
        mass = std::max(mass, m.maxCoeff());
    }
    for (const FanLink& link : problem.links) {  // the impulse of an impact, and the speed that the cohesion can cause
        const Vec2 w = problem.inverse_mass(link.after) + problem.inverse_mass(link.before);
        const Vec2 approach = (problem.free_velocity(link.after) - problem.free_velocity(link.before)).cwiseAbs();
        for (int k = 0; k < 2; ++k)
            if (w[k] > 0) impulse = std::max(impulse, approach[k] / w[k]);
        if (link.unbreakable) continue;
        impulse = std::max(impulse, link.cohesive);
        speed = std::max(speed, link.cohesive * w.maxCoeff());
    }
    // an impulse is a difference of momenta, whose rounding limits it; for a fan at rest without load any unit will do
    impulse += 0.01 * mass * speed;
    if (impulse < at_rest) impulse = 1;
    if (speed < at_rest) speed = 1;
    return {.impulse = impulse,
            .speed = speed,
            .impulse_tolerance = relative_tolerance * impulse,
            .speed_tolerance = relative_tolerance * speed,
            .rest = std::max(relative_tolerance * speed, rest * speed),
            .separation = problem.turns ? rest * speed : 0};
}

InterfaceLaw link_law(const FanLink& link, const Vec2& velocity_before, double h, double tolerance) {
    const double V_N = link.normal.dot(velocity_before), V_T = link.tangent().dot(velocity_before);
    const Staircase::Kink zero_slip{.rate = link.ramp > 0 ? -link.ramp_start.y() : -link.u_T / h,
                                    .cohesive = link.gamma * link.cohesive,
                                    .friction = 0};
    InterfaceLaw law{.contact = contact_bound_explicit(link.u_N, V_N, link.restitution, h, tolerance * h, link.given)};
    law.open.add(zero_slip, tolerance);
    add_friction_explicit(link.pressed ? 1 : link.friction, V_T, tolerance, law.closed);
    law.closed.add(zero_slip, tolerance);
    return law;
}

NormLaw norm_law(const FanLink& link, const Vec2& velocity_before, double h, double tolerance) {
    const double V_N = link.normal.dot(velocity_before), V_T = link.tangent().dot(velocity_before);
    const double until = link.kappa > 0 ? 0.5 * h : h;  // [s] to the opening that decides
    NormLaw law;
    law.cohesive = link.cohesive, law.gamma = link.gamma;
    law.contact = contact_bound_explicit(link.u_N, V_N, link.restitution, h, tolerance * h, link.given);
    add_friction_explicit(link.pressed ? 1 : link.friction, V_T, tolerance, law.sliding);
    law.over_pressure = link.pressed;
    law.shift = Vec2(link.u_N, link.u_T) / until;
    for (double& rate : law.shift)
        if (std::abs(rate) <= tolerance) rate = 0;  // an opening that is the rounding of this step
    law.ramp = link.kappa / until;
    law.start = std::min(law.ramp, law.size(link.middle) / until);
    return law;
}

void LinkState::set(bool to_closed, int to_tangential_state) {
    closed = to_closed;
    tangential_state = to_tangential_state;
    tangential = law.staircase(closed).piece(tangential_state);
}

void LinkState::set_line(const FanLink& link, int to_line) {
    line = to_line;
    law.closed.line = link.pressed.line(line);
}

void LinkState::find_part(const FanLink& link, const Vec2& velocity, double on_ramp) {
    if (!(link.ramp > 0)) return;
    const bool is_on_ramp = this->is_on_ramp(link);
    const double at = is_on_ramp ? on_ramp / link.cohesive : std::clamp(link.ramp_part(velocity), 0.0, 1.0);
    if (sticks()) bearing = bearing_of(at);
    part = bearing == Bearing::full ? 1 : bearing == Bearing::none ? 0 : at;
}

void LinkState::guess(const FanProblem& problem, const FanLink& link, const FanScales& scales) {
    imposed = slip_follows_normal = false;
    bearing = Bearing::full, part = 1;
    if (link.unbreakable) {
        closed = true;
        tangential = {};
        return;
    }
    Vec2 expected = problem.velocity_before(link.after) - problem.velocity_before(link.before);
    if (const double V_N = link.normal.dot(expected); V_N > 0 && V_N <= scales.separation)
        expected -= V_N * link.normal;
    law = link_law(link, expected, problem.drift_time, scales.rest);
    if (link.pressed) set_line(link, link.pressed.line_at(link.last_impulse.x() + link.cohesive));
    int n_imposed = 0;
    for (int k = 0; k < 2; ++k) {
        const auto prescribed = [&](Index body) { return problem.inverse_mass(body)[k] == 0; };
        if (!prescribed(link.before) || !prescribed(link.after)) continue;
        expected[k] = problem.free_velocity(link.after)[k] - problem.free_velocity(link.before)[k];
        ++n_imposed;
    }
    imposed = n_imposed == 2, slip_follows_normal = n_imposed == 1;
    const bool touches =
        law.contact.may_touch && link.normal.dot(expected) <= law.contact.rate + scales.speed_tolerance;
    set(touches, state_of(touches, link.tangent().dot(expected), scales.speed_tolerance));
    if (link.ramp > 0) bearing = bearing_of(link.ramp_part(expected) + relative_tolerance);
}

void LinkState::fit(const FanLink& link, const Vec2& velocity, const Vec2& impulse, const FanScales& scales,
                    double on_ramp) {
    if (link.ramp > 0) {
        part = link.cohesive > 0 ? std::clamp(on_ramp / link.cohesive, 0.0, 1.0) : 0;
        bearing = bearing_of(part + (part > 0.5 ? found_at : -found_at));
    }
    const double p = link.normal.dot(impulse) + cohesive_impulse(link), v_T = link.tangent().dot(velocity),
                 P_T = link.tangent().dot(impulse);
    const bool presses = p > scales.impulse_tolerance;
    if (link.pressed) set_line(link, link.pressed.line_at(p));
    int nearest = 0;
    double smallest = infinity;
    for (int i = 0; i < law.staircase(presses).n_states(); ++i) {
        const StaircasePiece at = law.staircase(presses).piece(i);
        const double off = at.stick ? std::abs(v_T - at.kink) : std::max({at.low - v_T, v_T - at.high, 0.0});
        const double force = P_T + part * at.offset + at.line_offset + at.contact_offset * (presses ? p : 0),
                     jump = part * at.jump + at.line_jump + at.contact_jump * (presses ? p : 0);
        double distance = std::max(off / scales.speed, std::max(std::abs(force) - jump, 0.0) / scales.impulse);
        if (!at.stick) distance = std::max(distance, found_at);
        if (distance < smallest) smallest = distance, nearest = i;
    }
    set(presses, nearest);
}

Vec2 LinkState::target(const FanLink& link) const {
    if (link.unbreakable) return Vec2::Zero();
    return link.vector(law.contact.rate, tangential.kink);
}

Vec2 LinkState::known_impulse(const FanLink& link) const {
    if (bearing == Bearing::full) return link.vector(-link.cohesive, -(tangential.offset + tangential.line_offset));
    return tangential.line_offset == 0 ? Vec2(Vec2::Zero()) : link.vector(0, -tangential.line_offset);
}

double LinkState::friction_part(double p, double P_T) const {
    const double friction = -tangential.contact_offset * p - tangential.line_offset;  // of the signs that are known
    if (!tangential.stick || (tangential.contact_jump == 0 && tangential.line_jump == 0)) return friction;
    // at rest both may jump: cohesion bears as much as it can, friction the rest
    const TangentialRange range = this->range();
    const double lambda = P_T + range.offset + range.line_offset + range.contact_offset * p;
    return friction + lambda - std::clamp(lambda, -range.jump, range.jump);
}

void follow(const StateChange& change, const FanLink& link, LinkState& state) {
    if (link.pressed) state.set_line(link, change.line);
    state.set(change.closed, change.tangential_state);
    state.bearing = change.bearing;
}

StateChange change_of(const LinkState& state, const FanLink& link, const Vec2& velocity, const Vec2& impulse,
                      const FanScales& scales) {
    const ContactBound& contact = state.law.contact;
    const StaircasePiece& tangential = state.tangential;
    const double v_N = link.normal.dot(velocity), v_T = link.tangent().dot(velocity);
    const double p = state.closed ? link.normal.dot(impulse) + state.cohesive_impulse(link) : 0;
    StateChange change{.closed = state.closed,
                       .tangential_state = state.tangential_state,
                       .bearing = state.bearing,
                       .line = state.line};
    const auto violates = [&](double amount, double tolerance, double unit) {
        if (amount <= tolerance) return false;
        change.violation = std::max(change.violation, amount / unit);
        return true;
    };
    const auto too_fast = [&](double excess, int slack = 1) {
        return violates(excess, slack * scales.speed_tolerance, scales.speed);
    };
    const auto too_strong = [&](double excess) { return violates(excess, scales.impulse_tolerance, scales.impulse); };

    if (tangential.stick) {
        const TangentialRange range = state.range();
        const double q = link.tangent().dot(impulse) + range.offset + range.line_offset + range.contact_offset * p;
        const double bound = range.jump + range.line_jump + range.contact_jump * std::max(p, 0.0);
        if (too_strong(std::abs(q) - bound)) change.tangential_state += q > 0 ? -1 : 1;
        // its cluster may already fix its slip elsewhere than at the kink
        if (!state.closed && too_fast(std::abs(v_T - tangential.kink), 10))
            change.tangential_state = state.state_of(false, v_T, 0);
    } else if (too_fast(tangential.low - v_T) || too_fast(v_T - tangential.high)) {
        if (state.closed && state.slip_follows_normal)  // no kink on the way could hold it
            change.tangential_state = state.state_of(true, v_T, scales.speed_tolerance);
        else change.tangential_state += v_T < tangential.low ? -1 : 1;
    }

    if (state.closed && too_strong(-p)) {  // pulled apart
        const int step = change.tangential_state - state.tangential_state;
        const bool stays_at_kink = tangential.stick && step == 0;
        const double at = tangential.stick ? tangential.kink + step * 2 * scales.speed_tolerance : v_T;
        change.closed = false;
        change.tangential_state = state.state_of(false, at, stays_at_kink ? scales.speed_tolerance : 0);
    } else if (!state.closed && contact.may_touch && too_fast(contact.rate - v_N)) {
        change.closed = true;
        change.tangential_state = state.state_of(true, v_T, scales.speed_tolerance);
    } else if (state.closed && too_fast(v_N - contact.rate, 10)) {
        change.closed = false;
        change.tangential_state = state.state_of(false, v_T, scales.speed_tolerance);
    } else if (state.closed) {
        change.irreparable = (contact.rate - v_N) / scales.speed;
    }
    if (link.pressed && state.closed) {
        const FrictionLine line = link.pressed.line(state.line);
        if (too_strong(line.offset + line.slope * p - link.pressed(p))) change.line = link.pressed.line_at(p);
    }
    if (link.ramp > 0 && !state.sticks()) {
        const double at = link.ramp_part(velocity);
        if (state.bearing == Bearing::full && too_fast((1 - at) * link.ramp)) change.bearing = Bearing::part;
        if (state.bearing == Bearing::none && too_fast(at * link.ramp)) change.bearing = Bearing::part;
        // its clusters may already fix its velocity elsewhere than on the ramp
        if (state.bearing == Bearing::part && too_fast(std::abs(at - state.part) * link.ramp, 10))
            change.bearing = bearing_of(at);
        if (state.bearing == Bearing::part && too_strong((state.part - 1) * link.cohesive))
            change.bearing = Bearing::full;
        if (state.bearing == Bearing::part && too_strong(-state.part * link.cohesive)) change.bearing = Bearing::none;
    }
    return change;
}

}  // namespace knap
