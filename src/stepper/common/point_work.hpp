#pragma once
// What one interface point, or one contact with an obstacle, adds to the report of a step; with either bulk.
//
// Contact and friction impulses work with a rate that the scheme says: the mean velocity (V+ + V-)/2 in the leapfrog energy, w/theta in the theta scheme.
// The energy Psi = beta sigma_c s + G_c f(beta) of a point has two parts: what is left of it when the point closes, Psi(s = 0) = G_c f(beta), is
// dissipated; beta sigma_c s, the work of the constant traction over the opening, is recoverable.
#include "material/cohesive_law.hpp"
#include "model/model.hpp"
#include "stepper/common/step_report.hpp"

namespace knap {

constexpr double min_softening = 1e-12;  // [-] loss of beta in a step; less is rounding of an opening

struct ContactWork {
    double contact, friction;  // [N s] p >= 0, and what of P_T is friction
    double rate_N, rate_T;     // [m/s] with which they work
    double rate_error;         // [m/s] what rounding and the residual leave in these rates
    double opening;            // [m] u_N at the end of the step
};

inline void account_contact(const ContactWork& at, StepReport& report) {
    const double impact = at.contact * at.rate_N, friction = at.friction * at.rate_T;
    report.impact_work += impact;
    report.friction_work += friction;
    report.worst_impact_work = std::max(report.worst_impact_work, impact - at.rate_error * at.contact);
    report.worst_friction_work = std::max(report.worst_friction_work, friction - at.rate_error * std::abs(at.friction));
    report.penetration = std::max(report.penetration, -at.opening);
}

/// Of a point that keeps its beta and has no opening that its cohesion feels.
inline void account_rest(const FanPoint& point, const CohesiveLaw& law, double beta, StepReport& report) {
    if (!point.cracked && law.sigma_c > 0) report.dissipated += point.area * (beta == 0 ? law.G_c : law.surface_energy(beta, 0, 0));
}

/// `before`, `after`: beta at the begin and at the end of the step [-]; u: opening at its end [m].
inline void account_cohesion(const FanPoint& point, const CohesiveLaw& law, double before, double after, double u_N, double u_T, StepReport& report) {
    if (const double fall = before - after; fall > min_softening) {
        ++report.softened;
        const double drop = point.area * law.G_c * fall * fall;
        if (drop > report.largest_drop) report.largest_drop = drop, report.drop_corner = point.after == rigid_support ? point.before : point.after;
    }
    report.largest_beta_growth = std::max(report.largest_beta_growth, after - before);
    account_rest(point, law, after, report);
    if (after > 0) report.recoverable += point.area * after * law.sigma_c * law.equivalent_opening(u_N, u_T);
}

}  // namespace knap
