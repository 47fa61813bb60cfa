#include "observe/frame.hpp"

#include "model/model.hpp"
#include "model/state.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace knap {

namespace {

/// Corner of `triangle` that lies on `vertex`; ground for the rigid foundation.
Index corner_on(const Model& model, Index triangle, Index vertex) {
    if (triangle == ground) return ground;
    const auto& corners = model.mesh.triangles[triangle];
    const auto found = std::find(corners.begin(), corners.end(), vertex);
    return 3 * triangle + static_cast<Index>(found - corners.begin());
}

PointStatus status_of(bool cracked, double cohesion) {
    if (cracked) return PointStatus::precrack;
    if (cohesion == 1) return PointStatus::intact;
    return cohesion > 0 ? PointStatus::damaged : PointStatus::broken;
}

void add_bulk(const Model& model, const State& state, Frame& frame) {
    const Mesh& mesh = model.mesh;
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        for (Index k = 0; k < 3; ++k) {
            const Index node = state.node_of_corner[3 * t + k];
            frame.position.push_back(mesh.corner(t, k));
            frame.displacement.push_back(state.displacement[node]);
            frame.velocity.push_back(state.velocity[node]);
        }
        frame.stress.push_back(stress(model, state, t));
        frame.region.push_back(mesh.region[t]);
    }
}

void add_interfaces(const Model& model, const State& state, Frame& frame) {
    for (Index i = 0; i < static_cast<Index>(model.interfaces.size()); ++i) {
        const Interface& interface = model.interfaces[i];
        std::array<Index, 2> a, b;
        for (Index end = 0; end < 2; ++end) {
            const Index point = 2 * i + end;
            const double beta = cohesion(model, state, point);
            const Vec2 u = opening(model, state, point);
            a[end] = corner_on(model, interface.triangle[0], interface.vertex[end]);
            b[end] = corner_on(model, interface.triangle[1], interface.vertex[end]);
            frame.end_position.push_back(model.mesh.vertices[interface.vertex[end]]);
            frame.cohesion.push_back(beta);
            frame.opening.push_back(u.x());
            frame.slip.push_back(u.y());
            frame.traction.push_back(traction(model, state, point));
            frame.status.push_back(status_of(interface.cracked, beta));
        }
        frame.side_a.push_back(a);
        frame.side_b.push_back(b);
    }
}

/// Around an obstacle in its own frame; a polygon repeats its last corner.
std::vector<Vec2> outline_points(const Obstacle& obstacle, const Vec2& middle_of_body, double length) {
    const Outline& outline = obstacle.outline;
    std::vector<Vec2> points = outline.points;
    if (outline.kind == Outline::Kind::disc)
        for (Index i = 0; i < n_outline_points; ++i) points.push_back(outline.radius * Vec2(std::cos(2 * M_PI * i / n_outline_points), std::sin(2 * M_PI * i / n_outline_points)));
    if (outline.kind == Outline::Kind::half_plane) {  // a strip of it, beside the body
        const Vec2 along = turned_left(outline.normal), foot = along.dot(obstacle.start.turned_back(middle_of_body - obstacle.start.position)) * along;
        const Vec2 reach = 1.5 * length * along, depth = 0.05 * length * outline.normal;
        points = {foot + reach, foot - reach, foot - reach - depth, foot + reach - depth};
    }
    if (points.size() > static_cast<std::size_t>(n_outline_points)) points.resize(n_outline_points);
    while (points.size() < static_cast<std::size_t>(n_outline_points)) points.push_back(Vec2(points.back()));
    return points;
}

void add_obstacles(const Model& model, const State& state, Frame& frame) {
    Vec2 low = model.mesh.vertices.front(), high = low;
    for (const Vec2& x : model.mesh.vertices) low = low.cwiseMin(x), high = high.cwiseMax(x);
    for (std::size_t o = 0; o < model.obstacles.size(); ++o) {
        const Pose &start = model.obstacles[o].start, &now = state.obstacles[o].pose;
        for (const Vec2& p : outline_points(model.obstacles[o], 0.5 * (low + high), (high - low).norm())) {
            frame.obstacle_position.push_back(start.position + start.turned(p));
            frame.obstacle_displacement.push_back(now.position + now.turned(p) - frame.obstacle_position.back());
        }
    }
}

}  // namespace

Frame make_frame(const Model& model, const State& state) {
    Frame frame;
    frame.time = state.time;
    add_bulk(model, state, frame);
    add_interfaces(model, state, frame);
    add_obstacles(model, state, frame);
    frame.length_scale = diagonal(frame.position);
    return frame;
}

double diagonal(const std::vector<Vec2>& points) {
    if (points.empty()) return 0;
    Vec2 low = points.front(), high = points.front();
    for (const Vec2& p : points) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    return (high - low).norm();
}

double largest_principal(const Eigen::Vector3d& s) {
    return 0.5 * (s[0] + s[1]) + std::hypot(0.5 * (s[0] - s[1]), s[2]);
}

bool History::has(const std::string& name) const { return std::find(columns.begin(), columns.end(), name) != columns.end(); }

std::vector<double> History::column(const std::string& name) const {
    const auto found = std::find(columns.begin(), columns.end(), name);
    if (found == columns.end()) throw std::out_of_range("no column `" + name + "` in this history");
    const auto j = static_cast<std::size_t>(found - columns.begin());
    std::vector<double> values;
    for (const auto& row : rows) values.push_back(row.at(j));
    return values;
}

}  // namespace knap
