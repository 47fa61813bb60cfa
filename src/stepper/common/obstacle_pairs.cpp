#include "stepper/common/obstacle_pairs.hpp"
#include "model/make_ground.hpp"

#include "model/obstacle_gap.hpp"
#include "stepper/common/contact_search.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace knap {
namespace {

using PairKind = Outline::Kind;

/// A point of one obstacle that faces another one.
struct Facing {
    int of;       // 0, 1: the other one, whose surface it faces
    Vec2 point;   // [m]
    Vec2 normal;  // out of the other one
    double gap;   // [m]
};

std::size_t n_corners(const ObstacleSurface& polygon) { return polygon.outline().points.size(); }

using Two = std::array<ObstacleSurface, 2>;

/// The facing side of the other one, clipped to what lies beside side i of polygon `of` or beyond its ends by `reach`.
void clip(const Two& pair, int of, std::size_t i, double reach, std::vector<Facing>& found) {
    const ObstacleSurface &polygon = pair[of], &other = pair[1 - of];
    const PlacedEdge side = polygon.side(i);
    PlacedEdge facing = other.side(0);
    for (std::size_t j = 1; j < n_corners(other); ++j)
        if (const PlacedEdge next = other.side(j); side.outward.dot(next.outward) < side.outward.dot(facing.outward))
            facing = next;
    const double s_from = side.place(facing.start), s_to = side.place(facing.end);
    const auto add = [&](const Vec2& x) { found.push_back({of, x, side.outward, side.gap(x)}); };
    const auto clipped = [&](const Vec2& x, double s, const Vec2& towards, double s_towards) {
        const double end = std::clamp(s, -reach, side.length + reach);
        if (s == end) return add(x);
        if ((s_towards - end) * (s - end) < 0) add(x + (end - s) / (s_towards - s) * (towards - x));
    };
    clipped(facing.start, s_from, facing.end, s_to), clipped(facing.end, s_to, facing.start, s_from);
}

/// A disc against the sides of polyline `line` beside its centre and the corners in whose cones it lies.
void find_on_line(const Two& pair, int line, double reach, std::vector<Facing>& found) {
    const ObstacleSurface &ground = pair[line], &disc = pair[1 - line];
    const double radius = disc.outline().radius;
    const Vec2& centre = disc.position();
    ground.visit_beside(centre, radius + reach, [&](const SurfaceDistance& at) {
        found.push_back({line, centre - radius * at.normal, at.normal, at.gap - radius});
    });
    ground.visit_corners(centre, radius + reach, [&](std::size_t i) {
        const Vec2 away = centre - ground.corner(i);
        const double distance = away.norm();
        if (distance > radius + reach || ground.any_side_at(i, [&](const Vec2& side) { return side.dot(away) > 0; }))
            return;
        const Vec2 normal = away / distance;
        found.push_back({line, centre - radius * normal, normal, distance - radius});
    });
}

/// Corners of a polygon on the sides of polyline `line`, and its corners on sides of the polygon.
void find_on_terrain(const Two& pair, int line, double reach, double tolerance, std::vector<Facing>& found) {
    const ObstacleSurface &ground = pair[line], &polygon = pair[1 - line];
    const double depth = polygon.outline().half_width();
    for (std::size_t j = 0; j < n_corners(polygon); ++j) {
        const Vec2 x = polygon.place(j);
        ground.visit_planes(x, Vec2::Zero(), tolerance, reach, depth, [&](const SurfaceDistance& at) {
            found.push_back({line, x, at.normal, at.gap});
        });
    }
    ground.visit_corners(polygon.position(), polygon.radius() + reach, [&](std::size_t i) {
        const Vec2 x = ground.corner(i);
        const auto [number, gap, nearest] = polygon.furthest_side([&](const Vec2&) { return x; });
        if (gap > reach || gap < -depth) return;
        const PlacedEdge side = polygon.side(number);
        const double share = side.share(x);
        if (share <= tolerance / depth || share >= 1 - tolerance / depth) return;  // a corner has planes of the ground
        if (ground.protrudes(i, side.outward)) found.push_back({1 - line, x, side.outward, gap});
    });
}

/// What of two obstacles faces the other one.
void find_facing(const Two& pair, double reach, double tolerance, std::vector<Facing>& found) {
    found.clear();
    const auto is = [&](int k, PairKind kind) { return pair[k].outline().kind == kind; };
    for (const int k : {0, 1})
        if (pair[k].outline().line) {
            if (is(1 - k, PairKind::disc)) find_on_line(pair, k, reach, found);
            else if (is(1 - k, PairKind::polygon)) find_on_terrain(pair, k, reach, tolerance, found);
            return;
        }
    for (const int k : {1, 0})
        if (is(k, PairKind::disc)) {
            const auto [gap, normal] = pair[1 - k].distance_to(pair[k].position());
            const double radius = pair[k].outline().radius;
            return found.push_back({1 - k, pair[k].position() - radius * normal, normal, gap - radius});
        }
    for (const int k : {1, 0})
        if (is(k, PairKind::half_plane)) {
            if (is(1 - k, PairKind::half_plane)) return;
            for (std::size_t j = 0; j < n_corners(pair[1 - k]); ++j) {
                const Vec2 x = pair[1 - k].place(j);
                const auto [gap, normal] = pair[k].distance_to(x);
                found.push_back({k, x, normal, gap});
            }
            return;
        }
    const auto furthest = [&](int k) {
        return pair[k].furthest_side([&](const Vec2& outward) { return pair[1 - k].furthest(-outward); });
    };
    const auto of_first = furthest(0), of_second = furthest(1);
    if (of_second.gap > of_first.gap + tolerance) clip(pair, 1, of_second.number, reach, found);
    else clip(pair, 0, of_first.number, reach, found);
}

}  // namespace

