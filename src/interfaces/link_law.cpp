#include "interfaces/link_law.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace knap {

void LinkLaw::Side::add(const Kink& kink, double tolerance) {
    if (kink.cohesive == 0 && kink.contact == 0) return;
    int place = 0;
    for (; place < n_kinks && kinks[place].velocity <= kink.velocity + tolerance; ++place) {
        if (kinks[place].velocity < kink.velocity - tolerance) continue;
        kinks[place].cohesive += kink.cohesive;
        kinks[place].contact += kink.contact;
        return;
    }
    for (int i = n_kinks; i > place; --i) kinks[i] = kinks[i - 1];
    kinks[place] = kink;
    ++n_kinks;
}

LinkLaw::LinkLaw(const FanLink& link, const Vec2& velocity_before, double drift_time, double tolerance) {
    const double v_N = link.normal.dot(velocity_before), v_T = turned_left(link.normal).dot(velocity_before);
    const Kink zero_crossing{.velocity = -link.u_T / drift_time, .cohesive = link.gamma * link.cohesive, .contact = 0};
    open_.add(zero_crossing, tolerance);
    // rest comes first: where kinks are merged, it is exact rest that remains
    closed_.add({.velocity = 0, .cohesive = 0, .contact = 0.5 * link.friction}, tolerance);
    closed_.add({.velocity = -v_T, .cohesive = 0, .contact = 0.5 * link.friction}, tolerance);
    closed_.add(zero_crossing, tolerance);

    // touching: Newton's law against an approach. apart: without restitution the end of the step is the wall (no penetration); with it,
    // it must touch first. Either way what separates may at most be thrown back at its own speed, so that its work stays <= 0.
    if (link.u_N <= tolerance * drift_time) {
        may_touch_ = true;
        bound_ = v_N <= 0 ? -link.restitution * v_N : -v_N;
    } else {
        may_touch_ = link.restitution == 0;
        bound_ = -std::max(link.u_N / drift_time, v_N);
    }
}

TangentialLaw LinkLaw::tangential(bool closed, int state) const {
    const Side& s = side(closed);
    const bool stick = state % 2 == 1;
    const int here = state / 2;  // the kink, or the number of kinks below
    TangentialLaw law{.stick = stick,
                      .velocity = stick ? s.kinks[here].velocity : 0,
                      .low = here > 0 ? s.kinks[here - 1].velocity : -std::numeric_limits<double>::infinity(),
                      .high = here < s.n_kinks ? s.kinks[here].velocity : std::numeric_limits<double>::infinity()};
    for (int i = 0; i < s.n_kinks; ++i) {
        if (stick && i == here) {
            law.play = s.kinks[i].cohesive;
            law.contact_play = s.kinks[i].contact;
            continue;
        }
        const double sign = i < here ? 1 : -1;
        law.at += sign * s.kinks[i].cohesive;
        law.contact += sign * s.kinks[i].contact;
    }
    return law;
}

int LinkLaw::state_of(bool closed, double v_T, double tolerance) const {
    const Side& s = side(closed);
    int state = 0;
    for (int i = 0; i < s.n_kinks; ++i) {
        if (std::abs(v_T - s.kinks[i].velocity) <= tolerance) return 2 * i + 1;
        if (v_T > s.kinks[i].velocity) state = 2 * i + 2;
    }
    return state;
}

}  // namespace knap
