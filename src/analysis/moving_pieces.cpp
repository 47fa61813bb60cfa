#include "analysis/moving_pieces.hpp"

#include "model/model.hpp"
#include "model/state.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// [m] The highest place on the outline of an obstacle at x and not above y; -infinity where there is none.
double surface_below(const Outline& outline, const Pose& pose, const Vec2& place) {
    const Rotation rotation = Rotation::by(pose.angle);
    const Vec2 from_origin = place - pose.position;
    double highest = -infinity;
    const auto add = [&](double y) {
        if (y <= place.y()) highest = std::max(highest, y);
    };
    if (outline.kind == Outline::Kind::half_plane) {
        const Vec2 normal = rotation.turned(outline.normal);
        if (normal.y() > 0) add(pose.position.y() - normal.x() / normal.y() * from_origin.x());
    } else if (outline.kind == Outline::Kind::disc) {
        const double half = outline.radius * outline.radius - from_origin.x() * from_origin.x();
        if (half >= 0) add(pose.position.y() + std::sqrt(half)), add(pose.position.y() - std::sqrt(half));
    } else {
        const std::size_t n = outline.points.size(), n_sides = n - (outline.kind == Outline::Kind::polyline);
        for (std::size_t i = 0; i < n_sides; ++i) {
            const Vec2 a = pose.position + rotation.turned(outline.points[i]),
                       b = pose.position + rotation.turned(outline.points[(i + 1) % n]);
            if ((a.x() <= place.x()) == (b.x() <= place.x())) continue;
            add(a.y() + (place.x() - a.x()) / (b.x() - a.x()) * (b.y() - a.y()));
        }
    }
    return highest;
}

}  // namespace

double MovingPiece::diameter() const { return std::sqrt(4 * area / std::numbers::pi); }
double MovingPiece::label_of_fragment() const { return label < 0 ? none : label; }
double MovingPiece::number_of_obstacle() const { return label < 0 ? -1. - label : none; }

MovingPieces find_moving_pieces(const Model& model, const State& state) {
    MovingPieces found;
    for (std::size_t i = 0; i < model.obstacles.size(); ++i) {
        const Obstacle& obstacle = model.obstacles[i];
        if (!obstacle.is_free() || !obstacle.outline.is_bounded()) continue;
        const ObstacleState& now = state.obstacles[i];
        found.pieces.push_back({.label = -1 - static_cast<Index>(i),
                                .n_triangles = 0,
                                .mass = obstacle.mass,
                                .area = obstacle.outline.area(),
                                .inertia = obstacle.inertia,
                                .radius = 0,  // it does not break
                                .centre = now.pose.position,
                                .velocity = now.velocity.head<2>(),
                                .start = obstacle.start.position,
                                .spin = now.velocity.z()});
    }
    const Index n_obstacles = static_cast<Index>(found.pieces.size()), n = model.mesh.corners_per_triangle();
    const Fragments fragments = find_fragments(model, state);
    for (const Fragment& f : fragments.pieces)
        found.pieces.push_back({f.first_triangle, f.n_triangles, f.mass, f.area, f.spread.trace(), 0, f.centre,
                                f.velocity, f.start, f.spin()});
    for (Index t = 0; t < model.mesh.n_triangles(); ++t) {
        const Index p = fragments.piece_of_triangle[t];
        found.piece_of_triangle.push_back(p < 0 ? -1 : n_obstacles + p);
        if (p < 0) continue;
        MovingPiece& piece = found.pieces[n_obstacles + p];
        for (Index k = 0; k < 3; ++k) {
            const Vec2 place = model.mesh.corner(t, k) + state.displacement[state.node_of_corner[n * t + k]];
            piece.radius = std::max(piece.radius, (place - piece.centre).norm());
        }
    }
    return found;
}

double ground_below(const Model& model, const State& state, const Vec2& place) {
    double highest = -infinity;
    for (std::size_t i = 0; i < model.obstacles.size(); ++i)
        if (!model.obstacles[i].is_free())
            highest = std::max(highest, surface_below(model.obstacles[i].outline, state.obstacles[i].pose, place));
    return highest == -infinity ? none : highest;
}

std::span<const Measure<TrajectoryPoint>> trajectory_columns() {
    using P = TrajectoryPoint;
    static constexpr Measure<P> columns[] = {
        {"time", "s", "time", [](const P& p) { return p.time; }},
        {"label", "",
         "lowest triangle of the fragment: where it breaks, the part with this triangle keeps the label; "
         "empty of an obstacle",
         [](const P& p) { return p.piece.label_of_fragment(); }},
        {"obstacle", "", "number of the free obstacle, from 0; empty of a fragment",
         [](const P& p) { return p.piece.number_of_obstacle(); }},
        {"mass", "kg", "mass", [](const P& p) { return p.piece.mass; }},
        {"diameter", "m", "diameter of the circle of the same area", [](const P& p) { return p.piece.diameter(); }},
        {"x", "m", "x of the centre of mass", [](const P& p) { return p.piece.centre.x(); }},
        {"y", "m", "y of the centre of mass", [](const P& p) { return p.piece.centre.y(); }},
        {"height", "m", "y above the highest surface of an obstacle below; empty where there is none",
         [](const P& p) { return p.height; }},
        {"speed", "m/s", "speed of the centre of mass", [](const P& p) { return p.piece.velocity.norm(); }},
        {"energy", "J", "kinetic energy of centre of mass and spin", [](const P& p) { return p.piece.energy(); }}};
    return columns;
}

std::vector<std::vector<double>> trajectory_lines(const Model& model, const State& state) {
    constexpr int most = 100;
    std::vector<std::vector<double>> lines;
    int n_obstacles = 0, n_fragments = 0;
    for (const MovingPiece& piece : find_moving_pieces(model, state).pieces) {
        if (++(piece.label < 0 ? n_obstacles : n_fragments) > most) continue;
        const double height = piece.centre.y() - ground_below(model, state, piece.centre);
        lines.push_back(values_of(trajectory_columns(), TrajectoryPoint{state.time, piece, height}));
    }
    return lines;
}

}  // namespace knap
