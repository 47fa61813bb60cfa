#pragma once
// What a point's cohesion at the end of a step means for the books, with either bulk. The energy Psi = beta sigma_c s + G_c f(beta) has two parts: what is
// left of it when the point closes, Psi(s = 0) = G_c f(beta), is dissipated; beta sigma_c s, the work of the constant traction over the opening, is given back.
#include "model/model.hpp"
#include "stepper/step_report.hpp"

#include <algorithm>

namespace knap {

constexpr double least_loss = 1e-12;  // of the cohesion in a step: less is rounding of an opening, not softening

/// Of a point that keeps its beta and has no opening that its cohesion feels.
inline void account_rest(const FanPoint& point, const CohesiveLaw& law, double beta, StepReport& report) {
    if (!point.cracked && law.sigma_c > 0) report.dissipated += point.area * (beta == 0 ? law.G_c : law.surface_energy(beta, 0, 0));
}

/// `before`, `after`: beta at the begin and at the end of the step [-]; u: opening at its end [m].
inline void account_cohesion(const FanPoint& point, const CohesiveLaw& law, double before, double after, double u_N, double u_T, StepReport& report) {
    if (const double fall = before - after; fall > least_loss) {
        ++report.softened;
        const double drop = point.area * law.G_c * fall * fall;
        if (drop > report.largest_drop) report.largest_drop = drop, report.drop_corner = point.after == ground ? point.before : point.after;
    }
    report.largest_beta_growth = std::max(report.largest_beta_growth, after - before);
    account_rest(point, law, after, report);
    if (after > 0) report.recoverable += point.area * after * law.sigma_c * law.equivalent_opening(u_N, u_T);
}

}  // namespace knap
