#include "output/frame.hpp"

#include "base/error.hpp"
#include "model/state.hpp"
#include "stepper/common/crack_forces.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>

namespace knap {
namespace {

/// A triangle of second order is drawn as six triangles round its centre: of edge k, number 2 k has its first half as
/// a side and 2 k + 1 its second half. Entries are corners in the triangle.
using Piece = std::array<Index, 3>;
constexpr std::array<Piece, 1> itself{{{0, 1, 2}}};
constexpr std::array<Piece, 6> six{{{0, 3, 6}, {3, 1, 6}, {1, 4, 6}, {4, 2, 6}, {2, 5, 6}, {5, 0, 6}}};
std::span<const Piece> pieces_of(const Mesh& mesh) {
    if (mesh.order == 1) return itself;
    return six;
}

/// Interfaces of second order are drawn as two halves. Entries are points in the interface: 0 and 1 the ends, 2 the
/// middle.
using Part = std::array<Index, 2>;
constexpr std::array<Part, 1> whole{{{0, 1}}};
constexpr std::array<Part, 2> halves{{{0, 2}, {2, 1}}};
std::span<const Part> parts_of(const Mesh& mesh) {
    if (mesh.order == 1) return whole;
    return halves;
}

/// Per triangle, its number among those that have not vanished.
std::vector<Index> places_of_triangles(const Model& model) {
    std::vector<Index> places;
    Index n = 0;
    for (Index t = 0; t < model.mesh.n_triangles(); ++t) places.push_back(n), n += !model.has_vanished(t);
    return places;
}

/// The corners of the frame at the two ends of a part of an interface, on the side of `triangle`, which has the given
/// place in the frame.
std::array<Index, 2> corners_on(const Mesh& mesh, const Interface& interface, Index triangle, Index place,
                                const Part& part) {
    const std::array<Index, 2> none{rigid_support, rigid_support};
    if (triangle == rigid_support) return none;
    const auto place_of = [](const auto& list, Index entry) {
        return static_cast<Index>(std::ranges::find(list, entry) - list.begin());
    };
    const Index a = place_of(mesh.triangles[triangle], interface.vertex[0]),
                b = place_of(mesh.triangles[triangle], interface.vertex[1]), edge = b == (a + 1) % 3 ? a : b;
    const std::array<Index, 3> corner{a, b, 3 + edge};  // by point of the interface
    const auto pieces = pieces_of(mesh);
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        const Index first = place_of(pieces[i], corner[part[0]]), second = place_of(pieces[i], corner[part[1]]);
        const Index start = 3 * static_cast<Index>(pieces.size() * place + i);
        if (first < 3 && second < 3) return {start + first, start + second};
    }
    return none;  // not reached: the part is a side of one of the pieces
}

void add_bulk(const Model& model, const State& state, Frame& frame) {
    const Mesh& mesh = model.mesh;
    const auto pieces = pieces_of(mesh);
    std::array<Eigen::Vector3d, six.size()> middle;  // barycentric coordinates, the same in every triangle
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        middle[i].setZero();
        for (const Index k : pieces[i]) middle[i] += coordinates(mesh, k) / 3;
    }
    std::vector<Index> first_corner(state.displacement.size(), -1);  // of the frame, per node
    Index n_nodes = 0;
    const auto number_of = [&](Index node, Index corner) {
        const Index first = first_corner[node];
        if (first >= 0 && (frame.temperature.empty() || frame.temperature[first] == frame.temperature[corner]))
            return frame.node[first];
        first_corner[node] = corner;
        return n_nodes++;
    };
    for (auto* list : {&frame.position, &frame.displacement, &frame.velocity})
        list->reserve(3 * pieces.size() * mesh.triangles.size());
    for (Index t = 0; t < mesh.n_triangles(); ++t)
        for (std::size_t i = 0; i < pieces.size() && !model.has_vanished(t); ++i) {
            for (const Index k : pieces[i]) {
                const Index node = state.node_of_corner[mesh.corners_per_triangle() * t + k];
                frame.position.push_back(mesh.corner(t, k));
                frame.displacement.push_back(state.displacement[node]);
                frame.velocity.push_back(state.velocity[node]);
                if (state.temperature)
                    frame.temperature.push_back(state.temperature->of_corner[mesh.corners_per_triangle() * t + k]);
                frame.node.push_back(number_of(node, static_cast<Index>(frame.node.size())));
            }
            const Eigen::Vector4d stress = stress_with_zz(model, state, t, middle[i]);
            frame.stress.push_back(stress.head<3>());
            frame.stress_zz.push_back(stress[3]);
            frame.region.push_back(mesh.region[t]);
            if (state.motion != Motion::deformable)
                frame.piece_state.push_back(static_cast<std::int32_t>(state.piece_state(t)));
            if (!mesh.grain.empty()) frame.grain.push_back(mesh.grain[t]);
            if (!mesh.layer_angle.empty()) frame.layer_angle.push_back(mesh.layer_angle[t] / degree);
        }
}

