#include "stepper/scheme_change.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr double fast = 10, fast_at_begin = 100;  // [-] over quiet_below, so that the schemes do not alternate
constexpr double max_lag_of_step = 0.05;          // [-] law lag over the energy that the step consumed
constexpr double max_lag_of_all = 1e-3;           // [-] or over all that was consumed so far
constexpr double max_rise = 1.1;                  // [-] of the strain energy in a step whose damage exceeds all before
constexpr double max_patience = 16;               // [-]

double surface_of(const StepReport& report) {
    return report.dissipated + report.recoverable + report.interface_elastic;
}

}  // namespace

void begin_leapfrog(State& state) {
    state.rate.clear();
    if (state.last_step > 0)  // without a step before, contacts have forces
        for (FaceContactState& contact : state.face_contacts)
            contact.contact /= state.last_step, contact.tangential /= state.last_step;
    state.last_step = 0;
}

void begin_theta_scheme(State& state) { state.rate = state.velocity; }

StepFault SchemeChange::fault(const StepReport& report) const {
    const double surface = surface_of(report), energy = report.strain + surface;
    const bool begins = energy > 2 * (strain_ + surface_);  // kinetic over strain energy of n steps falls as 1/n^2
    const double moved = steady_ ? std::abs(report.kinetic - kinetic_) : report.kinetic;
    if (moved > (begins ? fast_at_begin : fast) * quiet_part(energy)) return StepFault::motion;
    const double consumed = surface - report.consumed_change - surface_,
                 lag = report.cohesive_work + report.law_change - report.crossing_loss - report.viscous_dissipation -
                       report.mixed_dissipation - consumed;
    const double allowed =
        std::max({max_lag_of_step * std::abs(consumed), max_lag_of_all * surface, relative_tolerance * report.strain});
    if (consumed > std::max(surface_, relative_tolerance * report.strain) && report.strain > max_rise * strain_)
        return StepFault::cohesive_work;
    return std::abs(lag) > allowed ? StepFault::cohesive_work : StepFault::none;
}

void SchemeChange::after_step(const State& begin, double h, const StepReport& report) {
    surface_ = surface_of(report), strain_ = report.strain;
    const double now = begin.time + h, quiet = quiet_part(report.strain + surface_);
    if (report.kinetic <= quiet) steady_ = false;
    else if (!steady_) quiet_since_ = now;
    at_rest_ = report.kinetic <= quiet_part(report.strain);
    if (begin.has_end_velocities()) {
        kinetic_ = report.kinetic;
        return;
    }
    least_ = std::min(least_, report.kinetic), most_ = std::max(most_, report.kinetic);
    if (now < look_again_) return;
    calms_down_ = report.kinetic < 0.5 * kinetic_;
    const double largest_steps = std::max(1.0, options_.largest_step / options_.quiet_for);
    steady_ = report.kinetic > quiet && largest_steps * (most_ - least_) <= quiet;
    kinetic_ = least_ = most_ = report.kinetic, look_again_ = now + options_.quiet_for;
}

void SchemeChange::to_explicit(double time) {
    patience_ = time - changed_ <= waiting_time() ? std::min(2 * patience_, max_patience) : 1;
    changed_ = quiet_since_ = time;
    calms_down_ = true, steady_ = false, look_again_ = time + options_.quiet_for;
    kinetic_ = least_ = infinity, most_ = 0;
}

void SchemeChange::to_implicit(double time, const StepReport& closing) {
    changed_ = time;
    surface_ = surface_of(closing), strain_ = closing.strain, kinetic_ = closing.kinetic;
}

}  // namespace knap
