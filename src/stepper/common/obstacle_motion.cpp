#include "stepper/common/obstacle_motion.hpp"

#include "base/secant.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr int max_steps = 60, max_secants = 20;
constexpr double good_enough = 1e3;    // times the tolerance: the last digits are not worth a search
constexpr double difference = 1e-6;    // of the speeds, for the derivative: exact up to rounding, since Q is piecewise linear
constexpr int few = 12;                // components, on the stack

}  // namespace

void ObstacleMotion::begin_explicit(const State& begin, double kick_time, double drift_time) {
    theta_scheme_ = false, theta_ = 1, kick_time_ = kick_time, drift_time_ = drift_time;
    begin_step(begin, {.begin = begin.time, .h = drift_time, .central_differences = true});
}

void ObstacleMotion::begin_theta(const State& begin, double h, double theta) {
    theta_scheme_ = true, theta_ = theta, kick_time_ = drift_time_ = h;
    begin_step(begin, {.begin = begin.time, .h = h, .theta = theta});
}

void ObstacleMotion::begin_step(const State& begin, const StepTimes& step) {
    const std::size_t n = model_.obstacles.size();
    rate_.resize(n);
    force_.resize(n);
    end_velocity_.resize(n);
    for (std::size_t o = 0; o < n; ++o) {
        const Obstacle& obstacle = model_.obstacles[o];
        force_[o] = force_at(obstacle, step.begin);
        if (theta_scheme_) force_[o] = theta_ * force_at(obstacle, step.begin + step.h) + (1 - theta_) * force_[o];
        for (int k = 0; k < 3; ++k) {
            const Drive& drive = obstacle.drive[k];
            if (drive.kind == Drive::Kind::free) {
                rate_[o][k] = end_velocity_[o][k] = begin.obstacles[o].velocity[k] + theta_ * kick_time_ / obstacle.inertia_of(k) * force_[o][k];
                continue;
            }
            const PrescribedRate given =
                prescribed_rate(drive.kind == Drive::Kind::displacement, drive.value, drive.history, begin.obstacles[o].moved[k], step);
            rate_[o][k] = given.rate;
            end_velocity_[o][k] = given.end_velocity;
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
            if (obstacle.is_free(k)) {
                // beside a stiff body a rate is known better than the impulse that leads to it, beside small masses the impulse
                if (theta_scheme_) state.velocity[k] = (rate[k] - (1 - theta_) * before[k]) / theta_;
                else rate[k] = state.velocity[k] = before[k] + (kick_time_ * force_[o][k] + wrench[o][k]) / obstacle.inertia_of(k);
            } else {
                state.velocity[k] = end_velocity_[o][k];
            }
            // an impulse works with the rate of the theta scheme; with the mean of the velocities in the leapfrog energy of the explicit bulk
            const double change = state.velocity[k] - before[k], along = theta_scheme_ ? rate[k] : 0.5 * (before[k] + state.velocity[k]);
            if (obstacle.is_free(k)) report.external_work += kick_time_ * force_[o][k] * along;
            else report.external_work -= wrench[o][k] * along;
            if (obstacle.is_free(k) && theta_scheme_) report.scheme_dissipation += (theta_ - 0.5) * obstacle.inertia_of(k) * change * change;
        }
        report.kinetic += kinetic_energy(obstacle, state.velocity);
        state.reaction = wrench[o] / kick_time_;
        move(obstacle, drift_time_ * rate, state);
    }
}

double ObstacleMotion::solve(const State& begin, const std::vector<std::uint8_t>& touched, double tolerance, const Response& response) {
    free_.clear();
    for (Index o = 0; o < static_cast<Index>(model_.obstacles.size()); ++o)
        for (int k = 0; k < 3 && touched[o]; ++k)
            if (model_.obstacles[o].is_free(k)) free_.push_back({o, k, model_.obstacles[o].inertia_of(k)});
    if (free_.empty()) return 0;
    return free_.size() <= few ? find_rates<few>(begin, tolerance, response) : find_rates<Eigen::Dynamic>(begin, tolerance, response);
}

template <int most>
double ObstacleMotion::find_rates(const State& begin, double tolerance, const Response& response) {
    using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most, most>;
    using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most, 1>;
    const std::vector<Component>& free = free_;
    const Eigen::Index n = static_cast<Eigen::Index>(free.size());
    // in units of sqrt(mass) all components weigh alike
    without_contact_ = rate_;
    std::vector<Vec3>& wrench = wrench_;
    wrench.resize(rate_.size());
    double scale = 0;  // [sqrt(kg) m/s]
    const auto at = [&](const Vector& x) {
        rate_ = without_contact_;
        for (Eigen::Index i = 0; i < n; ++i) rate_[free[i].obstacle][free[i].k] += x[i] / std::sqrt(free[i].mass);
        response(wrench);
        Vector error(n);
        for (Eigen::Index i = 0; i < n; ++i) {
            const double given = theta_ * wrench[free[i].obstacle][free[i].k] / std::sqrt(free[i].mass);
            scale = std::max({scale, std::abs(given), std::abs(x[i])});
            error[i] = x[i] - given;
        }
        return error;
    };
    double speed = 0;
    for (const Component& c : free) {
        const double V = std::max(std::abs(begin.obstacles[c.obstacle].velocity[c.k]), std::abs(rate_[c.obstacle][c.k]));
        speed = std::max(speed, std::sqrt(c.mass) * V);
    }
    // without friction the error is the gradient of a convex function: the zero of its slope along Newton's step is the length of the step
    scale = 0.01 * speed;  // an impulse is a difference of momenta: near their rounding nothing can be decided
    Vector x(n);  // the reaction of the last step goes on
    for (Eigen::Index i = 0; i < n; ++i) x[i] = theta_ * kick_time_ * begin.obstacles[free[i].obstacle].reaction[free[i].k] / std::sqrt(free[i].mass);
    Vector error = at(x);
    Eigen::PartialPivLU<Matrix> slope;
    bool slope_is_known = false;
    for (int step = 0; step < max_steps && error.norm() > tolerance * scale; ++step) {
        if (!slope_is_known) {
            const double delta = difference * std::max(speed, scale);
            Matrix columns(n, n);
            for (Eigen::Index j = 0; j < n; ++j) columns.col(j) = (at(x + delta * Vector::Unit(n, j)) - error) / delta;
            slope.compute(columns);
        }
        const Vector change = -slope.solve(error);
        const double before = error.norm();
        Vector tried = x + change, found = at(tried);
        if (found.norm() > 0.1 * before && before > good_enough * tolerance * scale) {
            const double at_0 = change.dot(error), at_1 = change.dot(found);
            const bool changes_sign = at_0 < 0 && at_1 > 0;
            const auto along = [&](double part) { return change.dot(at(x + part * change)); };
            const double a = changes_sign ? zero_between(0, at_0, 1, at_1, 1e-3 * std::abs(at_0), max_secants, along) : 1;
            tried = x + a * change, found = at(tried);
        }
        if (before <= good_enough * tolerance * scale && found.norm() >= before) break;
        slope_is_known = found.norm() <= 1e-3 * before;  // the same piece
        x = tried, error = found;
    }
    if (error.norm() > tolerance * scale) error = at(x);
    return scale > 0 ? error.norm() / scale : 0;
}

}  // namespace knap
