#include "stepper/contact/retirement.hpp"

#include "base/parallel.hpp"

namespace knap {
namespace {

constexpr double retirement_turn = 0.002;  // [rad]
constexpr double parting_slip = 0.02;      // [-] of the edge
constexpr double parting_turn = 0.2;       // [rad] no corner of a usual triangle is sharper
constexpr std::ptrdiff_t block = 256;      // fans

Index next_in_triangle(Index c) { return c % 3 == 2 ? c - 2 : c + 1; }
Index previous_in_triangle(Index c) { return c % 3 == 0 ? c + 2 : c - 1; }

/// The two sides of a point, moved.
struct Sides {
    Sides(const Model& model, const State& state, const FanPoint& point) : model(model), state(state), point(point) {}

    bool slipped(double part_of_edge) const {
        const double most = part_of_edge * 2 * point.area / model.thickness;  // the area of a point is half the edge's
        return (state.displacement_of(point.after) - state.displacement_of(point.before)).squaredNorm() > most * most;
    }
    /// The edge leaves the corner `after` and enters the corner `before`, each in its own triangle; a support does not
    /// turn.
    bool turned(double angle) const {
        const auto place = [&](Index c) -> Vec2 { return model.mesh.corner(c) + state.displacement_of(c); };
        const auto along = [&](Index c, Index other) -> Vec2 { return place(other) - place(c); };
        const auto at_rest = [&](Index c, Index other) -> Vec2 {
            return model.mesh.corner(other) - model.mesh.corner(c);
        };
        const Index before = point.before, after = point.after;
        const Vec2 along_after = after == rigid_support ? at_rest(before, previous_in_triangle(before))
                                                        : along(after, next_in_triangle(after)),
                   along_before = before == rigid_support ? at_rest(after, next_in_triangle(after))
                                                          : along(before, previous_in_triangle(before));
        return std::abs(cross(along_after, along_before)) > angle * along_after.dot(along_before);
    }

    const Model& model;
    const State& state;
    const FanPoint& point;
};

}  // namespace

void retire_points(const Model& model, const std::vector<std::uint8_t>& before, State& end) {
    if (model.contact_of_pair.empty()) return;
    end.retired = before;  // for good
    const std::ptrdiff_t n = std::ssize(end.split_fans);
    for_blocks((n + block - 1) / block, [&](std::ptrdiff_t b) {
        for (std::ptrdiff_t rank = b * block; rank < std::min(n, (b + 1) * block); ++rank) {
            const Fan& fan = model.fans[end.split_fans[rank]];
            const PointState* state = end.points.data() + end.first_point[rank];
            for (const FanPoint& point : model.points(fan)) {
                const double cohesion = (state++)->cohesion;
                std::uint8_t& retired = end.retired[point.point];
                if (retired == 1) continue;
                const Sides sides(model, end, point);
                // sides that turn by so much have slipped at one end of the edge
                const bool may_have_turned = before[point.point] != 0 || before[point.point ^ 1] != 0;
                if (cohesion == 0 && (sides.slipped(retirement_slip) || sides.turned(retirement_turn))) retired = 1;
                else if (sides.slipped(parting_slip) || (may_have_turned && sides.turned(parting_turn))) retired = 2;
            }
        }
    });
}

}  // namespace knap
