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

bool is_far(const Model& model, const State& state, const FanPoint& point, double slip, double turn) {
    const auto place = [&](Index c) -> Vec2 { return model.mesh.corner(c) + state.displacement_of(c); };
    const Vec2 x_after = place(point.after), x_before = place(point.before);
    // the edge leaves the corner `after` and enters the corner `before`, each in its own triangle
    const Vec2 along_after = place(next_in_triangle(point.after)) - x_after,
               along_before = place(previous_in_triangle(point.before)) - x_before;
    const double length = model.interfaces[model.interface_of(point.point)].length;
    return (x_after - x_before).squaredNorm() > slip * slip * length * length ||
           std::abs(cross(along_after, along_before)) > turn * along_after.dot(along_before);
}

}  // namespace

void retire_points(const Model& model, State& end) {
    if (model.contact_of_pair.empty()) return;
    if (end.retired.empty()) end.retired.assign(model.n_points(), 0);
    const std::ptrdiff_t n = std::ssize(end.split_fans);
    for_blocks((n + block - 1) / block, [&](std::ptrdiff_t b) {
        for (std::ptrdiff_t rank = b * block; rank < std::min(n, (b + 1) * block); ++rank) {
            const Fan& fan = model.fans[end.split_fans[rank]];
            const PointState* state = end.points.data() + end.first_point[rank];
            for (const FanPoint& point : model.points(fan)) {
                const double cohesion = (state++)->cohesion;
                std::uint8_t& retired = end.retired[point.point];
                if (retired == 1 || point.on_support()) continue;
                if (cohesion == 0 && is_far(model, end, point, retirement_slip, retirement_turn)) retired = 1;
                else if (is_far(model, end, point, parting_slip, parting_turn)) retired = 2;
            }
        }
    });
}

}  // namespace knap
