#pragma once
// How the explicit scheme moves one corner, and what is prescribed of it.
#include "model/state.hpp"
#include "stepper/common/step_report.hpp"
#include "stepper/explicit/free_motion.hpp"

#include <algorithm>

namespace knap {

/// Null where nothing is prescribed. In a fan in one piece all corners have the same.
inline const PrescribedMotion* prescribed_motion(const Model& model, Index corner) {
    return model.prescribed.empty() || model.prescribed_of_corner[corner] < 0 ? nullptr : &model.prescribed[model.prescribed_of_corner[corner]];
}

/// A corner of a fan that came apart, to its `velocity` [m/s] at the end of the step. The largest speed of the report is a square here.
inline void move_corner(Index corner, double mass, const Vec2& velocity, const State& begin, const FreeMotion& free, State& end, StepReport& report) {
    const Index from = begin.node_of_corner[corner], to = end.node_of_corner[corner];
    const Vec2 force = free.corner_force[corner];
    end.velocity[to] = velocity;
    end.displacement[to] = begin.displacement[from] + free.drift_time * velocity;
    report.kinetic += 0.5 * mass * velocity.squaredNorm();
    report.strain -= 0.5 * force.dot(end.displacement[to]);
    report.step_change_work -= 0.25 * (free.drift_time - begin.last_step) * force.dot(velocity - begin.velocity[from]);
    report.largest_speed = std::max(report.largest_speed, velocity.squaredNorm());
}

}  // namespace knap
