#include "stepper/common/surface_energy.hpp"

#include "stepper/common/point_work.hpp"

#include <algorithm>

namespace knap {
namespace {

void add_point(const Model& model, const State& state, const FanPoint& point, const PointState& at, StepReport& sum) {
    const CohesiveLaw& law = law_of(model, state, point);
    const Vec2 u = cohesive_opening(model, state, point, point_frame(model, state, point), at.cohesion);
    const double s = law.equivalent_opening(u.x(), u.y());
    account_cohesion(point, law,
                     {.area = point.area,
                      .before = at.cohesion,
                      .after = at.cohesion,
                      .opening = s,
                      .at_works = s,
                      .kappa = law.ramp(at.cohesion, at.largest_opening)},
                     sum);
}

}  // namespace

StepReport surface_energy(const Model& model, const State& state) {
    StepReport sum;
    for (std::size_t rank = 0; rank < state.split_fans.size(); ++rank) {
        const auto points = model.points(model.fans[state.split_fans[rank]]);
        for (std::size_t j = 0; j < points.size(); ++j) {
            const PointState& at = state.points[state.first_point[rank] + j];
            if (!points[j].cracked && at.cohesion < 1) add_point(model, state, points[j], at, sum);
        }
    }
    return sum;
}

double taken_part(const Model& model, const State& state, const FanPoint& point) {
    if (point.cracked) return 1;
    const PointState* at = state_of(model, state, point.point);
    if (!at || at->cohesion == 1) return 0;
    if (at->cohesion == 0) return 1;
    StepReport of_point;
    add_point(model, state, point, *at, of_point);
    const double taken = of_point.dissipated + of_point.recoverable + of_point.interface_elastic;
    return std::min(1.0, taken / (point.area * law_of(model, state, point).G_c));
}

double dissipated_since(const Model& model, const State& before, const State& after,
                        const std::function<bool(Index corner)>& counts) {
    StepReport sum;
    for (std::size_t rank = 0; rank < after.split_fans.size(); ++rank) {
        const auto points = model.points(model.fans[after.split_fans[rank]]);
        for (std::size_t j = 0; j < points.size(); ++j) {
            const FanPoint& point = points[j];
            const PointState& at = after.points[after.first_point[rank] + j];
            const double beta = cohesion(model, before, point.point);
            if (!(at.cohesion < beta) || !counts(point.corner())) continue;
            const CohesiveLaw& law = law_of(model, after, point);
            account_rest(point, law, point.area, at.cohesion, law.ramp(at.cohesion, at.largest_opening), sum);
            account_rest(point, law, -point.area, beta, law.ramp(beta, at.largest_opening), sum);
        }
    }
    return sum.dissipated;
}

}  // namespace knap
