#include "interface/link_state.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace knap {
namespace {

constexpr double found_at = 1e-9;  // of speed and impulse: within this distance of a kink a link is at it

}  // namespace

InterfaceLaw law_of(const FanLink& link, const Vec2& velocity_before, double h, double tolerance) {
    const double V_N = link.normal.dot(velocity_before), V_T = link.tangent().dot(velocity_before);
    const Staircase::Kink zero_crossing{.rate = -link.u_T / h, .cohesive = link.gamma * link.cohesive, .friction = 0};
    Staircase open, closed;
    open.add(zero_crossing, tolerance);
    // rest comes first: where kinks are merged, it is exact rest that remains
    closed.add({.rate = 0, .cohesive = 0, .friction = 0.5 * link.friction}, tolerance);
    closed.add({.rate = -V_T, .cohesive = 0, .friction = 0.5 * link.friction}, tolerance);
    closed.add(zero_crossing, tolerance);
    return {contact_bound_explicit(link.u_N, V_N, link.restitution, h, tolerance * h), open, closed};
}

void LinkState::set(bool to_closed, int to_tangential_state) {
    closed = to_closed;
    tangential_state = to_tangential_state;
    tangential = law.staircase(closed).piece(tangential_state);
}

void LinkState::guess(const FanProblem& problem, const FanLink& link, const FanScales& scales) {
    imposed = led = false;
    if (link.unbreakable) {
        closed = true;
        tangential = {.stick = true, .kink = 0, .low = 0, .high = 0};
        return;
    }
    const Vec2 relative = problem.velocity_before(link.after) - problem.velocity_before(link.before);
    law = law_of(link, relative, problem.drift_time, scales.rest);
    // what is prescribed on both sides is known beforehand, all else is guessed to go on as before
    const auto prescribed = [&](Index body, int k) { return body < 0 || problem.bodies[body].inverse_mass[k] == 0; };
    Vec2 expected = relative;
    int n_imposed = 0;
    for (int k = 0; k < 2; ++k) {
        if (!prescribed(link.before, k) || !prescribed(link.after, k)) continue;
        expected[k] = problem.free_velocity(link.after)[k] - problem.free_velocity(link.before)[k];
        ++n_imposed;
    }
    imposed = n_imposed == 2, led = n_imposed == 1;
    const bool touches = law.may_touch() && link.normal.dot(expected) <= law.bound() + scales.speed_tolerance;
    set(touches, state_of(touches, link.tangent().dot(expected), scales.speed_tolerance));
}

void LinkState::fit(const FanLink& link, const Vec2& velocity, const Vec2& impulse, const FanScales& scales) {
    const double p = link.normal.dot(impulse) + link.cohesive, v_T = link.tangent().dot(velocity), P_T = link.tangent().dot(impulse);
    const bool presses = p > scales.impulse_tolerance;
    int nearest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < law.staircase(presses).n_states(); ++i) {
        const StaircasePiece at = law.staircase(presses).piece(i);
        const double off = at.stick ? std::abs(v_T - at.kink) : std::max({at.low - v_T, v_T - at.high, 0.0});
        const double force = P_T + at.offset + at.contact_offset * (presses ? p : 0), jump = at.jump + at.contact_jump * (presses ? p : 0);
        const double distance = std::max(off / scales.speed, std::max(std::abs(force) - jump, 0.0) / scales.impulse);
        const double counted = at.stick ? distance : std::max(distance, found_at);
        if (counted < least) least = counted, nearest = i;
    }
    set(presses, nearest);
}

Vec2 LinkState::target(const FanLink& link) const {
    if (link.unbreakable) return Vec2::Zero();
    return link.vector(law.bound(), tangential.kink);
}

Vec2 LinkState::known_impulse(const FanLink& link) const { return link.vector(-link.cohesive, -tangential.offset); }

double LinkState::friction_part(const FanLink& link) const {
    if (link.unbreakable) return 0;
    const double friction = -tangential.contact_offset * link.contact;  // of the signs that are known
    if (!tangential.stick || tangential.contact_jump == 0) return friction;
    // at rest both may jump: cohesion takes what it can, friction the rest
    const double lambda = link.tangential + tangential.offset + tangential.contact_offset * link.contact;
    return friction + lambda - std::clamp(lambda, -tangential.jump, tangential.jump);
}

StateChange change_of(const LinkState& state, const FanLink& link, const Vec2& velocity, const Vec2& impulse, const FanScales& scales) {
    const InterfaceLaw& law = state.law;
    const StaircasePiece& tangential = state.tangential;
    const double v_N = link.normal.dot(velocity), v_T = link.tangent().dot(velocity);
    const double p = state.closed ? link.normal.dot(impulse) + link.cohesive : 0;
    StateChange change{.closed = state.closed, .tangential_state = state.tangential_state};
    const auto violates = [&](double amount, double tolerance, double unit) {
        if (amount <= tolerance) return false;
        change.violation = std::max(change.violation, amount / unit);
        return true;
    };
    const auto too_fast = [&](double excess, int slack = 1) { return violates(excess, slack * scales.speed_tolerance, scales.speed); };
    const auto too_strong = [&](double excess) { return violates(excess, scales.impulse_tolerance, scales.impulse); };

    if (tangential.stick) {
        const double q = link.tangent().dot(impulse) + tangential.offset + tangential.contact_offset * p;
        const double most = tangential.jump + tangential.contact_jump * std::max(p, 0.0);
        if (too_strong(std::abs(q) - most)) change.tangential_state += q > 0 ? -1 : 1;
        // what its cluster holds already may hold it elsewhere than at the kink
        if (!state.closed && too_fast(std::abs(v_T - tangential.kink), 10)) change.tangential_state = state.state_of(false, v_T, 0);
    } else if (too_fast(tangential.low - v_T) || too_fast(v_T - tangential.high)) {
        if (state.closed && state.led) change.tangential_state = state.state_of(true, v_T, scales.speed_tolerance);  // no kink on the way could hold it
        else change.tangential_state += v_T < tangential.low ? -1 : 1;
    }

    if (state.closed && too_strong(-p)) {  // pulled apart
        const int step = change.tangential_state - state.tangential_state;
        const bool stays_at_kink = tangential.stick && step == 0;
        const double at = tangential.stick ? tangential.kink + step * 2 * scales.speed_tolerance : v_T;
        change.closed = false;
        change.tangential_state = state.state_of(false, at, stays_at_kink ? scales.speed_tolerance : 0);
    } else if (!state.closed && law.may_touch() && too_fast(law.bound() - v_N)) {
        change.closed = true;
        change.tangential_state = state.state_of(true, v_T, scales.speed_tolerance);
    } else if (state.closed && too_fast(v_N - law.bound(), 10)) {
        change.closed = false;
        change.tangential_state = state.state_of(false, v_T, scales.speed_tolerance);
    } else if (state.closed) {
        change.unmended = (law.bound() - v_N) / scales.speed;
    }
    return change;
}

}  // namespace knap
