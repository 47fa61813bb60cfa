#include "stepper/common/changing_friction.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr double least_part_of_areas = 0.1;  // [-] of both areas

}  // namespace

double pressed_area(const Model& model, const State& begin, const Fan& fan, const FanPoint& point) {
    const Index rank = begin.split_rank[&fan - model.fans.data()];
    if (!model.laws[point.law].over_pressure || rank < 0) return point.area;
    const FanPoint* beyond = same_face_beyond(model, point);
    if (!beyond) return point.area;
    const auto points = model.points(fan);
    const auto state_of = [&](const FanPoint& at) -> const PointState& {
        return begin.points[begin.first_point[rank] + (&at - points.data())];
    };
    for (const FanPoint& at : points) {
        const bool holds = unbreakable(model, at) || (!at.cracked && state_of(at).cohesion == 1);
        if (!holds && &at != &point && &at != beyond) return point.area;  // three parts or more
    }
    const auto pressed = [&](const FanPoint& at) {  // [N], by what balances the cohesion, too
        const CohesiveLaw& law = law_of(model, begin, at);
        const double pull = law.coupling == Coupling::sum && !at.cracked ? law.sigma_c * state_of(at).cohesion : 0;
        return at.area * std::max(0.0, state_of(at).traction.x() + pull);
    };
    const double both = point.area + beyond->area, own = pressed(point), sum = own + pressed(*beyond);
    return sum > 0 ? both * std::max(own / sum, least_part_of_areas) : point.area;
}

void follow_slip(const Model& model, const State& begin, State& end) {
    for (std::size_t rank = 0; rank < end.split_fans.size(); ++rank) {
        const Index f = end.split_fans[rank], before = begin.split_rank[f];
        PointState* state = end.points.data() + end.first_point[rank];
        const PointState* start = before < 0 ? nullptr : begin.points.data() + begin.first_point[before];
        for (const FanPoint& at : model.points(model.fans[f])) {
            PointState& now = *state++;
            const double slid = start ? (start++)->slid : 0;
            if (model.laws[at.law].slip_distance == 0) continue;
            const Rotation frame = point_frame(model, begin, at);
            const double slip = end.opening_of(at, frame).y() - begin.opening_of(at, frame).y();
            // islands took smaller steps than the rigid one, and have the ways of theirs
            const double own = begin.motion == Motion::rigid ? now.slid : 0;
            now.slid = std::max(own, slid + std::abs(slip));
        }
    }
}

}  // namespace knap
