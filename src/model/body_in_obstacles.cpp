#include "model/body_in_obstacles.hpp"

#include "base/union_find.hpp"
#include "mesh/polygon.hpp"
#include "model/body_edges.hpp"
#include "model/obstacle_gap.hpp"
#include "model/selections.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr double rounding_of_size = 1e-6, rounding_of_edge = 1e-2;  // [-] overlaps at the start that count as none
constexpr int max_places = 500;                                     // on the way of an obstacle
constexpr double cannot_give_way = 1e-3;                            // [-] component of a normal

std::vector<ObstacleSurface> surfaces_of(const Model& model, const State* state) {
    std::vector<ObstacleSurface> surfaces;
    for (std::size_t o = 0; o < model.obstacles.size(); ++o)
        surfaces.emplace_back(model.obstacles[o].outline, state ? state->obstacles[o].pose : model.obstacles[o].start);
    return surfaces;
}

void visit_boundary(const Mesh& mesh, const auto& visit) {
    for (const BoundaryEdge& edge : mesh.boundary_edges) visit_side(mesh, edge.triangle, edge.side, visit);
}

/// Both sides of the interfaces that have come apart; some of them twice.
void visit_open_faces(const Model& model, const State& state, const auto& visit) {
    for (const Index f : state.split_fans)
        for (const FanPoint& point : model.points(model.fans[f])) {
            if (point.on_support() || state.displacement_of(point.after) == state.displacement_of(point.before))
                continue;
            visit_faces(model.mesh, model.interfaces[model.interface_of(point.point)],
                        [&](Index t, Index k) { visit_side(model.mesh, t, k, visit); });
        }
}

/// Whether neither end of an edge gives way to a push along its normal, but one may slip under it.
bool is_held_alone_along_normal(const Model& model, Index a, Index b) {
    const Vec2 normal = turned_left((model.mesh.corner(b) - model.mesh.corner(a)).normalized());
    const auto gives_way = [&](const Vec2& along) {
        return std::ranges::any_of(std::array{a, b}, [&](Index corner) {
            const PrescribedMotion* motion = model.motion_of(corner);
            return !motion || (!motion->component[0] && std::abs(along.x()) >= cannot_give_way) ||
                   (!motion->component[1] && std::abs(along.y()) >= cannot_give_way);
        });
    };
    return !gives_way(normal) && gives_way(turned_left(normal));
}

/// What comes first on the way of a free obstacle, if it is held.
std::optional<HeldAgainst> held_on_way(const Model& model, Index number, double end) {
    using What = HeldAgainst::What;
    const Obstacle& obstacle = model.obstacles[number];
    const ObstacleState start = initial_state(obstacle);
    Vec3 acceleration = force_at(obstacle, infinity);
    for (int k = 0; k < 3; ++k)
        if (obstacle.is_free(k)) acceleration[k] /= obstacle.inertia_of(k);
    const auto way = [&](double t) -> Vec3 { return t * start.velocity + 0.5 * t * t * acceleration; };
    const auto length = [&] {  // [m] at most
        return end * (start.velocity.head<2>().norm() + 0.5 * end * acceleration.head<2>().norm());
    };
    const Box box = bounding_box(model.mesh.vertices);
    const double beyond = 2 * box.diagonal() + (start.pose.position - 0.5 * (box.low + box.high)).norm();
    while (length() > beyond) end *= 0.9;  // where it has passed the body
    const int n = static_cast<int>(
        std::clamp(std::ceil(4 * length() / obstacle.outline.half_width()), 1.0, static_cast<double>(max_places)));
    for (int i = 1; i <= n; ++i) {
        ObstacleState now = start;
        move(obstacle, way(end * i / n), now);
        const ObstacleSurface surface(obstacle.outline, now.pose);
        double deepest = 0;
        std::optional<HeldAgainst> held;
        const auto look = [&](const Vec2& a, const Vec2& b, const auto& what) {
            if (!surface.may_reach(a, (b - a).norm())) return;
            const auto [gap, place] = gap_to_edge(surface, a, b);
            if (!(gap < deepest)) return;
            deepest = gap, held.reset();
            if (const std::optional<What> found = what()) held = {*found, number, place};
        };
        visit_boundary(model.mesh, [&](Index a, Index b) {
            look(model.mesh.corner(a), model.mesh.corner(b),
                 [&] { return is_held_alone_along_normal(model, a, b) ? std::optional(What::edge) : std::nullopt; });
        });
        for (const GroundVertex& v : model.ground.vertices)
            if (v.has_face)
                look(v.place, model.ground.vertices[v.next].place, [] { return std::optional(What::support); });
        if (deepest < 0) return held;
    }
    return std::nullopt;
}

}  // namespace

