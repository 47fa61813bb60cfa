#pragma once
// One step of the Moreau-Jean time stepping scheme for nonsmooth dynamics with extrinsic cohesive interfaces
// (Acary, Collins-Craft, Bourrier; J. J. Moreau 1988, M. Jean 1999):
//
//     M (v+ - v) = h (F - K u)_theta + H' P,     u+ = u + h v_theta,     the interface laws at the end of the step,
//     impulses P unknown
//
// Two schemes do it: explicit_scheme.hpp (lumped mass, forces at the begin of the step: each vertex by itself) and
// implicit_scheme.hpp (all interfaces and the stiffness together); each with the cohesion frozen over the step or
// implicit.
#include "stepper/common/scheme_options.hpp"
#include "stepper/common/step_scheme.hpp"

#include <memory>

namespace knap {

class MoreauJean {
public:
    explicit MoreauJean(const Model& model, const SchemeOptions& options = {});

    /// One step of size h [s] from `begin` to `end`; `begin` is left alone. `end` may be any earlier state of the same
    /// run (its memory is reused). A rejected step (report.rejection) leaves `end` void. Throws SimulationError where
    /// the motion is no longer finite.
    StepReport step(const State& begin, double h, State& end);

    /// Static equilibrium under the loads at start.time, before the first step (static_preload.hpp).
    /// Throws SimulationError where there is none that the interfaces and supports can hold.
    void start_in_equilibrium(State& start) const;

    /// Lets a long step end early, by StepGivenUp. Without it every step is carried through.
    void give_up_when(GiveUp asked) { scheme_->give_up_when(asked); }

    double stable_step() const { return scheme_->stable_step(); }      // [s]; infinite for the implicit bulk
    FactorSize factor_size() const { return scheme_->factor_size(); }  // of the implicit bulk

private:
    const Model& model_;
    SchemeOptions options_;
    std::unique_ptr<StepScheme> scheme_;
};

}  // namespace knap
