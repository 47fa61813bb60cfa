#pragma once
// Energies, works, errors and counts of one step; the ledger adds them up.
#include "base/tolerance.hpp"
#include "base/vec.hpp"

#include <algorithm>
#include <cstdint>
#include <tuple>

namespace knap {

/// [-] Of contacts between free faces: the error of their rates over their speeds, and their depth over the length of
/// the edge. A step beyond is repeated with a smaller size.
constexpr double max_contact_residual = 1e-6, max_contact_depth = 0.1;

/// Why a step was rejected; its end state is void and must not be used.
enum class Rejection {
    none,
    assumption_1,      // softening outweighs inertia and stiffness: several solutions; a smaller step has one
    contact_speed,     // faces that meet move too far in the step
    contact_residual,  // no motion was found that obeys the laws of contacts between free faces
    not_converged,     // the solver of the interfaces did not reach its tolerance
    jammed,            // contacts are driven against each other, and no motion was found that obeys their laws
    too_coarse,        // a fan splits that must be refined first (Model::too_coarse)
    turn,              // a piece turns by more than an implicit step resolves
    blow,              // a rigid piece is hit so hard that it may break: it has to be deformable
};

/// How to combine the values of two parts of the body, or of two steps.
enum class Combine { sum, maximum };

/// Energies are those at the end of the step, works those of the step [J]; an impulse works with the mean of the
/// velocities before and after it.
struct StepReport {
    double kinetic = 0;            // 1/2 v' M v
    double strain = 0;             // explicit 1/2 u_n' K u_{n+1}, implicit 1/2 u' K u
    double dissipated = 0;         // sum of S G_c f(beta) over all points: not given back when they close
    double recoverable = 0;        // sum of S beta sigma_c s: given back when they close
    double interface_elastic = 0;  // sum of S beta sigma_c s^2/(2 kappa): of points with secant unloading
    double external_work = 0;      // of loads and prescribed motions
    double cohesive_work = 0;      // against the interface forces that Psi belongs to (positive: taken from the body)
    double crossing_loss = 0;      // part of cohesive_work: lost where a slip changes its sign within a step
    double impact_work = 0;        // <= 0
    double friction_work = 0;      // <= 0
    double cohesive_friction_work = 0;  // <= 0: its part without contact pressure, on what balances the cohesion
    double step_change_work = 0;        // of a change of the step size in the leapfrog energy
    double contact_injection = 0;  // >= 0: positive works of contacts between free faces, by the residual of their laws
    double rotation_work = 0;      // defect of the elastic energy in the leapfrog energy, of large rotations
    double damping_work = 0;       // of mass-proportional damping; <= 0 where it is of the motion as a whole
    double bulk_viscosity_work = 0;  // of bulk viscosity, over the last step (element/bulk_viscosity.hpp)
    double radiated_work = 0;        // <= 0: of absorbing boundaries
    double excavation_work = 0;      // of the forces of excavated regions while they decrease to zero
    double thermal_work = 0;         // of thermal strains that change
    double law_change = 0;           // of recoverable and elastic energy, by strengths that follow the temperature
    double consumed_change = 0;  // likewise of S G_c f(beta), which is in `dissipated` of this step and was not used
    double viscous_dissipation = 0;  // >= 0: of delayed softening, beyond `dissipated`
    double mixed_dissipation = 0;    // where slip costs another fracture energy, beyond both
    double vibration_booked = 0;     // <= 0: kinetic energy of the vibration of pieces that become rigid
    double sleep_work = 0;           // <= 0: kinetic energy of pieces that fall asleep
    double projection_work = 0;      // of loads, against which positions of rigid pieces are corrected; no energy
    double exchange_work = 0;     // of contacts between rigid pieces and deformable ones, on both (stepper/islands.hpp)
    double kick_energy = 0;       // that loads alone would give rigid pieces at rest: the scale of what contacts bear
    double rigid_injection = 0;   // >= 0: positive works of contacts of rigid pieces, by the residual of their laws
    double thaw_dissipation = 0;  // part of `dissipated` that falls into the first step of pieces that were rigid
    double scheme_dissipation = 0;  // >= 0: (theta - 1/2) (|dv|_M^2 + |du|_K^2) of the implicit bulk
    // of single points, beyond what the residual and rounding explain; must be <= 0
    double worst_impact_work = 0;
    double worst_friction_work = 0;
    double residual = 0;                 // [-] largest residual of the interface laws, scaled
    double penetration = 0;              // [m] largest
    double contact_residual = 0;         // [-] largest of contacts between free faces, over their speeds
    Vec2 residual_place = Vec2::Zero();  // [m] of the worst residual, in the deformed body
    double contact_depth = 0;            // [-] largest penetration of a free face over the length of its edge
    Vec2 depth_place = Vec2::Zero();     // [m] of the largest depth, in the deformed body
    double largest_speed = 0;            // [m/s]
    double approach = 0;                 // [m/s] largest with which obstacles or free faces meet in the step
    Vec2 approach_place = Vec2::Zero();  // [m] where that is, in the deformed body
    double rebound_lack = 0;             // [-] part of what R_N takes of an impact and the surface could not take
    Vec2 lack_place = Vec2::Zero();      // [m] where that is, in the deformed body
    double fluttering_work = 0;          // [J] >= 0: of friction over pressure or slip, in steps that hardly damp
    double fluttering_slip = 0;          // [J] likewise of the pressure on the slip
    double largest_opened = 0;           // [-] by which a point that loses cohesion opens, over its delta_c; explicit
    double largest_beta_growth = 0;      // [-] must be 0
    double largest_strength_factor = 0;  // [-] phi of the fans that split, with an incubation time
    double largest_drop = 0;             // [J] S G_c (fall of beta)^2 of one point: about the error of the step there
    Index drop_corner = -1;              // a corner of that point
    double micro_lag = 0;                // [J] largest law lag within a step of rigid pieces, since its start
    double micro_lead = 0;               // [J] likewise of negative ones
    double contact_motion = 0;           // [-] of rigid pieces: largest motion over the one that is allowed
    std::int64_t fan_solves = 0;         // nonlinear problems of split fans
    std::int64_t fan_iterations = 0;     // linear systems solved for them
    std::int64_t fan_fallbacks = 0;      // of them not solved by the active set
    std::int64_t face_contacts = 0;      // between free faces
    std::int64_t bond_checks = 0;        // bonded fans that the stress criterion does not clear
    std::int64_t released = 0;           // fans that split
    std::int64_t softened = 0;           // points that lost cohesion
    std::int64_t linear_solves = 0;      // of the implicit bulk
    std::int64_t factorisations = 0;
    std::int64_t micro_steps = 0;  // of deformable pieces within a step of rigid ones
    std::int64_t thaws = 0;        // pieces that a blow made deformable
    Rejection rejection = Rejection::none;
    Vec2 where = Vec2::Zero();  // [m] of the rejection
    double rejected_value = 0;  // [-] what was too large: of contacts

