#pragma once
// The energy books of a run (formulation: energy ledger).
//
//     kinetic + strain - (start) = external - cohesive + impact + friction - (dissipation of theta > 1/2)      to rounding: the identity of the discrete scheme
//     law lag = cohesive work - crossing loss - (Psi of the state)              what freezing beta costs; falls with h
//     crossing loss: a slip that crosses zero is caught by the implicit sign of the tangential cohesion, which takes a little of its
//     kinetic energy; high-frequency slips die by it
//
// Kinetic and strain energy of the explicit bulk are those of the leapfrog: 1/2 v' M v at the middle of the step, 1/2 u_n' K u_{n+1}; those
// of the implicit bulk are at the end of the step. The books begin with the energy of the start, be it of motion or of a preload, and with no work.
#include "model/state.hpp"
#include "stepper/scheme_options.hpp"
#include "stepper/step_report.hpp"

namespace knap {

/// Energies and cumulated works [J].
struct EnergyRow {
    double time = 0;
    double kinetic = 0, strain = 0, surface = 0;
    double external_work = 0, cohesive_work = 0, friction_work = 0, impact_work = 0, step_change_work = 0;
    double scheme_dissipation = 0;  // by theta > 1/2
    double residual = 0;  // of the identity
    double crossing_loss = 0;  // of the cohesive work, where slips cross zero
    double law_lag = 0;

    template <class Archive>
    void serialize(Archive& archive) {
        archive(time, kinetic, strain, surface, external_work, cohesive_work, friction_work, impact_work, step_change_work, scheme_dissipation, residual,
                crossing_loss, law_lag);
    }
};

class EnergyLedger {
public:
    /// `mass`: the one whose kinetic energy the reports have.
    EnergyLedger(const Model& model, const State& start, MassMatrix mass = MassMatrix::lumped);

    void add(const State& end, const StepReport& report);

    const EnergyRow& row() const { return row_; }
    const StepReport& worst() const { return worst_; }  // extremes and counts over all steps
    double largest_energy() const { return largest_energy_; }
    double largest_residual() const { return largest_residual_; }  // [J] over all steps
    double largest_law_lag() const { return largest_law_lag_; }    // [J] over all steps

    double mass() const { return mass_; }  // [kg] of the body

    template <class Archive>
    void serialize(Archive& archive) { archive(start_energy_, largest_energy_, largest_residual_, largest_law_lag_, mass_, row_, worst_); }

private:
    double start_energy_, largest_energy_, largest_residual_ = 0, largest_law_lag_ = 0, mass_;
    EnergyRow row_;
    StepReport worst_;
};

}  // namespace knap
