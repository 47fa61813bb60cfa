#include "stepper/implicit/turned_points.hpp"

#include <cmath>
#include <numeric>

namespace knap {
namespace {

constexpr double same_turn = 1e-2;  // [rad] of a point and of its fan: strains turn them by less

}  // namespace

void TurnedPoints::set(const State& begin, double h, const std::vector<Vec2>& corner_rate) {
    begin_ = &begin, h_ = h;
    if (end_.node_of_corner.empty()) {
        end_.node_of_corner.resize(corner_rate.size());
        std::iota(end_.node_of_corner.begin(), end_.node_of_corner.end(), 0);
    }
    end_.displacement.clear();
    for (std::size_t c = 0; c < corner_rate.size(); ++c)
        end_.displacement.push_back(begin.displacement[begin.node_of_corner[c]] + h * corner_rate[c]);
}

PointTurn TurnedPoints::of(Index fan, const FanPoint& point) const {
    const Rotation at_begin = point_frame(model_, *begin_, point),
                   own = from_to(at_begin, point_frame(model_, end_, point));
    Rotation turns = turn(fan);
    if (std::abs(angle_of(from_to(turns, own))) > same_turn) turns = own;
    const Rotation middle = composed(half_of(turns), at_begin);
    const auto jump = [&](const State& state) -> Vec2 {
        return state.displacement_of(point.after) - state.displacement_of(point.before);
    };
    const Vec2 before = jump(*begin_);
    if (before.isZero(0)) return {middle, Vec2::Zero()};  // its sides were one so far
    const double tangent = turns.sine / (1 + turns.cosine);
    const Vec2 rate = tangent / h_ * turned_left(before + jump(end_)), normal = middle.turned(point.normal);
    return {middle, {normal.dot(rate), turned_left(normal).dot(rate)}};
}

}  // namespace knap