bool in_bonded_fan(const Model& model, const State& state, Index point) {
    const FanPoint& at = model.fan_points[model.fan_point_of[point]];
    return state.split_rank[model.fan_of_corner[at.after == rigid_support ? at.before : at.after]] < 0;
}

/// In a bonded fan nothing is open, and for order 1 the traction is that of the stresses that the frame already has,
/// unless the normal has turned.
void add_point(const Model& model, const State& state, Index point, const std::vector<Index>& places, Frame& frame) {
    const FanPoint& at = model.fan_points[model.fan_point_of[point]];
    const Interface& interface = model.interfaces[model.interface_of(point)];
    const bool bonded = in_bonded_fan(model, state, point);
    const Vec2 u = bonded ? Vec2(at.gap, 0) : opening(model, state, point);
    const double beta = bonded ? 1 : cohesion(model, state, point);
    frame.end_position.push_back(model.mesh.corner(at.after == rigid_support ? at.before : at.after));
    frame.cohesion.push_back(beta);
    frame.opening.push_back(u.x());
    frame.slip.push_back(u.y());
    frame.status.push_back(interface.cracked ? InterfaceStatus::precrack : status_of(beta));
    if (bonded && model.mesh.order == 1 && !model.large_rotation) {
        const auto [a, b] = interface.triangle;
        frame.traction.push_back(traction(0.5 * (frame.stress[places[a]] + frame.stress[places[b]]), interface.normal));
    } else {
        frame.traction.push_back(traction(model, state, point));
    }
}

/// Needs the bulk of the frame, and the pressures of fluids at all points of the model.
void add_interfaces(const Model& model, const State& state, bool all, Frame& frame) {
    const std::vector<Index> places = places_of_triangles(model);
    const std::vector<double> fluid = std::exchange(frame.fluid, {});
    for (Index i = 0; i < static_cast<Index>(model.interfaces.size()); ++i)
        for (const Part& part : parts_of(model.mesh)) {
            const Interface& interface = model.interfaces[i];
            if (model.is_gone(interface)) continue;
            const Index first = model.points_per_interface() * i, p = first + part[0], q = first + part[1];
            if (!all && in_bonded_fan(model, state, p) && in_bonded_fan(model, state, q)) continue;
            add_point(model, state, p, places, frame);
            add_point(model, state, q, places, frame);
            if (!fluid.empty()) frame.fluid.insert(frame.fluid.end(), {fluid[p], fluid[q]});
            const auto corners = [&](Index triangle) {
                return corners_on(model.mesh, interface, triangle, triangle < 0 ? triangle : places[triangle], part);
            };
            frame.side_a.push_back(corners(interface.triangle[0]));
            frame.side_b.push_back(corners(interface.triangle[1]));
        }
}

/// Outline of a strip along the polyline, `depth` [m] deep.
std::vector<Vec2> strip_of(const Polyline& line, double depth) {
    std::vector<Vec2> points;
    for (const Polyline::Side& side : line.sides()) points.push_back(side.start);
    points.push_back(line.sides().back().end);
    for (Index i = line.n_points() - 1; i >= 0; --i) {
        const Vec2 before = line.sides()[std::max<Index>(i - 1, 0)].outward,
                   after = line.sides()[std::min(i, line.n_points() - 2)].outward;
        points.push_back(points[i] - depth * (before + after).normalized());
    }
    return points;
}

/// `n` points of the outline of an obstacle in its own frame; a polygon repeats its last corner.
std::vector<Vec2> outline_points(const Obstacle& obstacle, const Box& body, Index n) {
    const Outline& outline = obstacle.outline;
    if (outline.kind == Outline::Kind::disc) return circle(Vec2::Zero(), outline.radius, n);
    std::vector<Vec2> points = outline.points;
    if (outline.kind == Outline::Kind::polyline) points = strip_of(*outline.line, 0.02 * body.diagonal());
    if (outline.kind == Outline::Kind::half_plane) {  // a strip of it, next to the body
        const Vec2 along = turned_left(outline.normal),
                   foot = along.dot(
                              Rotation::by(obstacle.start.angle).turned_back(body.middle() - obstacle.start.position)) *
                          along,
                   reach = 1.5 * body.diagonal() * along, depth = 0.05 * body.diagonal() * outline.normal;
        points = {foot + reach, foot - reach, foot - reach - depth, foot + reach - depth};
    }
    points.resize(n, Vec2(points.back()));
    return points;
}

