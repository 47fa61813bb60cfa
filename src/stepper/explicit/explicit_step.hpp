#pragma once
// One step of the explicit scheme, and the motion of a node over it (central differences: velocities live at the middle
// of the steps):
//
//     M (v+ - v) = k (F - K u - alpha M (v + v+)/2) + H' P,     u+ = u + h v+,     k = (previous h + h)/2
//
// Damping alpha [1/s] acts at the mean velocity: it is of second order, leaves the stable step as it is, and changes
// no reaction of a fan that moves as one. With d = k alpha/2,
//
//     v+ = decay v + mobility M^-1 (k (F - K u) + H' P),     decay = (1 - d)/(1 + d),     mobility = 1/(1 + d)
#include "model/state.hpp"
#include "stepper/common/step_report.hpp"

#include <algorithm>

namespace knap {

/// [N s] That takes a mass [kg] from `before` to `after` [m/s], against the damping d [-].
inline Vec2 damped_impulse(double mass, const Vec2& before, const Vec2& after, double damping) {
    return mass * ((1 + damping) * after - (1 - damping) * before);
}

struct ExplicitStep {
    const State& begin;
    State& end;
    double drift_time, kick_time;     // [s] h, k
    const std::vector<double>& mass;  // [kg] per corner, in the order of Model::fan_corners
    const std::vector<Vec2>&
        corner_force;    // [N] F - K u per corner, where more than the block of its triangle reads it
    double damping = 0;  // [-] d
    double decay = (1 - damping) / (1 + damping);  // [-]
    double mobility = 1 / (1 + damping);           // [-]
    bool large_rotation = false;                   // K u are the forces -f = grad U of Green's strain

    const std::vector<Vec2>& corner_impulse;  // [N s] per corner, of contacts between free faces; empty: there are none

    /// [m/s] v+ in the prescribed components, zero in the others; `displacement` [m] u.
    Vec2 prescribed_velocity(const Model& model, const PrescribedMotion& motion, const Vec2& displacement) const {
        const StepTimes times{.begin = begin.time, .h = drift_time, .central_differences = true};
        Vec2 velocity = Vec2::Zero();
        for (int k = 0; k < 2; ++k)
            if (motion.component[k]) velocity[k] = motion.rate(k, model.histories, displacement[k], times).rate;
        return velocity;
    }
    /// [N s] That takes a mass from `before` to `after` [m/s], against the damping.
    Vec2 impulse(double mass, const Vec2& before, const Vec2& after) const {
        return damped_impulse(mass, before, after, damping);
    }
    /// [s] Times a change of velocity and a force: the work of a change of the step size in the leapfrog energy.
    double change_time() const { return 0.25 * (drift_time - begin.last_step); }
};

/// Moves nodes and sums up their energies, in registers. The largest speed of the report is squared here. With large
/// rotations U is not quadratic, and the energy of the leapfrog and its defect are
///
///     E_n+1/2 = 1/2 v' M v + U_n - 1/2 f_n . Delta_n+1/2,     f = -grad U,     Delta = h v
///     rotation work = U_n - U_n-1 + 1/2 (f_n-1 + f_n) . Delta_n-1/2
///
/// of which the terms with f_n are summed here (without rotations E is the same, and the defect is zero).
class NodeMotion {
public:
    explicit NodeMotion(const ExplicitStep& step)
        : begin_(step.begin),
          end_(step.end),
          h_(step.drift_time),
          change_time_(step.change_time()),
          damping_(step.damping),
          large_rotation_(step.large_rotation) {}

    /// To the end velocity v+ [m/s]; `force` [N] F - K u.
    [[gnu::always_inline]] void move(Index from, Index to, double mass, const Vec2& force, const Vec2& velocity) {
        const Vec2 u = begin_.displacement[from] + h_ * velocity;
        const double speed2 = velocity.squaredNorm();
        kinetic_ += 0.5 * mass * speed2;
        if (large_rotation_) {
            strain_ -= 0.5 * h_ * force.dot(velocity);
            rotation_work_ += 0.5 * begin_.last_step * force.dot(begin_.velocity[from]);
        } else {
            strain_ -= 0.5 * force.dot(u);
        }
        step_change_work_ -= change_time_ * force.dot(velocity - begin_.velocity[from]);
        if (damping_ != 0) damping_work_ -= 0.5 * damping_ * mass * (begin_.velocity[from] + velocity).squaredNorm();
        largest_speed2_ = std::max(largest_speed2_, speed2);
        end_.velocity[to] = velocity;
        end_.displacement[to] = u;
    }
    void add_to(StepReport& report) const {
        report.kinetic += kinetic_;
        report.strain += strain_;
        report.step_change_work += step_change_work_;
        report.damping_work += damping_work_;
        report.rotation_work += rotation_work_;
        report.largest_speed = std::max(report.largest_speed, largest_speed2_);
    }

private:
    const State& begin_;
    State& end_;
    double h_, change_time_, damping_;
    bool large_rotation_;
    double kinetic_ = 0, strain_ = 0, step_change_work_ = 0, damping_work_ = 0, rotation_work_ = 0, largest_speed2_ = 0;
};

}  // namespace knap
