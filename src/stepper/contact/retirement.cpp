#include "stepper/contact/retirement.hpp"

#include "base/parallel.hpp"
#include "base/tolerance.hpp"

#include <array>

namespace knap {
namespace {

constexpr double inner_overlap = 0.005;    // [-] of an edge
constexpr double rounded_down = 1 - 1e-6;  // less than the rounding of a bound takes away
constexpr double parting_slip = 0.02;      // [-] of the edge
constexpr double parting_turn =
    0.2;  // [rad] what comes into the crack is a corner, and those of usual triangles are blunter
constexpr std::ptrdiff_t block = 256;  // fans

/// Mesh::corner of a triangle of first order.
const Vec2& undeformed(const Model& model, Index c) { return model.mesh.vertices[model.mesh.triangles[c / 3][c % 3]]; }

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
        if (surely_turned_less(angle)) return false;
        const auto place = [&](Index c) -> Vec2 { return undeformed(model, c) + state.displacement_of(c); };
        const auto along = [&](Index c, Index other) -> Vec2 { return place(other) - place(c); };
        const auto at_rest = [&](Index c, Index other) -> Vec2 {
            return undeformed(model, other) - undeformed(model, c);
        };
        const Index before = point.before, after = point.after;
        const Vec2 along_after = after == rigid_support ? at_rest(before, previous_in_triangle(before))
                                                        : along(after, next_in_triangle(after)),
                   along_before = before == rigid_support ? at_rest(after, next_in_triangle(after))
                                                          : along(before, previous_in_triangle(before));
        return std::abs(cross(along_after, along_before)) > angle * along_after.dot(along_before);
    }

    /// From the displacements alone. With A the edge of the side `after` and J the change of the opening along it,
    /// |A x (A + J)| <= |A||J| and A.(A + J) >= |A|(|A| - |J|); |A| is the length at rest less the motion of its ends.
    bool surely_turned_less(double angle) const {
        const Index before = point.before, after = point.after;
        if (before == rigid_support || after == rigid_support) return false;
        const Vec2 change = state.displacement_of(next_in_triangle(after)) - state.displacement_of(after),
                   other = state.displacement_of(previous_in_triangle(before)) - state.displacement_of(before);
        const double J = (other - change).lpNorm<1>(), A = 2 * point.area / model.thickness - change.lpNorm<1>();
        return (1 + angle) * J < rounded_down * angle * A;
    }

    bool moved(double limit) const { return slipped(limit) || turned(limit); }

    const Model& model;
    const State& state;
    const FanPoint& point;
};

/// Two corners that are no neighbours in their fan lie in each other by more than a part of an edge. They are disjoint
/// in the undeformed body, so an edge of one of them separates them (separating axis theorem); the edge of the least
/// overlap counts.
bool overlap(const Model& model, const State& state, Index one, Index two, double limit) {
    const auto along = [&](Index c, Index end) -> Vec2 { return undeformed(model, end) - undeformed(model, c); };
    bool any_separates = false;
    for (const auto& [own, other] : {std::array{one, two}, std::array{two, one}}) {
        const Vec2 apart = state.displacement_of(other) - state.displacement_of(own),
                   leaving = along(own, next_in_triangle(own)), entering = along(own, previous_in_triangle(own));
        for (const Vec2& outward : {Vec2(-turned_left(leaving)), turned_left(entering)}) {
            const Vec2 n = outward / outward.squaredNorm();
            const bool is_more = -n.dot(apart) > limit;
            if (is_more && any_separates) continue;
            const auto lies_outside = [&, other = other](Index end) {
                const Vec2 edge = along(other, end);
                const double height = outward.dot(edge);
                return height >= 0 || height >= -geometric_rounding * outward.norm() * edge.norm();
            };
            if (!lies_outside(next_in_triangle(other)) || !lies_outside(previous_in_triangle(other))) continue;
            if (!is_more) return false;
            any_separates = true;
        }
    }
    return any_separates;
}

/// [m] The way between two corners that may overlap: an overlap is at most this way over the length of an edge. The
/// shortest edge with a point counts (in a closed fan all edges at its vertex have one).
double overlap_way(const Model& model, const Fan& fan) {
    double area = infinity;  // half an edge
    for (const FanPoint& point : model.points(fan)) area = std::min(area, point.area);
    return rounded_down * inner_overlap * 2 * area / model.thickness;
}

/// Of a closed fan.
bool may_overlap(const Model& model, const State& state, const Fan& fan) {
    const double apart = overlap_way(model, fan);
    const Vec2& first = state.displacement[state.node_of_corner[model.corners(fan)[0]]];
    return std::ranges::any_of(model.corners(fan), [&](Index c) {
        return (state.displacement[state.node_of_corner[c]] - first).squaredNorm() > 0.25 * apart * apart;
    });
}

/// Of a closed fan.
bool nonadjacent_corners_overlap(const Model& model, const State& state, const Fan& fan) {
    if (!may_overlap(model, state, fan)) return false;
    const auto corners = model.corners(fan);
    for (Index i = 0; i < fan.n_corners; ++i)
        for (Index j = i + 2; j < fan.n_corners; ++j) {
            const bool are_neighbours = fan.closed && i == 0 && j + 1 == fan.n_corners;
            if (!are_neighbours && overlap(model, state, corners[i], corners[j], inner_overlap)) return true;
        }
    return false;
}