void add_obstacles(const Model& model, const State& state, Frame& frame) {
    const Box body = bounding_box(model.mesh.vertices);
    std::size_t n = n_outline_points;
    for (const Obstacle& obstacle : model.obstacles)
        n = std::max(n, (obstacle.outline.line ? 2 : 1) * obstacle.outline.points.size());
    for (std::size_t o = 0; o < model.obstacles.size(); ++o) {
        const Pose &start = model.obstacles[o].start, &now = state.obstacles[o].pose;
        const Rotation at_start = Rotation::by(start.angle), by_now = Rotation::by(now.angle);
        frame.half_plane.push_back(model.obstacles[o].outline.kind == Outline::Kind::half_plane ? 1 : 0);
        for (const Vec2& p : outline_points(model.obstacles[o], body, static_cast<Index>(n))) {
            frame.obstacle_position.push_back(start.position + at_start.turned(p));
            frame.obstacle_displacement.push_back(now.position + by_now.turned(p) - frame.obstacle_position.back());
        }
    }
}

}  // namespace

Frame make_frame(const Model& model, const State& state, bool all) {
    Frame frame{.time = state.time};
    add_bulk(model, state, frame);
    frame.celsius = model.heat && model.heat->celsius;
    if (!model.crack_fluids.empty()) frame.fluid = CrackForces(model).pressures(state);  // of all points
    add_interfaces(model, state, all, frame);
    add_obstacles(model, state, frame);
    frame.length_scale = diagonal(frame.position);
    return frame;
}

namespace {

double stress_zz(const Frame& frame, Index t) {
    if (frame.stress_zz.empty())
        throw UserError("no-stress-zz", "this run of an earlier version did not store the stress zz",
                        "it has stress_xx, stress_yy, stress_xy and principal_stress; run it again for others");
    return frame.stress_zz[t];
}

}  // namespace

std::vector<Index> single_edges(const Frame& frame) {
    // an edge is known by its middle, the same number from both sides; a table with free places finds it four times as
    // fast as a tree
    const auto middle = [&](Index c) -> Vec2 {
        return frame.position[c] + frame.position[next_corner(c)] + Vec2::Zero();  // -0 becomes 0
    };
    const Index n = 3 * frame.n_triangles();
    const std::size_t size = std::bit_ceil(2 * static_cast<std::size_t>(n) + 2);
    std::vector<Index> edge_at(size, -1);
    std::vector<bool> single(n, true);
    for (Index c = 0; c < n; ++c) {
        const Vec2 x = middle(c);
        const auto mixed = 0x9e3779b97f4a7c15u * (std::bit_cast<std::uint64_t>(x.x()) +
                                                  0xff51afd7ed558ccdu * std::bit_cast<std::uint64_t>(x.y()));
        std::size_t at = mixed >> (64 - std::countr_zero(size));
        while (edge_at[at] >= 0 && middle(edge_at[at]) != x) at = (at + 1) % size;
        if (edge_at[at] < 0) edge_at[at] = c;
        else single[c] = single[edge_at[at]] = false;
    }
    std::vector<Index> found;
    for (Index c = 0; c < n; ++c)
        if (single[c]) found.push_back(c);
    return found;
}

double diagonal(const std::vector<Vec2>& points) { return points.empty() ? 0 : bounding_box(points).diagonal(); }

double largest_principal(const Eigen::Vector3d& s) {
    return 0.5 * (s[0] + s[1]) + std::hypot(0.5 * (s[0] - s[1]), s[2]);
}

double von_mises(const Frame& frame, Index t) {
    const Eigen::Vector3d& s = frame.stress[t];
    const double zz = stress_zz(frame, t), a = s[0] - s[1], b = s[1] - zz, c = zz - s[0];
    return std::sqrt(0.5 * (a * a + b * b + c * c) + 3 * s[2] * s[2]);
}

double max_shear(const Frame& frame, Index t) {
    const Eigen::Vector3d& s = frame.stress[t];
    const double zz = stress_zz(frame, t), high = largest_principal(s), low = s[0] + s[1] - high;
    return 0.5 * (std::max(high, zz) - std::min(low, zz));
}

}  // namespace knap
