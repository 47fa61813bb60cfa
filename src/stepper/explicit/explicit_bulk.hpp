#pragma once
// Explicit lumped bulk: M v+ = M v + k (F - K u), u+ = u + h v+ (central differences; velocities live at the middle of the steps,
// k = (previous h + h)/2, so the first step kicks for half a step).
#include "element/elastic_forces.hpp"
#include "model/state.hpp"
#include "stepper/common/step_report.hpp"
#include "stepper/explicit/free_motion.hpp"

namespace knap {

class ExplicitBulk {
public:
    explicit ExplicitBulk(const Model& model);

    void begin_step(const State& begin, double h, FreeMotion& free);

    /// [N] of the bulk on the corners of the triangles from `first` to before `last`; marks the fans that the stress criterion does not clear.
    void find_forces(Index first, Index last, const State& begin, Vec2* force, std::vector<std::uint8_t>& fan_is_candidate) const {
        forces_.evaluate(first, last, begin.displacement, begin.node_of_corner, force, fan_is_candidate);
    }
    /// To the forces of the bulk, some of the loads on corners, as they are at begin.time.
    void add_loads(Index first, Index last, FreeMotion& free) const;

    /// What these loads did in the step: their work, and their share in the energies that `report` has with all forces.
    void account_loads(Index first, Index last, const State& begin, const State& end, const FreeMotion& free, StepReport& report) const;

    double stable_step() const { return stable_step_; }  // [s] of the worst free triangle

private:
    const Model& model_;
    std::vector<double> amplitude_;  // of every history, at the begin of the step
    ElasticForces forces_;
    double stable_step_;
};

}  // namespace knap
