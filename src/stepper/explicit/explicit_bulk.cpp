#include "stepper/explicit/explicit_bulk.hpp"

#include "element/triangle_matrices.hpp"
#include "stepper/explicit/stress_criterion.hpp"

#include <algorithm>

namespace knap {

ExplicitBulk::ExplicitBulk(const Model& model) : model_(model), forces_(model.mesh, model.materials, model.plane, model.thickness) {
    forces_.set_stress_criterion(stress_thresholds(model), model.fan_of_corner);
    const std::vector<double> steps = stable_steps(model.mesh, model.materials, model.plane);
    stable_step_ = *std::min_element(steps.begin(), steps.end());
}

void ExplicitBulk::begin_step(const State& begin, double h, FreeMotion& free) {
    free.drift_time = h;
    free.kick_time = 0.5 * (begin.last_step + h);
    free.corner_force.resize(model_.mesh.n_corners());
    amplitude_.resize(model_.histories.size());
    for (std::size_t i = 0; i < amplitude_.size(); ++i) amplitude_[i] = model_.histories[i](begin.time);
}

void ExplicitBulk::add_loads(Index first, Index last, FreeMotion& free) const {
    for (Index i = first; i < last; ++i) {
        const CornerLoad& load = model_.corner_loads[i];
        free.corner_force[load.corner] += amplitude_[load.history] * load.force;
    }
}

void ExplicitBulk::account_loads(Index first, Index last, const State& begin, const State& end, const FreeMotion& free, StepReport& report) const {
    const double change = 0.25 * (free.drift_time - begin.last_step);
    for (Index i = first; i < last; ++i) {
        const CornerLoad& load = model_.corner_loads[i];
        const Vec2 force = amplitude_[load.history] * load.force;
        const Vec2 before = begin.velocity[begin.node_of_corner[load.corner]], after = end.velocity[end.node_of_corner[load.corner]];
        report.external_work += free.kick_time * force.dot(0.5 * (before + after));
        report.strain += 0.5 * force.dot(end.displacement[end.node_of_corner[load.corner]]);
        report.step_change_work += change * force.dot(after - before);
    }
}

}  // namespace knap