void for_edges_in_obstacles(const Model& model, const State* state,
                            const std::function<void(const EdgeInObstacle&)>& visit) {
    if (model.obstacles.empty()) return;
    const std::vector<ObstacleSurface> surfaces = surfaces_of(model, state);
    const auto place = [&](Index c) -> Vec2 {
        return state ? Vec2(model.mesh.corner(c) + state->displacement_of(c)) : model.mesh.corner(c);
    };
    const auto is_in_body = [&](const Vec2& x) {
        for (Index t = 0; t < model.mesh.n_triangles(); ++t) {
            const Index first = model.mesh.corners_per_triangle() * t;
            const std::array<Vec2, 3> at{place(first), place(first + 1), place(first + 2)};
            const auto is_left_of = [&](int k) { return cross(at[(k + 1) % 3] - at[k], x - at[k]) >= 0; };
            if (is_left_of(0) && is_left_of(1) && is_left_of(2) && !model.has_vanished(t)) return true;
        }
        return false;
    };
    std::vector<std::uint8_t> near;  // of rigid pieces: each by all obstacles
    for (std::size_t p = 0; state && p < state->rigid_pieces.size(); ++p)
        for (const ObstacleSurface& surface : surfaces)  // an edge and its length beyond it
            near.push_back(surface.may_reach(state->rigid_pieces[p].centre, 3 * state->frozen->pieces[p].radius));
    const auto look = [&](Index a, Index b) {
        const std::uint8_t* of_piece =
            near.empty() ? nullptr
                         : near.data() + surfaces.size() * state->frozen->piece_of_triangle[model.mesh.triangle_of(a)];
        if (of_piece && std::none_of(of_piece, of_piece + surfaces.size(), [](auto is_near) { return is_near; }))
            return;
        const Vec2 x_a = place(a), x_b = place(b);
        const double length = (x_b - x_a).norm();
        for (std::size_t o = 0; o < surfaces.size() && length > 0; ++o) {
            if ((of_piece && !of_piece[o]) || !surfaces[o].may_reach(x_a, length)) continue;
            const auto [gap, where] = gap_to_edge(surfaces[o], x_a, x_b, is_in_body);
            if (gap < 0) visit({static_cast<Index>(o), {a, b}, length, -gap, where});
        }
    };
    visit_boundary(model.mesh, look);
    if (state) visit_open_faces(model, *state, look);
}

std::optional<StartOverlap> overlap_at_start(const Model& model) {
    const Mesh& mesh = model.mesh;
    const double size = bounding_box(mesh.vertices).diagonal();
    std::optional<StartOverlap> deepest;
    const auto add = [&](Index obstacle, double depth, const Vec2& place) {
        if (!deepest || depth > deepest->depth) deepest = {obstacle, depth, place};
    };
    for_edges_in_obstacles(model, nullptr, [&](const EdgeInObstacle& at) {
        const double rounding = std::min(rounding_of_size * size, rounding_of_edge * at.length);
        const Obstacle& obstacle = model.obstacles[at.obstacle];
        const ObstacleSurface surface(obstacle.outline, obstacle.start);
        const auto touches = [&](Index c) { return std::abs(surface.distance_to(mesh.corner(c)).gap) <= rounding; };
        // a disc that fits a round hole touches it at its nodes: the edges are chords
        const bool fits = obstacle.outline.kind == Outline::Kind::disc && std::ranges::all_of(at.corner, touches);
        if (at.depth > rounding && !fits) add(at.obstacle, at.depth, at.place);
    });
    for (std::size_t o = 0; o < model.obstacles.size() && !deepest; ++o) {  // no edge crosses them
        const Obstacle& obstacle = model.obstacles[o];
        if (obstacle.outline.kind == Outline::Kind::polyline) {  // below a terrain
            const ObstacleSurface surface(obstacle.outline, obstacle.start);
            visit_boundary(mesh, [&](Index a, Index) {
                const double gap = surface.distance_to(mesh.corner(a)).gap;
                if (gap < -rounding_of_size * size) add(static_cast<Index>(o), -gap, mesh.corner(a));
            });
        }
        if (!obstacle.outline.is_bounded()) continue;
        const Vec2& x = obstacle.start.position;
        for (Index t = 0; t < mesh.n_triangles(); ++t) {
            if (!in_triangle(mesh, t, x)) continue;
            double to_boundary = infinity;
            visit_boundary(mesh, [&](Index a, Index b) {
                to_boundary = std::min(to_boundary, distance_to_segment(mesh.corner(a), mesh.corner(b), x));
            });
            add(static_cast<Index>(o), to_boundary + obstacle.outline.half_width(), x);
        }
    }
    return deepest;
}

std::vector<HeldAgainst> held_against_obstacles(const Model& model, double end) {
    std::vector<HeldAgainst> found;
    if (model.prescribed.empty() && model.ground.vertices.empty()) return found;
    for (Index o = 0; o < static_cast<Index>(model.obstacles.size()); ++o)
        if (model.obstacles[o].is_free())
            if (const std::optional<HeldAgainst> held = held_on_way(model, o, end)) found.push_back(*held);
    return found;
}

}  // namespace knap
