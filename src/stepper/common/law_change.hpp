#pragma once
// What the energy of interfaces changes by when their laws follow a change of the temperature, phi -> phi + dphi, while
// openings and cohesion stand:
//
//     law change = dphi (beta sigma_c s) S     of what closing gives back. No force does work, so no other energy term
//                                              contains it.
//
// What was dissipated stays dissipated: a crack has consumed the G_c of the time at which it opened.
#include "model/state.hpp"
#include "stepper/common/step_report.hpp"

namespace knap {

/// Books the change of the laws from begin.temperature_before to begin.temperature, at the openings where the works of
/// the step before end: with the explicit bulk in its middle.
void account_law_change(const Model& model, const State& begin, StepReport& report);

}  // namespace knap
