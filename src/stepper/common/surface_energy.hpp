#pragma once
// What the interfaces of a state have consumed and store.
#include "model/state.hpp"
#include "stepper/common/step_report.hpp"

namespace knap {

/// A report with `dissipated`, `recoverable` and `interface_elastic` [J] of a state between two steps.
StepReport surface_energy(const Model& model, const State& state);

}  // namespace knap
