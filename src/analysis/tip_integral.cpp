#include "analysis/tip_integral.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "element/shape_functions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace knap {
namespace {

[[noreturn]] void fail(const std::string& probe, const std::string& text) {
    throw SimulationError("probe `" + probe + "` watches a crack tip, but " + text);
}

std::string at_place(const Vec2& x) { return "(" + shortest(x.x()) + ", " + shortest(x.y()) + ") m"; }

/// Gradient of Williams' displacements at the local place x for K_I = 1 (mode 0) or K_II = 1 (mode 1):
/// u = sqrt(r/(2 pi)) f(phi)/(2 mu).
Eigen::Matrix2d williams_gradient(const Vec2& x, int mode, double kappa, double shear) {
    const double r = x.norm(), phi = std::atan2(x.y(), x.x()), c = std::cos(phi / 2), s = std::sin(phi / 2),
                 C = std::cos(phi), S = std::sin(phi), a = kappa - C, b = kappa + 2 + C, d = kappa - 2 + C;
    const Vec2 f = mode == 0 ? Vec2(c * a, s * a) : Vec2(s * b, -c * d),
               slope =
                   mode == 0 ? Vec2(-s / 2 * a + c * S, c / 2 * a + s * S) : Vec2(c / 2 * b - s * S, s / 2 * d + c * S);
    Eigen::Matrix2d gradient;
    gradient << C / 2 * f - S * slope, S / 2 * f + C * slope;
    return gradient / (2 * shear * std::sqrt(2 * std::numbers::pi * r));
}

Eigen::Vector3d strain_of(const Eigen::Matrix2d& H) { return {H(0, 0), H(1, 1), H(0, 1) + H(1, 0)}; }

Eigen::Matrix2d as_matrix(const Eigen::Vector3d& s) { return (Eigen::Matrix2d() << s[0], s[2], s[2], s[1]).finished(); }

}  // namespace

TipIntegral::TipIntegral(const Model& model, const Vec2& at, double radius, const std::string& probe)
    : model_(model), radius_(radius) {
    const Mesh& mesh = model.mesh;
    place_tip(at, probe);
    for (Index t = 0; t < mesh.n_triangles(); ++t)
        if (std::ranges::any_of(mesh.triangles[t], [&](Index v) { return distance(v) < radius_; }))
            triangles_.push_back(t);
    check_domain(probe);
    for (std::size_t i = 0; i < model.interfaces.size(); ++i) {
        const Interface& interface = model.interfaces[i];
        if (interface.cracked || (distance(interface.vertex[0]) >= radius_ && distance(interface.vertex[1]) >= radius_))
            continue;
        for (Index k = 0; k < model.points_per_interface(); ++k)
            points_.push_back(model.points_per_interface() * static_cast<Index>(i) + k);
    }
}

void TipIntegral::place_tip(const Vec2& at, const std::string& probe) {
    const Mesh& mesh = model_.mesh;
    std::vector<int> n_cracks(mesh.vertices.size(), 0);
    for (const BoundaryEdge& edge : mesh.boundary_edges)  // a crack ends there, and has no tip
        for (const Index k : {edge.side, (edge.side + 1) % 3}) n_cracks[mesh.triangles[edge.triangle][k]] = 2;
    for (const Interface& i : model_.interfaces)
        for (const Index v : i.vertex) n_cracks[v] += i.cracked;
    double nearest = infinity;
    for (const Interface& i : model_.interfaces)
        for (const int end : {0, 1}) {
            const Vec2 &tip = mesh.vertices[i.vertex[end]], &other = mesh.vertices[i.vertex[1 - end]];
            if (!i.cracked || n_cracks[i.vertex[end]] != 1 || (tip - at).norm() >= nearest) continue;
            nearest = (tip - at).norm(), tip_ = tip, along_ = (tip - other).normalized();
        }
    if (std::isinf(nearest)) fail(probe, "no pre-crack ends inside the body");
    if (nearest > radius_)
        fail(probe, "the nearest tip is at " + at_place(tip_) + ", " + shortest(nearest) +
                        " m from its place: farther than its radius");
}

void TipIntegral::check_domain(const std::string& probe) const {
    const Mesh& mesh = model_.mesh;
    if (model_.large_rotation) fail(probe, "rotations are large: its integrals are those of small ones");
    if (model_.heat) fail(probe, "with [heat] its integrals are not known");
    const auto refuse = [&](const std::string& what, const Vec2& where) {
        fail(probe, what + " at " + at_place(where) + " lies within its radius of " + shortest(radius_) +
                        " m from the tip at " + at_place(tip_) + ": a smaller radius");
    };
    const auto is_inside = [&](Index vertex) { return distance(vertex) < radius_; };
    for (const BoundaryEdge& edge : mesh.boundary_edges)
        for (const Index k : {edge.side, (edge.side + 1) % 3})
            if (const Index v = mesh.triangles[edge.triangle][k]; is_inside(v))
                refuse("the boundary", mesh.vertices[v]);
    double edges = 0, n = 0;
    for (const Interface& i : model_.interfaces) {
        if (!is_inside(i.vertex[0]) && !is_inside(i.vertex[1])) continue;
        edges += i.length, ++n;
        for (const Index v : i.vertex) {
            const Vec2 x = local(mesh.vertices[v] - tip_);
            if (i.cracked && is_inside(v) && (x.x() > 1e-9 * radius_ || std::abs(x.y()) > 1e-6 * radius_))
                refuse("another crack, or a bend of this one,", mesh.vertices[v]);
        }
    }
    if (radius_ < 4 * edges / n)
        fail(probe, "its radius of " + shortest(radius_) + " m is less than four edges of " + shortest(edges / n) +
                        " m: a larger radius or a finer mesh");
    for (const Index t : triangles_) {
        if (mesh.region[t] != mesh.region[triangles_.front()]) refuse("another material", mesh.centroid(t));
        for (Index c = mesh.corners_per_triangle() * t; c < mesh.corners_per_triangle() * (t + 1); ++c)
            if (model_.motion_of(c) || std::ranges::binary_search(model_.corner_loads, c, {}, &CornerLoad::corner))
                refuse("a load", mesh.corner(c));
    }
    if (!model_.crack_fluids.empty()) fail(probe, "a fluid presses on its faces");
}

