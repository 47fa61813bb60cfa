#include "stepper/scheme_change.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr double fast_over_quiet = 10;    // [-] so that the schemes do not alternate
constexpr double max_lag_of_step = 0.05;  // [-] law lag over the energy that the step consumed
constexpr double max_lag_of_all = 1e-3;   // [-] or over all that was consumed so far
constexpr double lag_rounding = 1e-12;    // [-] over the strain energy
constexpr double max_patience = 16;       // [-]

double surface_of(const StepReport& report) {
    return report.dissipated - report.consumed_change + report.recoverable + report.interface_elastic;
}

}  // namespace

void begin_leapfrog(State& state) {
    state.rate.clear();
    state.last_step = 0;
}

void begin_theta_scheme(State& state) { state.rate = state.velocity; }

StepFault SchemeChange::fault(const StepReport& report) const {
    if (report.kinetic > fast_over_quiet * options_.quiet_below * report.strain) return StepFault::motion;
    const double surface = surface_of(report), consumed = surface - surface_,
                 lag = report.cohesive_work + report.law_change - report.crossing_loss - report.viscous_dissipation -
                       consumed;
    const double allowed =
        std::max({max_lag_of_step * std::abs(consumed), max_lag_of_all * surface, lag_rounding * report.strain});
    return std::abs(lag) > allowed ? StepFault::cohesive_work : StepFault::none;
}

void SchemeChange::after_step(const State& begin, double h, const StepReport& report) {
    surface_ = surface_of(report);
    const bool quiet =
        report.softened == 0 && report.released == 0 && report.kinetic <= options_.quiet_below * report.strain;
    if (!quiet) quiet_since_ = begin.time + h;
}

void SchemeChange::to_explicit(double time) {
    const bool was_short = time - changed_ <= waiting_time();
    patience_ = was_short ? std::min(2 * patience_, max_patience) : 1;
    changed_ = quiet_since_ = time;
}

void SchemeChange::to_implicit(double time, const StepReport& closing) {
    changed_ = time;
    surface_ = surface_of(closing);
}

}  // namespace knap
