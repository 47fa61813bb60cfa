#pragma once
// The energy balance of a run.
//
//     residual        kinetic + strain - (both at the start) - works: zero to rounding, the energy identity of the
//                     discrete scheme. Works: external - cohesive + friction + impact + step change + rotation +
//                     damping + bulk viscosity + radiated + excavation + thermal work + adaptation + assumptions +
//                     vibration booked + sleep work - excavated energy - scheme dissipation
//     rotation work   large rotations: the trapezoidal defect of the elastic energy U, which is not quadratic,
//                     tau = U_n - U_n-1 + 1/2 (f_n-1 + f_n) . (u_n - u_n-1),  f = -grad U; O(h^3) a step. Its sum stays
//                     bounded (central differences are symplectic) and is of second order in h; zero where rotations
//                     are small, or a strained body turns rigidly
//     adaptation      change of the energy by refinements of the mesh
//     assumptions     change of the elastic energy of the same displacements, where a run goes on from another one with
//                     large instead of small rotations, or without heat; kinetic energy of obstacles that it adds
//     surface energy  Psi = dissipated + recoverable = sum over points of S (G_c f(beta) + beta sigma_c s); with secant
//                     unloading dissipated + interface_elastic = S (G_c f + beta sigma_c (kappa + s^2/kappa)/2)
//     thermal work    of thermal strains e that change, -int sigma : de (src/heat/README.md has the stresses); the
//                     elastic energy is that of eps - e. Stored heat has a balance of its own: heat = heat in
//     law change      of recoverable and elastic energy, where strengths follow the temperature (law_change.hpp); no
//                     term of the first balance. `dissipated` has the G_c of the time at which it was dissipated
//     bulk viscosity  work of its forces, trapezoidal over each step (element/bulk_viscosity.hpp); the strain energy of
//                     the explicit bulk has -1/2 f . (u_{n+1} - u_n) of them, which the next step dissipates
//     cohesive        part of the friction work that acts on the pressure by which contact balances the cohesion, so
//     friction        also without any pressure between the sides: with p_c = beta sigma_c the part min(1, p_c/p) of
//                     the friction mu p of the contact pressure p. Sliding alone costs it mu G_c/gamma
//     crossing loss   part of the cohesive work that is stored nowhere: where a slip crosses zero within a step, the
//                     implicit sign of the tangential cohesion takes some of its kinetic energy (slip-reversal loss);
//                     high-frequency slips are damped by it
//     vibration       kinetic energy of the vibration of pieces that become rigid ([rigid]); their elastic energy stays
//     booked
//     sleep work      kinetic energy of rigid pieces that fall asleep
//     projection      work of loads against which positions of rigid pieces are corrected where they overlap: energy of
//     work            place, no term of the balance
//     excavated       kinetic and elastic energy of the regions that vanished, and the recoverable energy of their
//                     interfaces; what these had dissipated remains in Psi
//     viscous         dissipation of delayed softening: what points bear beyond their softening curve while beta falls
//                     (a start in equilibrium may have damage: Psi at the start is no work, either)
//     law lag         cohesive work + law change - crossing loss - viscous dissipation - Psi - excavated recoverable
//                     energy: error of steps of finite size, in which the force and beta belong to different times
//                     (staggering error of beta); it decreases with the step
//
// With the explicit bulk, kinetic and strain energy are those of the leapfrog: 1/2 v' M v at the middle of the step and
// 1/2 u_n' K u_{n+1}, with large rotations U_n - 1/2 f_n . (u_{n+1} - u_n); with the implicit bulk, those at the end of
// the step. Energy present at the start, of motion or of a preload, is no work.
#include "model/state.hpp"
#include "output/outputs.hpp"
#include "stepper/adapt/adaptation.hpp"
#include "stepper/common/step_report.hpp"
#include "stepper/common/step_scheme.hpp"

#include <algorithm>
#include <array>

