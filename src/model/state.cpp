#include "model/state.hpp"

#include "base/reserve_capacity.hpp"
#include "element/shape_functions.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace knap {

State initial_state(const Model& model) {
    State state;
    const std::size_t n_fans = model.fans.size();
    state.displacement.assign(n_fans, Vec2::Zero());
    state.velocity.assign(n_fans, Vec2::Zero());
    state.node_of_corner = model.fan_of_corner;
    state.split_rank.assign(n_fans, -1);
    state.reaction.assign(model.prescribed.size(), Vec2::Zero());
    for (const Obstacle& obstacle : model.obstacles) state.obstacles.push_back(initial_state(obstacle));
    if (model.faces_meet()) state.retired.assign(model.n_points(), Retirement::none);
    for (std::size_t f = 0; f < n_fans; ++f)
        if (model.fans[f].split_at_start) split(model, static_cast<Index>(f), state);
    if (has_incubation(model)) state.incubation.resize(n_fans);
    if (model.heat) state.temperature = state.temperature_before = field_at(model, 0);
    for (std::size_t c = 0; c < model.initial_velocity.size(); ++c)  // equal at all corners of a node
        state.velocity[state.node_of_corner[c]] = model.initial_velocity[c];
    return state;
}

bool has_incubation(const Model& model) {
    return std::ranges::any_of(model.laws,
                               [](const CohesiveLaw& law) { return law.breakable() && law.incubation_time > 0; });
}

bool has_norm(const Model& model) {
    return std::ranges::any_of(model.laws, [](const CohesiveLaw& law) { return law.coupling == Coupling::norm; });
}

void split(const Model& model, Index f, State& state) {
    assert(state.split_rank[f] < 0);
    reserve_capacity(model.mesh.n_corners(), state.displacement, state.velocity);
    if (state.has_end_velocities()) reserve_capacity(model.mesh.n_corners(), state.rate);
    reserve_capacity(model.fans.size(), state.split_fans, state.first_point);
    reserve_capacity(model.fan_points.size(), state.points);
    for (const Index corner : model.corners(model.fans[f]).subspan(1)) {
        state.node_of_corner[corner] = static_cast<Index>(state.displacement.size());
        state.displacement.push_back(Vec2(state.displacement[f]));
        state.velocity.push_back(Vec2(state.velocity[f]));
        if (state.has_end_velocities()) state.rate.push_back(Vec2(state.rate[f]));
    }
    state.split_rank[f] = static_cast<Index>(state.split_fans.size());
    state.split_fans.push_back(f);
    state.first_point.push_back(static_cast<Index>(state.points.size()));
    for (const FanPoint& point : model.points(model.fans[f])) {
        const bool cohesive = !point.cracked && model.laws[point.law].sigma_c > 0;
        state.points.push_back({.cohesion = cohesive ? 1.0 : 0.0, .traction = Vec2::Zero()});
    }
}

void fit_laws(const Model& model, State& state) {
    if (!model.laws_follow_temperature) return;
    const bool same = state.temperature == state.temperature_before;
    for (SharedTemperatures* shared : {&state.temperature, &state.temperature_before}) {
        const auto fitted = std::make_shared<Temperatures>(**shared);
        fit_laws(model, *fitted);
        *shared = fitted;
    }
    if (same) state.temperature_before = state.temperature;
}

const PointState* state_of(const Model& model, const State& state, Index point) {
    const Index in_fans = model.fan_point_of[point], fan = model.fan_of_corner[model.fan_points[in_fans].corner()];
    const Index rank = state.split_rank[fan];
    if (rank < 0) return nullptr;
    return &state.points[state.first_point[rank] + in_fans - model.fans[fan].first_point];
}

