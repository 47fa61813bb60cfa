#include "stepper/common/obstacle_motion.hpp"

#include "stepper/common/point_work.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

/// [-] What the history of a force does over the step beyond what its values at single times say.
double missed_of(const TimeFunction& history, const StepTimes& times, double before) {
    const double end = times.begin + times.h;
    if (times.central_differences) return history.over_kick(times.begin, before, times.h) - history(times.begin);
    if (history.beyond_trapezoid(times.begin, end) == 0) return 0;
    return history.over_step(times.begin, end, times.theta) -
           (times.theta * history(end) + (1 - times.theta) * history(times.begin));
}

}  // namespace

void ObstacleMotion::begin_explicit(const State& begin, double kick_time, double drift_time, double damping) {
    theta_scheme_ = false, theta_ = 1, kick_time_ = kick_time, drift_time_ = drift_time, damping_ = damping;
    begin_step(begin, {.begin = begin.time, .h = drift_time, .central_differences = true});
}

void ObstacleMotion::begin_theta(const State& begin, double h, double theta, double damping) {
    theta_scheme_ = true, theta_ = theta, kick_time_ = drift_time_ = h, damping_ = damping;
    begin_step(begin, {.begin = begin.time, .h = h, .theta = theta});
}

void ObstacleMotion::begin_step(const State& begin, const StepTimes& times) {
    const std::size_t n = model_.obstacles.size();
    rate_.resize(n), force_.resize(n), end_velocity_.resize(n);
    for (std::size_t o = 0; o < n; ++o) {
        const Obstacle& obstacle = model_.obstacles[o];
        const ObstacleState& state = begin.obstacles[o];
        force_[o] = force_at(obstacle, times.begin);
        if (theta_scheme_) force_[o] = theta_ * force_at(obstacle, times.begin + times.h) + (1 - theta_) * force_[o];
        for (const ObstacleForce& each : obstacle.forces)
            if (const double missed = missed_of(each.history, times, begin.last_step); missed != 0)
                for (int k = 0; k < 3; ++k) force_[o][k] += obstacle.is_free(k) ? missed * each.value[k] : 0;
        for (int k = 0; k < 3; ++k) {
            const Drive& drive = obstacle.drive[k];
            if (obstacle.is_free(k)) {
                const double mass = this->mass(static_cast<Index>(o), k);
                const double kept = (theta_scheme_ ? 1 : 1 - damping_) / (1 + damping_);
                rate_[o][k] = kept * state.velocity[k] + theta_ * kick_time_ / mass * force_[o][k];
            } else {
                const PrescribedRate given = prescribed_rate(drive.kind == Drive::Kind::displacement, drive.value,
                                                             drive.history, state.moved[k], times);
                rate_[o][k] = given.rate;
                end_velocity_[o][k] = given.end_velocity;
            }
        }
    }
}

void ObstacleMotion::finish(const State& begin, const std::vector<Vec3>& wrench, State& end, StepReport& report) const {
    end.obstacles = begin.obstacles;
    for (std::size_t o = 0; o < model_.obstacles.size(); ++o) {
        const Obstacle& obstacle = model_.obstacles[o];
        ObstacleState& state = end.obstacles[o];
        const Vec3 before = begin.obstacles[o].velocity;
        Vec3 rate = rate_[o];
        for (int k = 0; k < 3; ++k) {
            if (!obstacle.is_free(k)) {
                state.velocity[k] = end_velocity_[o][k];
            } else if (theta_scheme_) {  // next to a stiff body the rate is more accurate than the impulse
                state.velocity[k] = (rate[k] - (1 - theta_) * before[k]) / theta_;
            } else {  // next to small masses the impulse is
                rate[k] = state.velocity[k] =
                    (1 - damping_) / (1 + damping_) * before[k] +
                    (kick_time_ * force_[o][k] + wrench[o][k]) / ((1 + damping_) * obstacle.inertia_of(k));
            }
            const double change = state.velocity[k] - before[k],
                         work_rate = theta_scheme_ ? rate[k] : 0.5 * (before[k] + state.velocity[k]);
            if (obstacle.is_free(k)) report.external_work += kick_time_ * force_[o][k] * work_rate;
            else account_drive(-wrench[o][k], work_rate, report);
            if (obstacle.is_free(k))
                report.damping_work -=
                    (theta_scheme_ ? damping_ / theta_ : 2 * damping_) * obstacle.inertia_of(k) * work_rate * work_rate;
            if (obstacle.is_free(k) && theta_scheme_)
                report.scheme_dissipation += (theta_ - 0.5) * obstacle.inertia_of(k) * change * change;
        }
        report.kinetic += kinetic_energy(obstacle, state.velocity);
        state.reaction = wrench[o] / kick_time_;
        move(obstacle, drift_time_ * rate, state);
    }
}

}  // namespace knap
