#include "stepper/common/surface_energy.hpp"

#include "stepper/common/point_work.hpp"

namespace knap {

StepReport surface_energy(const Model& model, const State& state) {
    StepReport sum;
    for (std::size_t rank = 0; rank < state.split_fans.size(); ++rank) {
        const auto points = model.points(model.fans[state.split_fans[rank]]);
        for (std::size_t j = 0; j < points.size(); ++j) {
            const PointState& at = state.points[state.first_point[rank] + j];
            if (points[j].cracked || at.cohesion == 1) continue;
            const CohesiveLaw& law = law_of(model, state, points[j]);
            const Vec2 u = opening(model, state, points[j].point);
            const double s = law.equivalent_opening(u.x(), u.y());
            account_cohesion(points[j], law,
                             {.area = points[j].area,
                              .before = at.cohesion,
                              .after = at.cohesion,
                              .opening = s,
                              .at_works = s,
                              .kappa = law.ramp(at.cohesion, at.largest_opening)},
                             sum);
        }
    }
    return sum;
}

}  // namespace knap
