#pragma once
// Incubated strength (after Yu. V. Petrov, N. F. Morozov, J. Appl. Mech. 61, 1994, 710): a bond breaks only after an
// overload of some duration. Per bonded fan
//
//     dq/dt = (U - q)/tau,      q = 0 at the start, q = U of a start in equilibrium
//
// with the utilisation U of its interfaces (BondCheck): the factor on all their strengths with which they just hold.
// A fan splits when U > 1 and q >= 1. Until then it is held, by a constraint that does no work. Its points then have
// the strength phi sigma_c and the fracture energy phi G_c with phi = U of that moment, so that their tractions are
// continuous. Under U = R t/tau, phi - R (1 - exp(-phi/R)) = 1.
//
// tau is the smallest of the laws of a fan. A fan with a support or an initial crack, or with an interface that has no
// incubation time or no strength, has none. A fan that an obstacle or another face touches splits by its static
// strength, with phi = max(1, the last U).
#include "model/state.hpp"

namespace knap {

class IncubationClock {
public:
    explicit IncubationClock(const Model& model);

    bool is_empty() const { return time_.empty(); }
    bool concerns(Index fan) const { return !time_.empty() && time_[fan] > 0; }
    /// Bonded fans whose U was found too long ago become candidates. The stress criterion knows only U < 1; between
    /// two values U is taken to be linear, twenty of them in tau.
    void mark_due_fans(const State& begin, std::vector<std::uint8_t>& is_candidate) const;
    /// Whether a fan with the utilisation U now holds; `memory` is that of the last time.
    bool is_held(Index fan, double U, double now, Incubation& memory) const;

private:
    std::vector<double> time_;  // [s] tau per fan, 0: none; empty: no fan has one
};

}  // namespace knap
