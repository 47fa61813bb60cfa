#include "output/frame.hpp"

#include "base/error.hpp"
#include "model/model.hpp"
#include "model/state.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace knap {

namespace {

/// Triangles that one is drawn as: itself, or of order 2 six round its centre; two at edge k, 2 k before its middle and 2 k + 1 behind.
using Piece = std::array<Index, 3>;  // corners
constexpr std::array<Piece, 1> whole{{{0, 1, 2}}};
constexpr std::array<Piece, 6> six{{{0, 3, 6}, {3, 1, 6}, {1, 4, 6}, {4, 2, 6}, {2, 5, 6}, {5, 0, 6}}};
std::span<const Piece> pieces(const Mesh& mesh) {
    if (mesh.order == 1) return whole;
    return six;
}

/// The parts of an interface that are drawn, by the places of their two points.
constexpr std::array<std::array<Index, 2>, 1> edge_itself{{{0, 1}}};
constexpr std::array<std::array<Index, 2>, 2> halves{{{0, 2}, {2, 1}}};
std::span<const std::array<Index, 2>> parts(const Mesh& mesh) {
    if (mesh.order == 1) return edge_itself;
    return halves;
}

/// The corners of the frame at the two ends of a part of an interface on one of its sides.
std::array<Index, 2> corners_on(const Model& model, const Interface& interface, Index triangle, const std::array<Index, 2>& part) {
    if (triangle == rigid_support) return {rigid_support, rigid_support};
    const auto& vertices = model.mesh.triangles[triangle];
    const auto place_of = [&](Index vertex) { return static_cast<Index>(std::find(vertices.begin(), vertices.end(), vertex) - vertices.begin()); };
    const std::array<Index, 2> end{place_of(interface.vertex[0]), place_of(interface.vertex[1])};
    const Index side = end[1] == (end[0] + 1) % 3 ? end[0] : end[1];
    const auto all = pieces(model.mesh);
    const auto has = [](const Piece& piece, Index k) { return std::find(piece.begin(), piece.end(), k); };
    const std::array<Index, 2> k{part[0] < 2 ? end[part[0]] : 3 + side, part[1] < 2 ? end[part[1]] : 3 + side};
    for (std::size_t i = 0; i < all.size(); ++i) {
        const auto first = has(all[i], k[0]), second = has(all[i], k[1]);
        if (first == all[i].end() || second == all[i].end()) continue;
        const Index start = 3 * (static_cast<Index>(all.size()) * triangle + static_cast<Index>(i));
        return {start + static_cast<Index>(first - all[i].begin()), start + static_cast<Index>(second - all[i].begin())};
    }
    return {rigid_support, rigid_support};  // not reached: an edge is a side of its triangles
}

PointStatus status_of(bool cracked, double cohesion) {
    if (cracked) return PointStatus::precrack;
    if (cohesion == 1) return PointStatus::intact;
    return cohesion > 0 ? PointStatus::damaged : PointStatus::broken;
}

/// Barycentric coordinates of the middle of each piece, the same in every triangle.
std::array<Eigen::Vector3d, six.size()> middles(const Mesh& mesh) {
    std::array<Eigen::Vector3d, six.size()> middle;
    middle.fill(Eigen::Vector3d::Zero());
    for (std::size_t i = 0; i < pieces(mesh).size(); ++i)
        for (const Index k : pieces(mesh)[i]) middle[i] += coordinates(mesh, k) / 3;
    return middle;
}

void add_bulk(const Model& model, const State& state, Frame& frame) {
    const Mesh& mesh = model.mesh;
    const Index n_pieces = static_cast<Index>(pieces(mesh).size()), n = n_pieces * mesh.n_triangles();
    frame.position.resize(3 * n), frame.displacement.resize(3 * n), frame.velocity.resize(3 * n);
    frame.stress.resize(n), frame.region.resize(n), frame.grain.resize(mesh.grain.empty() ? 0 : n);
    const auto middle = middles(mesh);
    for (Index t = 0; t < mesh.n_triangles(); ++t)
        for (Index i = 0; i < n_pieces; ++i) {
            const Index piece = n_pieces * t + i;
            for (Index j = 0; j < 3; ++j) {
                const Index k = pieces(mesh)[i][j], corner = mesh.corners_per_triangle() * t + k, node = state.node_of_corner[corner];
                frame.position[3 * piece + j] = mesh.corner(t, k);
                frame.displacement[3 * piece + j] = state.displacement[node];
                frame.velocity[3 * piece + j] = state.velocity[node];
            }
            frame.stress[piece] = stress(model, state, t, middle[i]);
            frame.region[piece] = mesh.region[t];
            if (!frame.grain.empty()) frame.grain[piece] = mesh.grain[t];
        }
}

bool in_one_piece(const Model& model, const State& state, Index point) {
    const FanPoint& at = model.fan_points[model.fan_point_of[point]];
    return state.split_rank[model.fan_of_corner[at.after == rigid_support ? at.before : at.after]] < 0;
}

/// Cohesion, opening, slip and traction of a point. In a fan in one piece nothing is open, and of order 1 the tractions are those of the stresses that the
/// frame already has.
void add_point(const Model& model, const State& state, Index point, Index p, Frame& frame) {
    const FanPoint& at = model.fan_points[model.fan_point_of[point]];
    const Interface& interface = model.interfaces[model.interface_of(point)];
    const bool whole = in_one_piece(model, state, point);
    const Vec2 u = whole ? Vec2(at.gap, 0) : opening(model, state, point);
    frame.end_position[p] = model.mesh.corner(at.after == rigid_support ? at.before : at.after);
    frame.cohesion[p] = whole ? 1 : cohesion(model, state, point);
    frame.opening[p] = u.x();
    frame.slip[p] = u.y();
    frame.status[p] = status_of(interface.cracked, frame.cohesion[p]);
    if (whole && model.mesh.order == 1) {
        frame.traction[p] = traction(0.5 * (frame.stress[interface.triangle[0]] + frame.stress[interface.triangle[1]]), interface.normal);
    } else {
        frame.traction[p] = traction(model, state, point);
    }
}

/// After the bulk.
void add_interfaces(const Model& model, const State& state, bool all, Frame& frame) {
    const Index n_parts = static_cast<Index>(parts(model.mesh).size());
    std::vector<Index> shown;  // n_parts interface + part
    for (Index i = 0; i < n_parts * static_cast<Index>(model.interfaces.size()); ++i) {
        const auto whole = [&](Index place) { return in_one_piece(model, state, model.points_per_interface() * (i / n_parts) + place); };
        const std::array<Index, 2>& part = parts(model.mesh)[i % n_parts];
        if (all || !whole(part[0]) || !whole(part[1])) shown.push_back(i);
    }
    const Index n = static_cast<Index>(shown.size());
    frame.side_a.resize(n), frame.side_b.resize(n), frame.end_position.resize(2 * n), frame.cohesion.resize(2 * n), frame.opening.resize(2 * n);
    frame.slip.resize(2 * n), frame.traction.resize(2 * n), frame.status.resize(2 * n);
    for (Index i = 0; i < n; ++i) {
        const Index number = shown[i] / n_parts;
        const Interface& interface = model.interfaces[number];
        const std::array<Index, 2>& part = parts(model.mesh)[shown[i] % n_parts];
        for (Index j = 0; j < 2; ++j) add_point(model, state, model.points_per_interface() * number + part[j], 2 * i + j, frame);
        frame.side_a[i] = corners_on(model, interface, interface.triangle[0], part);
        frame.side_b[i] = corners_on(model, interface, interface.triangle[1], part);
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
        frame.half_plane.push_back(model.obstacles[o].outline.kind == Outline::Kind::half_plane ? 1 : 0);
        for (const Vec2& p : outline_points(model.obstacles[o], 0.5 * (low + high), (high - low).norm())) {
            frame.obstacle_position.push_back(start.position + start.turned(p));
            frame.obstacle_displacement.push_back(now.position + now.turned(p) - frame.obstacle_position.back());
        }
    }
}

}  // namespace

Frame make_frame(const Model& model, const State& state, bool all) {
    Frame frame;
    frame.time = state.time;
    add_bulk(model, state, frame);
    add_interfaces(model, state, all, frame);
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
    if (found == columns.end()) throw UserError("damaged-file", (file.empty() ? "a history" : "`" + file + "`") + " has no column `" + name + "`");
    const auto j = static_cast<std::size_t>(found - columns.begin());
    std::vector<double> values;
    for (const auto& row : rows) values.push_back(row.at(j));
    return values;
}

}  // namespace knap
