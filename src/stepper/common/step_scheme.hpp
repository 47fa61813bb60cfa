#pragma once
// The seam between the stepper and its schemes.
#include "model/state.hpp"
#include "stepper/common/step_report.hpp"

namespace knap {

/// Of the matrix of an implicit step, as it is factorised now.
struct FactorSize {
    std::int64_t unknowns = 0, entries = 0;  // entries: of the triangular factor
};

/// Asked now and then within a long step: whether it shall be given up.
using GiveUp = bool (*)();

/// Thrown by a step that is given up; the state at its begin stands.
struct StepGivenUp {};

class StepScheme {
public:
    virtual ~StepScheme() = default;

    /// From `begin` over h [s] to everything in `end` but its times; or a rejection, and `end` is void.
    virtual StepReport step(const State& begin, double h, State& end) = 0;
    virtual double stable_step() const = 0;  // [s]
    virtual FactorSize factor_size() const { return {}; }
    virtual void give_up_when(GiveUp) {}  // a scheme whose steps are short need not ask
};

}  // namespace knap
