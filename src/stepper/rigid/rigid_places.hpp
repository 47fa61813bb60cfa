#pragma once
// When contacts of rigid pieces strike within a step, and corrections of the places of what overlaps.
//
// A contact whose faces are apart and rebound (e > 0) is struck within the step, when its gap closes, tau after its
// start. A body moves freely until the first of its strikes, x+ = x + tau v_free + (h - tau) v+ (v_free = v- where
// something bears it), and its impulses act at the place where it is then. With the acceleration a of the contact by
// loads, zero where something bears the body, the velocities before and after it are
//
//     V_- = V- + k/2 a + s a,     V_+ = V+ - k/2 a + s a,     s = tau + (k - h)/2,     k = (h- + h)/2, h-: step before
//
// and the law is one of these, so that a flight, its impact and the next flight are exact. Their mean (V- + V+)/2 + s a
// works, and the loads work over k (v- + v+)/2 + s (v_free - v+).
#include "law/interface_law.hpp"
#include "stepper/rigid/rigid_row.hpp"

namespace knap {

/// Finds which rows strike, and when their bodies are struck; their terms are those of that moment.
void find_strikes(const RigidStep& step, std::vector<RigidRow>& rows, std::vector<MovingBody>& bodies);
/// As contact_law(), of the velocities before and after the strike.
InterfaceLaw law_of_strike(const RigidRow& row, const RigidStep& step, const std::vector<MovingBody>& bodies,
                           double tolerance);
/// [m] By which it overlaps at the end of the step.
double depth_at_end(const RigidRow& row, const RigidStep& step, const std::vector<MovingBody>& bodies);
/// Shifts what overlaps; couples between the pieces keep their angular momentum.
void correct_places(const RigidStep& step, const std::vector<RigidRow>& rows, std::vector<MovingBody>& bodies);

}  // namespace knap
