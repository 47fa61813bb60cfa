#pragma once
// The energy books of a run (formulation: energy ledger).
//
//     kinetic + strain - (start) = external - cohesive + impact + friction - (dissipation of theta > 1/2)      to rounding: the identity of the discrete scheme
//     law lag = cohesive work - crossing loss - (Psi of the state)              what the steps make of the law; falls with h
//     Psi = dissipated + recoverable                                            G_c f(beta), and beta sigma_c s
//     crossing loss: a slip that crosses zero is caught by the implicit sign of the tangential cohesion, which takes a little of its
//     kinetic energy; high-frequency slips die by it
//
// Kinetic and strain energy of the explicit bulk are those of the leapfrog: 1/2 v' M v at the middle of the step, 1/2 u_n' K u_{n+1}; those
// of the implicit bulk are at the end of the step. The books begin with the energy of the start, be it of motion or of a preload, and with no work.
#include "model/state.hpp"
#include "stepper/common/scheme_options.hpp"
#include "stepper/common/step_report.hpp"

#include <algorithm>

namespace knap {

/// Energies and cumulated works [J].
struct EnergyRow {
    double time = 0;
    double kinetic = 0, strain = 0;
    double dissipated = 0, recoverable = 0;  // of the interfaces: G_c f(beta), which stays, and beta sigma_c s, which closing gives back
    double external_work = 0, cohesive_work = 0, friction_work = 0, impact_work = 0, step_change_work = 0;
    double scheme_dissipation = 0;  // by theta > 1/2
    double residual = 0;  // of the identity
    double crossing_loss = 0;  // of the cohesive work, where slips cross zero
    double law_lag = 0;

    double surface() const { return dissipated + recoverable; }  // Psi

    template <class Archive>
    void serialize(Archive& archive) {
        archive(time, kinetic, strain, dissipated, recoverable, external_work, cohesive_work, friction_work, impact_work, step_change_work, scheme_dissipation, residual,
                crossing_loss, law_lag);
    }
};

class EnergyLedger {
public:
    /// `mass`: the one whose kinetic energy the reports have.
    /// `weakest_point` [J]: what the weakest point takes to break.
    EnergyLedger(const Model& model, const State& start, MassMatrix mass = MassMatrix::lumped, double weakest_point = 0);

    void add(const State& end, const StepReport& report);

    const EnergyRow& row() const { return row_; }
    const StepReport& worst() const { return worst_; }  // extremes and counts over all steps
    double largest_energy() const { return largest_energy_; }
    double largest_residual() const { return largest_residual_; }  // [J] over all steps
    /// [J] What losses are measured against: the dissipated energy; the largest recoverable one where that is more, since points that begin to soften have
    /// dissipated next to nothing; and at least this part of the largest energy, and what a millionth of the weakest point takes: less is rounding.
    double dissipation_scale(double least = 1e-6) const { return std::max({row_.dissipated, largest_recoverable_, least * largest_energy_, 1e-6 * weakest_point_}); }
    /// A loss [J] over that scale; 0 where nothing was dissipated.
    double over_dissipated(double loss, double least = 1e-6) const {
        const double scale = dissipation_scale(least);
        return scale > 0 ? loss / scale : 0;
    }
    /// The law lag over that scale, signed: positive where the interfaces took more than their law asks for. Of the explicit bulk in the middle of the last step, where the
    /// works belong. Now; and the largest of all steps, where less than a hundredth of the largest energy counts as that: no alarm about the first points.
    double law_lag() const { return law_lag_; }
    double largest_law_lag() const { return largest_law_lag_; }

    double given() const { return given_; }                        // [J] the energy of the start and all that loads and prescribed motions have put in since
    std::int64_t n_steps() const { return n_steps_; }
    double smallest_mass() const { return smallest_mass_; }        // [kg] of the parts that triangles give their corners

    template <class Archive>
    void serialize(Archive& archive) {
        archive(start_energy_, largest_energy_, largest_recoverable_, largest_residual_, law_lag_, largest_law_lag_, given_, n_steps_, row_, worst_);
    }

private:
    double start_energy_, largest_energy_, largest_recoverable_ = 0, largest_residual_ = 0, given_ = 0, smallest_mass_, weakest_point_;
    double law_lag_ = 0, largest_law_lag_ = 0;
    std::int64_t n_steps_ = 0;
    EnergyRow row_;
    StepReport worst_;
};

}  // namespace knap
