#include "stepper/common/law_change.hpp"

namespace knap {
void account_law_change(const Model& model, const State& begin, StepReport& report) {
    const Temperatures &before = *begin.temperature_before, &now = *begin.temperature;
    if (&before == &now) return;
    const double half_a_step = begin.has_end_velocities() ? 0 : 0.5 * begin.last_step;  // [s]
    const auto velocity = [&](Index corner) -> Vec2 {
        return corner == rigid_support ? Vec2::Zero() : begin.velocity[begin.node_of_corner[corner]];
    };
    for (std::size_t rank = 0; rank < begin.split_fans.size(); ++rank) {
        const auto points = model.points(model.fans[begin.split_fans[rank]]);
        for (std::size_t j = 0; j < points.size(); ++j) {
            const FanPoint& point = points[j];
            const CohesiveLaw &old = before.laws[point.point], &law = now.laws[point.point];
            if (point.cracked || law.sigma_c == old.sigma_c) continue;
            const PointState& known = begin.points[begin.first_point[rank] + j];
            const double beta = known.cohesion, kappa = law.ramp(beta, known.largest_opening),
                         area = point.area * begin.strength_factor(begin.split_fans[rank]);
            const Vec2 back = half_a_step * (velocity(point.after) - velocity(point.before));
            const Vec2 u =
                begin.opening_of(point, {}) - Vec2(point.normal.dot(back), turned_left(point.normal).dot(back));
            const double s = law.equivalent_opening(u.x(), u.y());
            report.law_change += area * (law.given_back(beta, kappa, s) - old.given_back(beta, kappa, s));
            report.consumed_change += area * (law.consumed(beta, kappa) - old.consumed(beta, kappa));
        }
    }
}

}  // namespace knap