ContactLaw law_between(const Model& model, const ObstaclePairContact& contact, const State& begin) {
    const auto law_of = [&](int k) -> const ContactLaw& {
        const Index o = contact.obstacle[k];
        if (o < 0) return contact.support->contact;
        return model.obstacles[o].law_at(contact.arm[k], begin.obstacles[o].pose.angle);
    };
    return law_between(law_of(0), law_of(1));
}

ObstaclePairs::ObstaclePairs(const Model& model, Supports supports) : model_(model) {
    if (supports == Supports::meet) supports_ = obstacles_of_ground(model);
    pairs_ = obstacles_that_may_meet(model.obstacles, supports_);
    for (const std::vector<Obstacle>* all : {&model.obstacles, &std::as_const(supports_)})
        for (const Obstacle& obstacle : *all)
            half_width_.push_back(obstacle.outline.is_bounded() ? obstacle.outline.half_width() : infinity);
}

void ObstaclePairs::find(const State& begin, double h, const std::vector<Vec3>& rate) {
    assert(rate.size() == model_.obstacles.size());
    contacts_.clear();
    std::vector<Facing> found;
    const auto n = static_cast<Index>(model_.obstacles.size());
    const auto surface = [&](Index o) -> ObstacleSurface {
        if (o >= n) return {supports_[o - n].outline, {}};
        return {model_.obstacles[o].outline, begin.obstacles[o].pose};
    };
    const auto moving = [&](const std::vector<Vec3>& all, Index o) { return o < n ? all[o] : Vec3(Vec3::Zero()); };
    const auto velocity = [&](Index o) { return o < n ? begin.obstacles[o].velocity : Vec3(Vec3::Zero()); };
    for (const auto& pair : pairs_) {
        const Two of{surface(pair[0]), surface(pair[1])};
        const std::array<Vec3, 2> v{velocity(pair[0]), velocity(pair[1])};
        const double size = std::min(half_width_[pair[0]], half_width_[pair[1]]);
        double speed = 0;
        for (int k = 0; k < 2; ++k)
            for (const Vec3& w : {v[k], moving(rate, pair[k])})
                speed += w.head<2>().norm() + std::abs(w.z()) * std::min(of[0].radius(), of[1].radius());
        const double reach = near_contact * size + contact_reach_in_steps * h * speed;
        const int bounded = !of[0].outline().is_bounded();  // what is not tells its distance to the other
        if (!of[1 - bounded].may_reach(of[bounded].position(), of[bounded].radius() + reach)) continue;
        find_facing(of, reach, touching_part * size, found);
        for (const Facing& at : found) {
            if (at.gap > reach) continue;
            const int one = at.of, two = 1 - at.of;
            const Vec2 &x_1 = of[one].position(), &x_2 = of[two].position();
            const bool rolls =
                of[two].outline().kind == PairKind::disc;  // the point of contact does not turn with a disc
            const Vec2 motion = rolls ? Vec2(v[two].head<2>()) : velocity_at(v[two], at.point - x_2);
            Vec2 normal = Rotation::by(0.5 * h * v[one].z()).turned(at.normal);
            if (of[one].outline().kind == PairKind::disc)
                normal = (x_2 - x_1 + 0.5 * h * (v[two] - v[one]).head<2>()).normalized();
            const Vec2 middle = at.point - 0.5 * at.gap * at.normal + 0.5 * h * motion;
            const auto number = [&](int k) { return pair[k] < n ? pair[k] : Index(-1); };
            contacts_.push_back(
                {.obstacle = {number(one), number(two)},
                 .arm = {middle - (x_1 + 0.5 * h * v[one].head<2>()), middle - (x_2 + 0.5 * h * v[two].head<2>())},
                 .normal = normal,
                 .gap = without_rounding(at.gap, x_1.norm() + x_2.norm()),
                 .size = size,
                 .support = pair[1] < n ? nullptr : &supports_[pair[1] - n]});
        }
    }
}

}  // namespace knap
