#pragma once
// How the interfaces answer the free motion of the bulk: the seam between the stepper and its schemes (explicit beta here; the implicit
// LCP is another implementation of the same interface).
#include "model/state.hpp"
#include "stepper/free_motion.hpp"
#include "stepper/step_report.hpp"

namespace knap {

class InterfaceScheme {
public:
    virtual ~InterfaceScheme() = default;

    /// From the state at the begin of the step and the free motion: velocities, displacements, cohesion and the partition at its end.
    /// `end` may be any earlier state of the same run; its time is not touched. Loads on corners are accounted by the bulk.
    virtual StepReport advance(const State& begin, const FreeMotion& free, State& end) = 0;
};

}  // namespace knap