namespace {

const double cosine_of_face = std::cos(0.2);                // a face turns by less at a vertex
constexpr double one_frame_below = 0.01, apart_from = 0.1;  // [rad] between the frames of two points of a face

// In 2D, R turns by the angle atan2(F_yx - F_xy, F_xx + F_yy). With the edges e_1, e_2 from vertex 0 of a triangle and
// the differences a, b of displacement along them, H = (a (x) -turned(e_2) + b (x) turned(e_1))/(2 A), so that
//     2 A (H_yx - H_xy) = a . e_2 - b . e_1,     2 A (H_xx + H_yy) = a x e_2 + e_1 x b,     2 A = e_1 x e_2.
Rotation frame_of(const Model& model, const State& state, std::span<const Index> corners) {
    const Mesh& mesh = model.mesh;
    double cosine = 0, sine = 0;
    for (const Index corner : corners) {
        const Index t = corner / 3, first = 3 * t;  // order 1
        const auto& [k0, k1, k2] = mesh.triangles[t];
        const Vec2 &x = mesh.vertices[k0], e1 = mesh.vertices[k1] - x, e2 = mesh.vertices[k2] - x,
                   &u = state.displacement[state.node_of_corner[first]],
                   a = state.displacement[state.node_of_corner[first + 1]] - u,
                   b = state.displacement[state.node_of_corner[first + 2]] - u;
        const double density = model.materials[mesh.region[t]].density;  // times 2 A: the mass
        sine += density * (a.dot(e2) - b.dot(e1));
        cosine += density * (2 * cross(e1, e2) + cross(a, e2) + cross(e1, b));
    }
    return rotation_along({cosine, sine});
}

}  // namespace

Rotation fan_frame(const Model& model, const State& state, const Fan& fan) {
    if (!model.large_rotation || fan.n_points == 0) return {};
    const auto points = model.points(fan);
    if (points.front().on_support() || points.back().on_support()) return {};
    return frame_of(model, state, model.corners(fan));
}

const FanPoint* same_face_beyond(const Model& model, const FanPoint& point) {
    const auto points = model.points(model.fans[model.fan_of_corner[point.corner()]]);
    const auto along = [&](const FanPoint& at) { return -at.normal.dot(point.normal); };
    const auto most = std::ranges::max_element(points, {}, along);
    return most->law == point.law && along(*most) > cosine_of_face ? &*most : nullptr;
}

Rotation point_frame(const Model& model, const State& state, const FanPoint& point) {
    if (!model.large_rotation || point.on_support()) return {};
    const auto own_frame = [&](const FanPoint& at) {
        return frame_of(model, state, std::array<Index, 2>{at.before, at.after});
    };
    const Rotation own = own_frame(point);
    const CohesiveLaw& law = model.laws[point.law];
    if (!law.over_pressure && law.coupling != Coupling::norm) return own;
    const FanPoint* beyond = same_face_beyond(model, point);
    if (!beyond || beyond->on_support()) return own;
    const double angle = angle_of(from_to(own, own_frame(*beyond))),
                 part = (apart_from - std::abs(angle)) / (apart_from - one_frame_below);
    return composed(Rotation::by(0.5 * std::clamp(part, 0.0, 1.0) * angle), own);
}

Vec2 opening(const Model& model, const State& state, Index point) {
    const FanPoint& at = model.fan_points[model.fan_point_of[point]];
    return state.opening_of(at, point_frame(model, state, at));
}

Vec2 cohesive_opening(const Model& model, const State& state, const FanPoint& point, const Rotation& frame,
                      double beta) {
    constexpr double closed = 1e-5;  // [-] of the softening length
    Vec2 u = state.opening_of(point, frame);
    if (frame.sine == 0 || !(beta > 0) || state.has_end_velocities()) return u;
    const double least = closed * law_of(model, state, point).softening_length();
    for (double& component : u)
        if (std::abs(component) <= least) component = 0;
    return u;
}

double touching_gap(const Model& model, const State& state, const FanPoint& point) {
    const double displacements = state.displacement_of(point.before).norm() + state.displacement_of(point.after).norm();
    return 1e-11 * (displacements + point.gap + model.laws[point.law].delta_c());
}

double cohesion(const Model& model, const State& state, Index point) {
    const PointState* known = state_of(model, state, point);
    return known ? known->cohesion : 1;
}

Eigen::Vector3d coordinates(const Mesh& mesh, Index corner) {
    const Index k = mesh.place_in_triangle(corner);
    if (k < 3) return Eigen::Vector3d::Unit(k);
    if (k < 6) return 0.5 * (Eigen::Vector3d::Unit(k - 3) + Eigen::Vector3d::Unit((k - 2) % 3));
    return Eigen::Vector3d::Constant(1. / 3);
}

Vec2 place_of_largest_speed(const Model& model, const State& state) {
    Index fastest = 0;
    double largest = -1;
    for (Index c = 0; c < model.mesh.n_corners(); ++c) {
        const Vec2& velocity = state.velocity[state.node_of_corner[c]];
        if (!velocity.allFinite()) return model.mesh.corner(c);
        if (velocity.norm() > largest) largest = velocity.norm(), fastest = c;
    }
    return model.mesh.corner(fastest);
}