    /// Calls visit(member, how to combine it) for the numbers above except those with a place; sums and serialization
    /// follow from this list.
    template <class Visit>
    static constexpr void for_each_number(const Visit& visit) {
        using R = StepReport;
        constexpr auto sums = std::tuple{&R::kinetic,
                                         &R::strain,
                                         &R::dissipated,
                                         &R::recoverable,
                                         &R::interface_elastic,
                                         &R::external_work,
                                         &R::cohesive_work,
                                         &R::crossing_loss,
                                         &R::impact_work,
                                         &R::friction_work,
                                         &R::cohesive_friction_work,
                                         &R::step_change_work,
                                         &R::scheme_dissipation,
                                         &R::rotation_work,
                                         &R::contact_injection,
                                         &R::damping_work,
                                         &R::radiated_work,
                                         &R::excavation_work,
                                         &R::fan_solves,
                                         &R::fan_iterations,
                                         &R::fan_fallbacks,
                                         &R::face_contacts,
                                         &R::bond_checks,
                                         &R::released,
                                         &R::softened,
                                         &R::linear_solves,
                                         &R::factorisations,
                                         &R::thermal_work,
                                         &R::law_change,
                                         &R::consumed_change,
                                         &R::viscous_dissipation,
                                         &R::mixed_dissipation,
                                         &R::vibration_booked,
                                         &R::sleep_work,
                                         &R::projection_work,
                                         &R::kick_energy,
                                         &R::rigid_injection,
                                         &R::exchange_work,
                                         &R::thaw_dissipation,
                                         &R::micro_steps,
                                         &R::thaws,
                                         &R::bulk_viscosity_work,
                                         &R::fluttering_work,
                                         &R::fluttering_slip};
        constexpr auto maxima = std::tuple{&R::worst_impact_work,
                                           &R::worst_friction_work,
                                           &R::residual,
                                           &R::penetration,
                                           &R::largest_speed,
                                           &R::largest_beta_growth,
                                           &R::largest_strength_factor,
                                           &R::largest_opened,
                                           &R::micro_lag,
                                           &R::micro_lead,
                                           &R::contact_motion};
        std::apply([&](auto... member) { (visit(member, Combine::sum), ...); }, sums);
        std::apply([&](auto... member) { (visit(member, Combine::maximum), ...); }, maxima);
    }

    template <class Archive>
    void serialize(Archive& archive) {
        for_each_number([&](auto member, Combine) { archive(this->*member); });
        archive(largest_drop, drop_corner, contact_depth, depth_place, contact_residual, residual_place, approach,
                approach_place, rebound_lack, lack_place);
        archive(rejection, where, rejected_value);
    }

    /// Adds another part of the body, or another step.
    StepReport& operator+=(const StepReport& other) {
        for_each_number([&](auto member, Combine how) {
            if (how == Combine::sum) this->*member += other.*member;
            else this->*member = std::max(this->*member, other.*member);
        });
        if (other.largest_drop > largest_drop) largest_drop = other.largest_drop, drop_corner = other.drop_corner;
        add_depth(other.contact_depth, other.depth_place);
        add_contact_residual(other.contact_residual, other.residual_place);
        if (other.approach > approach) approach = other.approach, approach_place = other.approach_place;
        add_rebound_lack(other.rebound_lack, other.lack_place);
        reject(other.rejection, other.where, other.rejected_value);
        return *this;
    }
    void add_depth(double depth, const Vec2& place) {
        if (depth > contact_depth) contact_depth = depth, depth_place = place;
    }
    void add_rebound_lack(double part, const Vec2& place) {
        if (part > rebound_lack) rebound_lack = part, lack_place = place;
    }
    void add_contact_residual(double error, const Vec2& place) {
        if (error > contact_residual) contact_residual = error, residual_place = place;
    }
    /// Notes a contact whose gap [m] changes by `rate` [m/s], over a step of h [s].
    void add_approach(double gap, double h, double rate, const Vec2& place) {
        if (gap + h * rate <= 0 && -rate > approach) approach = -rate, approach_place = place;
    }
    /// Keeps the first rejection.
    void reject(Rejection reason, const Vec2& place, double value = 0) {
        if (rejection == Rejection::none) rejection = reason, where = place, rejected_value = value;
    }
};

}  // namespace knap