/// [-] The slip and the turn [rad] at which the broken points of a fan retire now; infinity where they stay. One of
/// them alone separates no sides in a closed fan: they would be one vertex, which does not touch itself.
double retirement_limit(const Model& model, const State& state, Index rank) {
    const Fan& fan = model.fans[state.split_fans[rank]];
    const auto points = model.points(fan);
    const PointState* own = state.points.data() + state.first_point[rank];
    const auto separates = [&](double limit) {
        std::ptrdiff_t n = fan.closed ? 0 : 1;
        for (std::size_t j = 0; j < points.size(); ++j)
            n += state.retired[points[j].point] != Retirement::none ||
                 (own[j].cohesion == 0 && Sides(model, state, points[j]).moved(limit));
        return n > 1;
    };
    if (!separates(retirement_slip)) return infinity;
    const auto has_retired = [&](const FanPoint& at) { return state.retired[at.point] == Retirement::retired; };
    const bool is_apart = std::ranges::count_if(points, has_retired) > 1;
    if (!fan.closed || is_apart || nonadjacent_corners_overlap(model, state, fan)) return retirement_slip;
    return separates(inner_retirement_slip) ? inner_retirement_slip : infinity;
}

/// Whether a point that has not retired is broken, has slipped, or has a mark at one of the ends of its edge: most fans
/// have none, and nothing happens there.
bool may_change(const Model& model, const std::vector<Retirement>& before, const State& end, Index rank) {
    const PointState* state = end.points.data() + end.first_point[rank];
    return std::ranges::any_of(model.points(model.fans[end.split_fans[rank]]), [&](const FanPoint& at) {
        const double cohesion = (state++)->cohesion;
        return before[at.point] != Retirement::retired &&
               (cohesion == 0 || before[at.point] != Retirement::none || before[at.point ^ 1] != Retirement::none ||
                Sides(model, end, at).slipped(retirement_slip));
    });
}

/// Corners that points which have not retired join, but not as neighbours, overlap: nothing else keeps them apart.
bool joined_nonadjacent_corners_overlap(const Model& model, const State& state, const Fan& fan) {
    const auto points = model.points(fan);
    const auto next = [&](Index corner) {  // in the fan
        const auto at = std::ranges::find_if(points, [&](const FanPoint& point) {
            return point.before == corner && !point.on_support() && state.retired[point.point] != Retirement::retired;
        });
        return at == points.end() ? -1 : at->after;
    };
    const double apart = overlap_way(model, fan);
    const auto are_apart = [&](Index one, Index two) {
        return (state.displacement_of(one) - state.displacement_of(two)).squaredNorm() > apart * apart;
    };
    for (const Index corner : model.corners(fan)) {
        const Index neighbour = next(corner);
        if (neighbour < 0) continue;
        for (Index other = next(neighbour); other >= 0 && other != corner; other = next(other))
            if (next(other) != corner && are_apart(corner, other) &&
                overlap(model, state, corner, other, inner_overlap))
                return true;
    }
    return false;
}

/// A fan that is still one node parts, too, where the other end of an edge has retired and its sides turn about it.
void part_bonded_hinges(const Model& model, const std::vector<Retirement>& before, const Fan& fan, State& end) {
    for (const FanPoint& point : model.points(fan)) {
        if (before[point.point] != Retirement::retired) continue;
        const FanPoint& other = model.fan_points[model.fan_point_of[point.point ^ 1]];
        if (end.split_rank[model.fan_of_corner[other.corner()]] < 0 && Sides(model, end, other).turned(parting_turn))
            end.retired[other.point] = Retirement::parted;
    }
}

}  // namespace

void retire_points(const Model& model, const std::vector<Retirement>& before, State& end) {
    if (!model.faces_meet()) return;
    end.retired = before;  // for good
    const std::ptrdiff_t n = std::ssize(end.split_fans);
    for_blocks((n + block - 1) / block, [&](std::ptrdiff_t b) {
        for (std::ptrdiff_t rank = b * block; rank < std::min(n, (b + 1) * block); ++rank) {
            const Fan& fan = model.fans[end.split_fans[rank]];
            part_bonded_hinges(model, before, fan, end);
            if (!may_change(model, before, end, static_cast<Index>(rank))) continue;
            const auto points = model.points(fan);
            const PointState* state = end.points.data() + end.first_point[rank];
            const double limit = retirement_limit(model, end, static_cast<Index>(rank));
            bool strangers_may_overlap = false;  // broken points alone let no strangers move: two of them retire
            for (const FanPoint& point : points) {
                const double cohesion = (state++)->cohesion;
                Retirement& retired = end.retired[point.point];
                if (retired == Retirement::retired) continue;
                const Sides sides(model, end, point);
                // sides that turn by so much have slipped at one end of the edge
                const auto is_apart = [&] {
                    const bool may_have_turned =
                        before[point.point] != Retirement::none || before[point.point ^ 1] != Retirement::none;
                    return sides.slipped(parting_slip) || (may_have_turned && sides.turned(parting_turn));
                };
                if (cohesion == 0 && limit < infinity && sides.moved(limit)) {
                    retired = Retirement::retired;
                    continue;
                }
                if (retired == Retirement::none && is_apart()) retired = Retirement::parted;
                strangers_may_overlap = strangers_may_overlap || (cohesion > 0 && sides.slipped(inner_overlap));
            }
            if (!strangers_may_overlap || !joined_nonadjacent_corners_overlap(model, end, fan)) continue;
            for (const FanPoint& point : points)
                if (Retirement& retired = end.retired[point.point]; retired != Retirement::retired)
                    retired = Retirement::meeting;
        }
    });
}

}  // namespace knap
