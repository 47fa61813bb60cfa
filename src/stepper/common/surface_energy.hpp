#pragma once
// What the interfaces of a state have consumed and store.
#include "model/state.hpp"
#include "stepper/common/step_report.hpp"

#include <functional>

namespace knap {

/// A report with `dissipated`, `recoverable` and `interface_elastic` [J] of a state between two steps.
StepReport surface_energy(const Model& model, const State& state);
/// [-] Part of its fracture energy that a point has taken until its opening, with what it would give back: 0 intact, 1
/// broken or never joined.
double taken_part(const Model& model, const State& state, const FanPoint& point);
/// [J] Dissipated from one state to a later one, by the points at corners that count.
double dissipated_since(const Model& model, const State& before, const State& after,
                        const std::function<bool(Index corner)>& counts);

}  // namespace knap
