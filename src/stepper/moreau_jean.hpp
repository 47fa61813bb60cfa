#pragma once
// One step of the Moreau-Jean time stepping scheme for nonsmooth dynamics with extrinsic cohesive interfaces
// (Acary, Collins-Craft, Bourrier; J. J. Moreau 1988, M. Jean 1999):
//
//     M (v+ - v) = k (F - K u) + H' P,     u+ = u + h v+,     the interface laws at the end of the step, impulses P unknown
//
// The bulk (here explicit and lumped) and the scheme of the interfaces (here explicit beta) are its two strategies.
#include "stepper/explicit_bulk.hpp"
#include "stepper/interface_scheme.hpp"
#include "stepper/scheme_options.hpp"

#include <memory>

namespace knap {

class MoreauJean {
public:
    explicit MoreauJean(const Model& model, const SchemeOptions& options = {});

    /// One step of size h [s] from `begin` to `end`; `begin` is left alone. `end` may be any earlier state of the same run (its memory
    /// is reused). Throws SimulationError where the motion is no longer finite.
    StepReport step(const State& begin, double h, State& end);

    double stable_step() const { return bulk_.stable_step(); }  // [s]

private:
    ExplicitBulk bulk_;
    std::unique_ptr<InterfaceScheme> interfaces_;
    FreeMotion free_;
};

}  // namespace knap
