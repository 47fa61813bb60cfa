#include "stepper/common/obstacle_pairs.hpp"

#include "model/obstacle_gap.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

using PairKind = Outline::Kind;

constexpr double near_pair = 0.02;         // [-] of the half width of the smaller one: nearer ones are candidates
constexpr double pair_reach_in_steps = 4;  // distances covered in a step at the speeds of its start
constexpr double same_depth = 1e-3;        // [-] of the half width: sides that are as far away; the first one is taken
constexpr double pair_rounding = 1e-12;    // [-] of the coordinates whose difference is a gap

/// A point of `second` that faces `first`.
struct Facing {
    Vec2 point;   // [m] of the second one
    Vec2 normal;  // out of the first
    double gap;   // [m]
};

Vec2 corner_of(const ObstacleSurface& polygon, std::size_t i) {
    const std::vector<Vec2>& points = polygon.outline().points;
    return polygon.position() + polygon.rotation().turned(points[i % points.size()]);
}
std::size_t n_corners(const ObstacleSurface& polygon) { return polygon.outline().points.size(); }

Vec2 outward_of_side(const ObstacleSurface& polygon, std::size_t i) {
    return -turned_left((corner_of(polygon, i + 1) - corner_of(polygon, i)).normalized());
}

struct FurthestSide {
    std::size_t number;
    double gap;  // [m] of the other polygon
};

/// The side of a polygon from which another one is furthest.
FurthestSide furthest_side(const ObstacleSurface& polygon, const ObstacleSurface& other) {
    FurthestSide found{0, -infinity};
    for (std::size_t i = 0; i < n_corners(polygon); ++i) {
        const Vec2 at = corner_of(polygon, i), outward = outward_of_side(polygon, i);
        double gap = infinity;
        for (std::size_t j = 0; j < n_corners(other); ++j) gap = std::min(gap, outward.dot(corner_of(other, j) - at));
        if (gap > found.gap) found = {i, gap};
    }
    return found;
}

/// The facing side of `other`, clipped to what lies beside the side i of `polygon` or beyond its ends by `reach`.
void clip(const ObstacleSurface& polygon, std::size_t i, const ObstacleSurface& other, double reach,
          std::vector<Facing>& found) {
    const Vec2 a = corner_of(polygon, i), along = corner_of(polygon, i + 1) - a, normal = outward_of_side(polygon, i);
    const double length = along.norm();
    std::size_t facing = 0;
    double most = infinity;
    for (std::size_t j = 0; j < n_corners(other); ++j)
        if (const double product = normal.dot(outward_of_side(other, j)); product < most) most = product, facing = j;
    const Vec2 from = corner_of(other, facing), to = corner_of(other, facing + 1);
    const auto place = [&](const Vec2& x) { return along.dot(x - a) / length; };  // [m] along the side
    const double s_from = place(from), s_to = place(to);
    const auto add = [&](const Vec2& x) { found.push_back({x, normal, normal.dot(x - a)}); };
    const auto clipped = [&](const Vec2& x, double s, const Vec2& towards, double s_towards) {
        const double end = std::clamp(s, -reach, length + reach);
        if (s == end) return add(x);
        if ((s_towards - end) * (s - end) < 0) add(x + (end - s) / (s_towards - s) * (towards - x));
    };
    clipped(from, s_from, to, s_to), clipped(to, s_to, from, s_from);
}

/// What of `second` faces `first`, or with the roles exchanged: true.
bool find_facing(const ObstacleSurface& first, const ObstacleSurface& second, double reach, double tolerance,
                 std::vector<Facing>& found) {
    found.clear();
    const PairKind kind_1 = first.outline().kind, kind_2 = second.outline().kind;
    if (kind_2 == PairKind::disc) {
        const auto [gap, normal] = first.distance_to(second.position());
        const double radius = second.outline().radius;
        found.push_back({second.position() - radius * normal, normal, gap - radius});
        return false;
    }
    if (kind_1 == PairKind::disc || kind_2 == PairKind::half_plane) {
        find_facing(second, first, reach, tolerance, found);
        return true;
    }
    if (kind_1 == PairKind::half_plane) {
        for (std::size_t j = 0; j < n_corners(second); ++j) {
            const Vec2 x = corner_of(second, j);
            const auto [gap, normal] = first.distance_to(x);
            found.push_back({x, normal, gap});
        }
        return false;
    }
    const FurthestSide of_first = furthest_side(first, second), of_second = furthest_side(second, first);
    const bool exchanged = of_second.gap > of_first.gap + tolerance;
    if (exchanged) clip(second, of_second.number, first, reach, found);
    else clip(first, of_first.number, second, reach, found);
    return exchanged;
}

}  // namespace

ObstaclePairs::ObstaclePairs(const Model& model) : model_(model), pairs_(obstacles_that_may_meet(model.obstacles)) {
    for (const Obstacle& obstacle : model.obstacles)
        half_width_.push_back(obstacle.outline.kind == PairKind::half_plane ? infinity : obstacle.outline.half_width());
}

void ObstaclePairs::find(const State& begin, double h, const std::vector<Vec3>& rate) {
    contacts_.clear();
    std::vector<Facing> found;
    const auto surface = [&](Index o) { return ObstacleSurface(model_.obstacles[o].outline, begin.obstacles[o].pose); };
    for (const auto& pair : pairs_) {
        const std::array<ObstacleSurface, 2> of{surface(pair[0]), surface(pair[1])};
        const std::array<Vec3, 2> v{begin.obstacles[pair[0]].velocity, begin.obstacles[pair[1]].velocity};
        const double size = std::min(half_width_[pair[0]], half_width_[pair[1]]);
        double speed = 0;
        for (int k = 0; k < 2; ++k)
            for (const Vec3& w : {v[k], rate[pair[k]]})
                speed += w.head<2>().norm() + std::abs(w.z()) * std::min(of[0].radius(), of[1].radius());
        const double reach = near_pair * size + pair_reach_in_steps * h * speed;
        const int bounded =
            of[0].outline().kind == PairKind::half_plane;  // a half plane tells its distance to the other
        if (!of[1 - bounded].may_reach(of[bounded].position(), of[bounded].radius() + reach)) continue;
        const bool exchanged = find_facing(of[0], of[1], reach, same_depth * size, found);
        const int one = exchanged, two = 1 - exchanged;
        const Vec2 &x_1 = of[one].position(), &x_2 = of[two].position();
        for (const Facing& at : found) {
            if (at.gap > reach) continue;
            const bool rolls =
                of[two].outline().kind == PairKind::disc;  // the point of contact does not turn with a disc
            const Vec2 motion = rolls ? Vec2(v[two].head<2>()) : velocity_at(v[two], at.point - x_2);
            Vec2 normal = Rotation::by(0.5 * h * v[one].z()).turned(at.normal);
            if (of[one].outline().kind == PairKind::disc)
                normal = (x_2 - x_1 + 0.5 * h * (v[two] - v[one]).head<2>()).normalized();
            const Vec2 middle = at.point - 0.5 * at.gap * at.normal + 0.5 * h * motion;
            const double rounding = pair_rounding * (x_1.norm() + x_2.norm());
            contacts_.push_back(
                {.obstacle = {pair[one], pair[two]},
                 .arm = {middle - (x_1 + 0.5 * h * v[one].head<2>()), middle - (x_2 + 0.5 * h * v[two].head<2>())},
                 .normal = normal,
                 .gap = std::abs(at.gap) <= rounding ? 0 : at.gap});
        }
    }
}

}  // namespace knap