bool TipIntegral::has_vanished() const {
    return std::ranges::any_of(triangles_, [&](Index t) { return model_.has_vanished(t); });
}

void TipIntegral::after_step(const State& state) {
    const bool first = velocity_.empty();
    const Index n = model_.mesh.corners_per_triangle();
    velocity_.resize(n * triangles_.size(), Vec2::Zero());
    acceleration_.resize(velocity_.size(), Vec2::Zero());
    // explicit bulk: velocities live at the middle of the steps
    const double elapsed = state.rate.empty() ? 0.5 * (last_step_ + state.last_step) : state.last_step;
    std::size_t i = 0;
    for (const Index t : triangles_)
        for (Index c = n * t; c < n * (t + 1); ++c, ++i) {
            const Vec2& v = state.velocity[state.node_of_corner[c]];
            if (!first && elapsed > 0) acceleration_[i] = (v - velocity_[i]) / elapsed;
            velocity_[i] = v;
        }
    last_step_ = state.last_step;
    known_ = !first || state.n_steps == 0;
}

bool TipIntegral::stands(const State& state) const {
    return std::ranges::all_of(points_, [&](Index point) {
        const PointState* known = state_of(model_, state, point);
        return !known || known->cohesion == 1;
    });
}

TipFactors TipIntegral::factors(const State& state) const {
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    if (!known_ || !stands(state)) return {unknown, unknown, unknown};
    const Mesh& mesh = model_.mesh;
    const Elastic& material = model_.materials[mesh.region[triangles_.front()]];
    const double nu = material.nu, shear = material.shear_modulus();
    const double kappa = model_.plane == PlaneModel::strain ? 3 - 4 * nu : (3 - nu) / (1 + nu);
    const Eigen::Matrix3d D = material.stiffness(model_.plane);
    const Eigen::Matrix2d turn = (Eigen::Matrix2d() << along_, turned_left(along_)).finished().transpose();
    const Index n = mesh.corners_per_triangle(), n_places = mesh.order == 1 ? 1 : 3;
    double J = 0, M[2] = {0, 0};
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
        const Index t = triangles_[i];
        const auto g = shape_gradients(mesh, t);
        std::array<double, 3> q_of;
        Vec2 dq = Vec2::Zero();
        for (Index k = 0; k < 3; ++k) q_of[k] = q(mesh.triangles[t][k]), dq += q_of[k] * turn * g[k];
        for (Index m = 0; m < n_places; ++m) {  // the centroid; of order 2 the middles of the edges
            std::array<Vec2, 7> gradient;
            if (mesh.order == 2) gradient = middle_gradients(g, m);
            else std::ranges::copy(g, gradient.begin());
            Eigen::Matrix2d H = Eigen::Matrix2d::Zero(), rates = H;
            Vec2 x = Vec2::Zero(), v = x, a = x;
            double here = 0;
            for (Index k = 0; k < n; ++k) {
                const Vec2 u = turn * state.displacement_of(n * t + k);
                H += u * (turn * gradient[k]).transpose();
                const double part = mesh.order == 1 ? 1. / 3 : k == opposite_middle(m) ? 1 : 0;
                if (k < 3) here += (mesh.order == 1 ? 1. / 3 : k == m ? 0 : 0.5) * q_of[k];
                x += part * local(mesh.corner(t, k) - tip_);
                const std::size_t corner = n * i + k;
                rates += turn * velocity_[corner] * (turn * gradient[k]).transpose();
                v += part * turn * velocity_[corner], a += part * turn * acceleration_[corner];
            }
            x += 1e-6 * (local(mesh.centroid(t) - tip_) - x);  // on its side of a face
            const Eigen::Vector3d strain = strain_of(H), stress = D * strain;
            const Vec2 flux = as_matrix(stress) * dq, along = H.col(0);
            const double area = mesh.area(t) / n_places, density = material.density;
            J += area * (flux.dot(along) - 0.5 * (stress.dot(strain) + density * v.squaredNorm()) * dq.x() +
                         density * (a.dot(along) - v.dot(rates.col(0))) * here);
            for (const int mode : {0, 1}) {
                const Eigen::Matrix2d W = williams_gradient(x, mode, kappa, shear);
                const Eigen::Vector3d other = strain_of(W);
                M[mode] += area * (flux.dot(W.col(0)) + (as_matrix(D * other) * dq).dot(along) -
                                   stress.dot(other) * dq.x() + density * a.dot(W.col(0)) * here);
            }
        }
    }
    const double half_modulus = 0.5 * material.plane_modulus(model_.plane);
    return {half_modulus * M[0], half_modulus * M[1], J};
}

}  // namespace knap
