#include "law/interface_law.hpp"

#include <algorithm>
#include <cmath>

namespace knap {

ContactBound contact_bound_explicit(double u_N, double V_N, double restitution, double h, double touching,
                                    double given) {
    if (u_N <= touching) {
        const double rate = V_N <= 0 ? -restitution * V_N : -V_N;
        return {true, given > 0 ? std::min(rate, -given) : rate};
    }
    return {restitution == 0, -std::max(u_N / h, V_N)};
}

ContactBound contact_bound_theta(double u_N, double V_N, double restitution, double h, double theta, double touching) {
    const double approach = std::max(-V_N, 0.0);
    if (u_N <= touching) return {true, -(1 - theta * (1 + restitution)) * approach};
    if (restitution > 0) return {};
    return {true, std::min(-u_N / h, -(1 - theta) * approach)};
}

void Staircase::add(const Kink& kink, double tolerance) {
    if (kink.cohesive == 0 && kink.friction == 0) return;
    int place = 0;
    for (; place < n_kinks_ && kinks_[place].rate <= kink.rate + tolerance; ++place) {
        if (kinks_[place].rate < kink.rate - tolerance) continue;
        kinks_[place].cohesive += kink.cohesive;
        kinks_[place].friction += kink.friction;
        return;
    }
    for (int i = n_kinks_; i > place; --i) kinks_[i] = kinks_[i - 1];
    kinks_[place] = kink;
    ++n_kinks_;
}

double Staircase::impulse(double p, double free, double mobility) const {
    const auto at = [&](const StaircasePiece& in, double sign) {
        return -(in.offset + sign * in.jump) - (in.line_offset + sign * in.line_jump) -
               (in.contact_offset + sign * in.contact_jump) * p;
    };
    if (mobility <= 0) return at(piece(state_of(free, 0)), 0);
    for (int state = 0; state < n_states(); ++state) {
        const StaircasePiece at_state = piece(state);
        const double least = at(at_state, 1), most = at(at_state, -1);
        if (!at_state.stick) {
            const double rate = free + mobility * most;
            if (rate <= at_state.high)
                return rate >= at_state.low ? most : std::max(most, (at_state.low - free) / mobility);
        } else {
            const double needed = (at_state.kink - free) / mobility;
            if (needed >= least) return std::min(needed, most);
        }
    }
    return 0;
}

void add_friction_explicit(double friction, double V_T, double tolerance, Staircase& staircase, double kept) {
    // rest comes first: where kinks are merged, exact rest remains
    for (const double rate : {kept * V_T, -V_T})
        staircase.add({.rate = rate, .cohesive = 0, .friction = 0.5 * friction}, tolerance);
}

void add_friction_theta(double friction, Staircase& staircase) {
    staircase.add({.rate = 0, .cohesive = 0, .friction = friction}, 0);
}

}  // namespace knap