namespace knap {

struct ExcavationEnergies;
struct FreeMotion;

/// Energies and cumulated works [J]: one line of energy.csv.
struct EnergyRow {
    double time = 0, step = 0;  // [s] end and size of the last step
    double kinetic = 0, strain = 0;
    double dissipated = 0, recoverable = 0;  // by the interfaces; closing them gives the recoverable energy back
    double interface_elastic = 0;            // likewise, of secant unloading
    double external_work = 0, cohesive_work = 0, friction_work = 0, impact_work = 0, step_change_work = 0;
    double cohesive_friction_work = 0;  // part of friction_work that acts without contact pressure
    double rotation_work = 0, damping_work = 0, bulk_viscosity_work = 0, radiated_work = 0, excavation_work = 0;
    double excavated_energy = 0, excavated_recoverable = 0;  // that left with excavated regions
    double adaptation = 0;                                   // of refinements of the mesh: change of the energy
    double assumptions = 0;                                  // of a run that goes on with others: likewise
    double scheme_dissipation = 0;                           // by theta > 1/2
    double thermal_work = 0;                                 // of thermal strains that change
    double law_change = 0;                                   // of strengths that follow the temperature
    double viscous_dissipation = 0;                          // of delayed softening, in addition to `dissipated`
    double mixed_dissipation = 0;                            // of slip with its own fracture energy, likewise
    double vibration_booked = 0, sleep_work = 0, projection_work = 0, rigid_injection = 0, exchange_work = 0,
           thaw_dissipation = 0;   // as in StepReport
    double heat = 0, heat_in = 0;  // with conduction: stored, and what came in
    double residual = 0, crossing_loss = 0, law_lag = 0;

    double surface() const { return dissipated + recoverable + interface_elastic; }  // Psi

    void serialize(auto& archive);
};

/// Works that only some scenarios have; energy.csv of the others has no columns for them.
struct RareWorks {
    bool rotation = false, damping = false, viscosity = false, radiation = false, excavation = false,
         adaptation = false, secant = false, heat = false, conduction = false, law_change = false, delay = false,
         incubation = false, cohesive_friction = false, new_assumptions = false, rigid = false, mode_mix = false;

    static constexpr auto all() {
        using R = RareWorks;
        return std::array{&R::rotation,          &R::damping,         &R::viscosity, &R::radiation,
                          &R::excavation,        &R::adaptation,      &R::secant,    &R::heat,
                          &R::conduction,        &R::law_change,      &R::delay,     &R::incubation,
                          &R::cohesive_friction, &R::new_assumptions, &R::rigid,     &R::mode_mix};
    }
    void include(const RareWorks& other) {
        for (const auto work : all()) this->*work = this->*work || other.*work;
    }
    void serialize(auto& archive) {
        for (const auto work : all()) archive(this->*work);
    }
};

/// All that is known of a number of EnergyRow: its column of energy.csv, how the ledger sums it up, and its curve in
/// the energy figure.
struct EnergyTerm : Measure<EnergyRow> {
    struct Use {
        bool RareWorks::*with = nullptr;     // only scenarios with it have the column; null: all
        double StepReport::*step = nullptr;  // what a step adds to it; null: see EnergyLedger
        int work = 0;                        // its sign among the works of the balance
        int drawn = 0;                       // its sign in the figure; 0: not drawn
        const char* label = "";              // in the figure
        int colour = 0, dash = 0;            // curve_colour() and line pattern: 1 marks errors of the scheme
        bool always = false;                 // drawn even where it is negligible
    };
    double EnergyRow::*value;  // null: a sum of others
    Use use;
};
std::span<const EnergyTerm> energy_terms();
std::vector<Measure<EnergyRow>> energy_columns(const RareWorks& works);

void EnergyRow::serialize(auto& archive) {
    for (const EnergyTerm& term : energy_terms())
        if (term.value != nullptr) archive(this->*term.value);
}

/// [J] Part of the dissipated energy beyond the fracture energy of the laws, of incubated strengths: sum of (phi - 1) S
/// G_c f(beta), at the temperatures of the state.
double incubation_energy(const Model& model, const State& state);

/// The median over time of a positive number, to within 1 %: a histogram of its logarithm.
class MedianOverTime {
public:
    void add(double value, double duration);
    double median() const;  // NaN where nothing was added

    void serialize(auto& archive) { archive(bins_, durations_); }

private:
    std::vector<int> bins_;  // ascending
    std::vector<double> durations_;
};

/// [J] Smallest fracture energy of an interface point; 0 where none can break.
double weakest_point(const Model& model);

class EnergyLedger {
public:
    /// `mass`: the matrix that gives the kinetic energy of the reports. `weakest_point` [J]: fracture energy of the
    /// weakest point.
    EnergyLedger(const Model& model, const State& start, MassMatrix mass = MassMatrix::lumped,
                 double weakest_point = 0);

    void add(const State& end, const StepReport& report);
    /// At the end of a step, not of each one: what of its kinetic energy is that of pieces that move as whole ones.
    /// `braking` [s2]: (theta - 1/2) h^2 of an implicit step, which brakes their spins.
    void look_at(const FreeMotion& pieces, double braking);
    /// A region vanished.
    void excavate(const ExcavationEnergies& energies);

