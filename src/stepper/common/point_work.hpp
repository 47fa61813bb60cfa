#pragma once
// The terms of one interface point, one contact with an obstacle or one prescribed component in the report of a step,
// for both schemes.
//
// Contact and friction impulses work with the rate of the scheme: the mean velocity (V+ + V-)/2 in the leapfrog energy,
// w/theta in the theta scheme. The energy Psi = beta sigma_c s + G_c f(beta) of a point has two parts: G_c f(beta),
// which remains when the point closes, is dissipated; beta sigma_c s, the work of the constant traction, is
// recoverable. With secant unloading half of that is dissipated where beta falls, and the rest is elastic; with
// vertical unloading all of it is dissipated. Delayed softening dissipates more: what the point bears beyond the
// softening curve while beta falls.
#include "base/tolerance.hpp"
#include "material/cohesive_law.hpp"
#include "model/model.hpp"
#include "stepper/common/step_report.hpp"

#include <algorithm>
#include <cmath>

namespace knap {

constexpr double rate_rounding = 1e-14;  // [-] of the rates

struct ContactWork {
    double contact, friction;  // [N s] p >= 0, and the part of P_T that is friction
    double rate_N, rate_T;     // [m/s] with which they work
    double rate_error;         // [m/s] of these rates, by rounding and the residual
    double opening;            // [m] u_N at the end of the step
    double cohesive =
        0;  // [N s] pull of the cohesion along N, which a part of `contact` balances: that of the point, and
            // what the other point of its face leaves
    double work_error = 0;     // [J] by the residual in the impulses
    bool may_flutter = false;  // friction over pressure or slip, in a step that hardly damps
};

inline void account_contact(const ContactWork& at, StepReport& report) {
    const double impact = at.contact * at.rate_N, friction = at.friction * at.rate_T;
    report.impact_work += impact;
    report.friction_work += friction;
    if (at.cohesive > 0 && at.contact > 0)
        report.cohesive_friction_work += friction * std::min(1.0, at.cohesive / at.contact);
    report.worst_impact_work = std::max(report.worst_impact_work, impact - at.rate_error * at.contact - at.work_error);
    report.worst_friction_work =
        std::max(report.worst_friction_work, friction - at.rate_error * std::abs(at.friction) - at.work_error);
    report.penetration = std::max(report.penetration, -at.opening);
    if (at.may_flutter) {
        report.fluttering_work += std::abs(friction);
        report.fluttering_slip += at.contact * std::abs(at.rate_T);
    }
}

/// [J] Of the impulse P at a mean rate, both (N, T): what the residual of the laws injects.
inline double positive_work(const Vec2& P, const Vec2& mean) {
    return std::max(0.0, P.x() * mean.x()) + std::max(0.0, P.y() * mean.y());
}

/// A prescribed component: the impulse [N s] that its drive gives to the body works with the rate of the scheme [m/s].
/// `on_mass` [J]: of it, where the end velocity is not that of the scheme.
inline void account_drive(double impulse, double rate, StepReport& report, double on_mass = 0) {
    report.external_work += impulse * rate + on_mass;
}

/// A point over a step. `kappa` [m]: of secant and vertical unloading, else 0.
struct CohesionStep {
    double area;           // [m2] S, times phi where its strength was incubated
    double before, after;  // [-] beta at the start and at the end
    double opening;        // [m] equivalent opening s at the end
    double at_works;       // [m] where the works of the scheme end: in the middle of the step with the explicit bulk
    double at_fall = opening;  // [m] where beta falls, as the works see it
    double kappa = 0;          // [m] at the end
    double energy_factor = 1;  // [-] G(m)/G_c of the opening at the end
};

/// Books a point that keeps its beta and does not open with cohesion.
inline void account_rest(const FanPoint& point, const CohesiveLaw& law, double area, double beta, double kappa,
                         StepReport& report) {
    if (!point.cracked && law.sigma_c > 0) report.dissipated += area * law.consumed(beta, kappa);
}

inline void account_cohesion(const FanPoint& point, const CohesiveLaw& law, const CohesionStep& at,
                             StepReport& report) {
    if (const double fall = at.before - at.after; fall > relative_tolerance) {
        ++report.softened;
        const double drop = at.area * law.G_c * fall * law.opening_of_fall(at.before, at.after);
        if (drop > report.largest_drop) report.largest_drop = drop, report.drop_corner = point.corner();
        if (const double opened = 2 * (at.opening - at.at_works); opened > report.largest_opened * law.delta_c())
            report.largest_opened = opened / law.delta_c();
        const double viscous = law.viscous_dissipation(at.before, at.after, at.at_fall / at.energy_factor);
        report.viscous_dissipation += at.area * viscous;
        report.mixed_dissipation += at.area * law.mixed_dissipation(at.before, at.after, viscous, at.energy_factor);
    }
    report.largest_beta_growth = std::max(report.largest_beta_growth, at.after - at.before);
    account_rest(point, law, at.area, at.after, at.kappa, report);
    if (law.unloading == Unloading::secant)
        report.interface_elastic += at.area * law.elastic_energy(at.after, at.kappa, at.at_works);
    else if (law.unloading == Unloading::constant && at.after > 0)
        report.recoverable += at.area * at.after * law.sigma_c * at.opening;
}

}  // namespace knap
