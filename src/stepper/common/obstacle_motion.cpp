#include "stepper/common/obstacle_motion.hpp"

#include "base/secant.hpp"
#include "stepper/common/point_work.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr int max_steps = 60, max_secants = 20;
constexpr double no_line_search_below = 1e3;  // times the tolerance: the last digits are not worth a line search
constexpr double difference = 1e-6;           // [-] of the speeds, for the slope: exact up to rounding
constexpr double too_coarse = 1e-3;           // [-] of the impulses: a change by a difference
constexpr int max_smaller = 3;
constexpr int few = 12;  // components that are solved on the stack

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
                const double mass = (1 + damping_) * obstacle.inertia_of(k);
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
    without_contact_ = rate_;
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

double ObstacleMotion::solve(const State& begin, const std::vector<std::uint8_t>& touched, const Accuracy& accuracy,
                             const Response& response) {
    free_.clear();
    for (Index o = 0; o < static_cast<Index>(model_.obstacles.size()); ++o)
        for (int k = 0; k < 3 && touched[o]; ++k)
            if (model_.obstacles[o].is_free(k))
                free_.push_back({o, k, (1 + damping_) * model_.obstacles[o].inertia_of(k)});
    if (free_.empty()) return 0;
    return free_.size() <= few ? find_rates<few>(begin, accuracy, response)
                               : find_rates<Eigen::Dynamic>(begin, accuracy, response);
}

/// Unknowns x = sqrt(M) (W - W without contact), so that all components have one unit; error x - theta Q/sqrt(M).
template <int max_components>
double ObstacleMotion::find_rates(const State& begin, const Accuracy& accuracy, const Response& response) {
    using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, max_components, max_components>;
    using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, max_components, 1>;
    const Eigen::Index n = static_cast<Eigen::Index>(free_.size());
    const double tolerance = accuracy.tolerance, good_progress = accuracy.is_costly ? 0.2 : 1e-3;
    double speed = 0;  // [sqrt(kg) m/s]
    for (const Component& c : free_)
        speed = std::max(speed, std::sqrt(c.mass) * std::max(std::abs(begin.obstacles[c.obstacle].velocity[c.k]),
                                                             std::abs(rate_[c.obstacle][c.k])));
    double scale = 0, of_trial = 0;  // of the impulses of x, and of the last trial, which may press beyond all measure
    wrench_.resize(rate_.size());
    const auto error_at = [&](const Vector& x) {
        rate_ = without_contact_;
        for (Eigen::Index i = 0; i < n; ++i) rate_[free_[i].obstacle][free_[i].k] += x[i] / std::sqrt(free_[i].mass);
        response(wrench_);
        Vector error(n);
        of_trial = 0.01 * speed;  // an impulse is a difference of momenta: it has their rounding
        for (Eigen::Index i = 0; i < n; ++i) {
            const double given = theta_ * wrench_[free_[i].obstacle][free_[i].k] / std::sqrt(free_[i].mass);
            of_trial = std::max({of_trial, std::abs(given), std::abs(x[i])});
            error[i] = x[i] - given;
        }
        return error;
    };
    Vector x(n);  // starts with the reaction of the last step
    for (Eigen::Index i = 0; i < n; ++i)
        x[i] = theta_ * kick_time_ * begin.obstacles[free_[i].obstacle].reaction[free_[i].k] / std::sqrt(free_[i].mass);
    Vector error = error_at(x);
    scale = of_trial;
    Eigen::PartialPivLU<Matrix> slope;
    bool slope_is_known = accuracy.is_costly;
    if (slope_is_known) slope.compute(Matrix::Identity(n, n));
    for (int step = 0; step < max_steps && error.norm() > tolerance * scale; ++step) {
        if (!slope_is_known) {
            Matrix columns(n, n);
            for (Eigen::Index j = 0; j < n; ++j) {
                double delta = difference * std::max(speed, scale);
                Vector changed = error_at(x + delta * Vector::Unit(n, j)) - error;
                // beside a stiff body the difference must not part what touches: the error changes more than the rate
                for (int again = 0; again < max_smaller && changed.norm() > too_coarse * scale; ++again) {
                    delta *= difference * scale / changed.norm();
                    changed = error_at(x + delta * Vector::Unit(n, j)) - error;
                }
                columns.col(j) = changed / delta;
            }
            slope.compute(columns);
        }
        const Vector change = -slope.solve(error);
        const double before = error.norm();
        Vector next = x + change, next_error = error_at(next);
        double of_next = of_trial;
        // without friction the error is the gradient of a convex function: the zero of its slope along Newton's step is
        // the length of the step
        if (next_error.norm() > 0.1 * before && before > no_line_search_below * tolerance * scale) {
            const double at_0 = change.dot(error), at_1 = change.dot(next_error);
            const auto along = [&](double part) { return change.dot(error_at(x + part * change)); };
            const double length =
                at_0 < 0 && at_1 > 0 ? zero_between(0, at_0, 1, at_1, 1e-3 * std::abs(at_0), max_secants, along) : 1;
            next = x + length * change, next_error = error_at(next), of_next = of_trial;
        }
        if (before <= no_line_search_below * tolerance * scale && next_error.norm() >= before) break;
        slope_is_known = next_error.norm() <= good_progress * before;  // the same linear piece
        x = next, error = next_error, scale = of_next;
    }
    if (error.norm() > tolerance * scale) error = error_at(x);
    return scale > 0 ? error.norm() / scale : 0;
}

}  // namespace knap