    /// The mesh was refined.
    void adapt(const Renumbering& numbers, const LeapfrogEnergies& energies);
    /// The run goes on from another one with other assumptions, and obstacles behind the first `n_obstacles`.
    void assume(const Model& model, const State& now, std::size_t n_obstacles);
    /// The model has become its successor.
    void renew(const Model& model, double weakest_point);

    /// The time of the row becomes that of another clock [s].
    /// The time counts from `time` [s] on, and so do the problems that are solved.
    void set_back(double time) {
        row_.time = time_of_look_ = row_.time - time;
        worst_.fan_solves = worst_.fan_iterations = worst_.fan_fallbacks = worst_.bond_checks = 0;
        worst_.linear_solves = worst_.factorisations = 0;
    }

    const EnergyRow& row() const { return row_; }
    const StepReport& worst() const { return worst_; }  // maxima and counts over all steps
    double largest_energy() const { return largest_energy_; }
    double largest_residual() const { return largest_residual_; }            // [J] over all steps
    double largest_rotation_work() const { return largest_rotation_work_; }  // [J] likewise, of the cumulated work
    /// [J] Scale of losses: the dissipated energy, or the largest recoverable one where that is more, since points that
    /// start to soften have dissipated next to nothing; at least `min_part` of the largest energy (less is rounding),
    /// and the fracture energy of the weakest point, before which nothing broke.
    double dissipation_scale(double min_part = 1e-6) const {
        return std::max({row_.dissipated, largest_recoverable_, min_part * largest_energy_, weakest_point_});
    }
    /// A loss [J] over that scale; 0 where nothing was dissipated.
    double over_dissipated(double loss, double min_part = 1e-6) const {
        const double scale = dissipation_scale(min_part);
        return scale > 0 ? loss / scale : 0;
    }
    /// Law lag over that scale: positive where the interfaces did more work than their law requires. With the explicit
    /// bulk at the middle of the last step, where the works are. Now; and with the largest absolute value over all
    /// steps, on the scale with min_part = 0.01.
    double law_lag() const { return over_dissipated(law_lag_); }
    double law_lag_energy() const { return law_lag_; }  // [J]
    double largest_law_lag() const { return largest_law_lag_; }

    double supplied() const { return supplied_; }  // [J] energy at the start and positive external work since
    /// Conduction, over all steps: error of the balance of heat over its contents and flows, and excess of a
    /// temperature over those around it, over the largest difference.
    double largest_heat_residual() const { return largest_heat_residual_; }
    double largest_overshoot() const { return largest_overshoot_; }
    /// [J] Largest energy that thermal strains would have if they were held. In a free body that warms it is far above
    /// all other energies, and the thermal work, a difference, carries its rounding.
    double largest_free_thermal() const { return largest_free_thermal_; }
    /// [-] With heat: median over time of kinetic over strain energy, without that of pieces that fly and spin, and so
    /// that single jumps of cracks do not count; NaN: there was no strain energy.
    double kinetic_part() const { return kinetic_part_.median(); }
    /// [-] Angular momentum that theta above 1/2 took from pieces, over the largest one of all pieces.
    double braked_spin() const { return largest_angular_momentum_ > 0 ? braked_ / largest_angular_momentum_ : 0; }
    std::int64_t n_steps() const { return n_steps_; }
    double path() const { return path_; }                    // [m] sum over the steps of the way of the fastest point
    double smallest_mass() const { return smallest_mass_; }  // [kg] of a corner

    void serialize(auto& archive) {
        archive(start_energy_, start_surface_, excavated_dissipated_, consumed_change_, largest_energy_,
                largest_recoverable_, largest_residual_, largest_rotation_work_, law_lag_, largest_law_lag_, supplied_,
                n_steps_, row_, worst_, largest_heat_residual_, largest_overshoot_, largest_free_thermal_,
                kinetic_part_, path_, time_of_look_, braked_, largest_angular_momentum_);
    }

private:
    double start_energy_, start_surface_, largest_energy_,
        largest_recoverable_ = 0, largest_residual_ = 0, largest_rotation_work_ = 0, law_lag_ = 0, largest_law_lag_ = 0,
        supplied_, smallest_mass_, weakest_point_, excavated_dissipated_ = 0, consumed_change_ = 0,
        largest_heat_residual_ = 0, largest_overshoot_ = 0, largest_free_thermal_ = 0, path_ = 0, time_of_look_ = 0,
        braked_ = 0, largest_angular_momentum_ = 0;  // [s], [kg m2/s]
    std::int64_t n_steps_ = 0;
    EnergyRow row_;
    StepReport worst_;
    MedianOverTime kinetic_part_;
};

}  // namespace knap