Eigen::Vector3d stress(const Model& model, const State& state, Index t) {
    return stress(model, state, t, Eigen::Vector3d::Constant(1. / 3));
}

Eigen::Vector3d stress(const Model& model, const State& state, Index t, const Eigen::Vector3d& at) {
    return stress_with_zz(model, state, t, at).head<3>();
}

Eigen::Vector4d stress_with_zz(const Model& model, const State& state, Index t, const Eigen::Vector3d& at) {
    const Mesh& mesh = model.mesh;
    const auto g = shape_gradients(mesh, t);
    Eigen::Vector3d strain = Eigen::Vector3d::Zero();  // xx, yy, 2 xy
    const auto add = [&](double weight, const Vec2& gradient, const Vec2& u) {
        strain += weight * Eigen::Vector3d(gradient.x() * u.x(), gradient.y() * u.y(),
                                           gradient.y() * u.x() + gradient.x() * u.y());
    };
    if (mesh.order == 1) {
        for (Index k = 0; k < 3; ++k) add(1, g[k], state.displacement_of(3 * t + k));
    } else {
        for (Index k = 0; k < 3; ++k) {  // linear, from the values where coordinate k is 0 and the others 1/2
            const std::array<Vec2, 7> weight = middle_gradients(g, k);
            for (Index c = 0; c < 7; ++c) add(1 - 2 * at[k], weight[c], state.displacement_of(7 * t + c));
        }
    }
    double thermal = 0;
    const Elastic material = model.elastic(t);
    if (state.temperature) {  // sigma = D (eps - e A)
        const double* e = &state.temperature->strain[(mesh.order == 1 ? 1 : 3) * t];
        thermal = mesh.order == 1 ? e[0] : 0;
        for (Index k = 0; k < 3 && mesh.order == 2; ++k) thermal += (1 - 2 * at[k]) * e[k];
        strain -= thermal * strain_of(material.expansion_in_plane(model.plane));
    }
    const Eigen::Matrix3d D = material.stiffness(model.plane);
    Eigen::Vector3d initial = Eigen::Vector3d::Zero();
    if (!model.initial_stress.empty()) {
        if (mesh.order == 1) initial = Eigen::Vector3d(model.initial_stress[t].data());
        for (Index k = 0; k < 3 && mesh.order == 2; ++k)
            initial += (1 - 2 * at[k]) * Eigen::Vector3d(model.initial_stress[3 * t + k].data());
    }
    const auto zz = [&](const Eigen::Vector3d& s) {  // e = (1 + nu) a dT
        return model.plane == PlaneModel::strain
                   ? material.stress_along_strike(s) - material.E * thermal / (1 + material.nu)
                   : 0;
    };
    if (!model.large_rotation) {
        const Eigen::Vector3d s = D * strain + initial;
        return {s[0], s[1], s[2], zz(s)};
    }
    Eigen::Matrix2d H = Eigen::Matrix2d::Zero();
    for (Index k = 0; k < 3; ++k) H += state.displacement_of(3 * t + k) * g[k].transpose();
    const Eigen::Matrix2d F = Eigen::Matrix2d::Identity() + H, quadratic = 0.5 * H.transpose() * H;
    const Eigen::Vector3d s =
        D * (strain + Eigen::Vector3d(quadratic(0, 0), quadratic(1, 1), 2 * quadratic(0, 1))) + initial;
    const Eigen::Matrix2d S = stress_matrix(s), cauchy = F * S * F.transpose() / F.determinant();
    return {cauchy(0, 0), cauchy(1, 1), cauchy(0, 1), zz(s) / F.determinant()};
}

Vec2 traction(const Model& model, const State& state, Index point) {
    if (const PointState* known = state_of(model, state, point)) return known->traction;
    const FanPoint& at = model.fan_points[model.fan_point_of[point]];  // no support: its fan would be split
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const Index corner : {at.before, at.after})
        mean += 0.5 * stress(model, state, model.mesh.triangle_of(corner), coordinates(model.mesh, corner));
    return traction(mean, point_frame(model, state, at).turned(model.interfaces[model.interface_of(point)].normal));
}

Vec2 traction(const Eigen::Vector3d& stress, const Vec2& n) {
    const Vec2 on_a(stress[0] * n.x() + stress[2] * n.y(), stress[2] * n.x() + stress[1] * n.y());  // sigma N
    return {-on_a.dot(n), -on_a.dot(turned_left(n))};
}

}  // namespace knap
