#pragma once
// The interface between the stepper and its schemes.
#include "model/state.hpp"
#include "stepper/common/step_report.hpp"

namespace knap {

/// Of the present matrix of an implicit step.
struct FactorSize {
    std::int64_t unknowns = 0, entries = 0;  // entries: of the triangular factor
};

/// Called now and then within a long step: true gives the step up.
using GiveUp = bool (*)();

/// Thrown by a step that is given up; the state at its start is unchanged.
struct StepGivenUp {};

class StepScheme {
public:
    virtual ~StepScheme() = default;

    /// From `begin` over h [s] to everything in `end` but its times. After a rejection `end` is void.
    virtual StepReport step(const State& begin, double h, State& end) = 0;
    virtual double stable_step() const = 0;  // [s]
    virtual FactorSize factor_size() const { return {}; }
    virtual void give_up_when(GiveUp) {}  // ignored by a scheme with short steps
};

}  // namespace knap
