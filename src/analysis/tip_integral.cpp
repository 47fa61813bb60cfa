#include "analysis/tip_integral.hpp"

#include "base/display_unit.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "element/shape_functions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
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

}  // namespace

TipIntegral::TipIntegral(const Model& model, const Vec2& at, double radius, const std::string& probe)
    : model_(model), radius_(radius) {
    const Mesh& mesh = model.mesh;
    place_tip(at, probe);
    for (Index t = 0; t < mesh.n_triangles(); ++t)
        if (std::ranges::any_of(mesh.triangles[t], [&](Index v) { return is_inside(v); })) triangles_.push_back(t);
    check_domain(probe);
    find_body_forces(probe);
    find_faces();
    if (!model.crack_fluids.empty()) fluids_ = std::make_unique<CrackForces>(model);
    for (std::size_t i = 0; i < model.interfaces.size(); ++i) {
        const Interface& interface = model.interfaces[i];
        if (interface.cracked || !(is_inside(interface.vertex[0]) || is_inside(interface.vertex[1]))) continue;
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
        fail(probe, "the nearest tip is at " + at_place(tip_) + ", " + readable(nearest, "m", 6) +
                        " from its place: farther than its radius");
}

void TipIntegral::refuse(const std::string& probe, const std::string& what, const Vec2& where) const {
    fail(probe, what + " at " + at_place(where) + " lies within its radius of " + readable(radius_, "m", 6) +
                    " from the tip at " + at_place(tip_) + ": a smaller radius");
}

void TipIntegral::check_domain(const std::string& probe) const {
    const Mesh& mesh = model_.mesh;
    if (model_.large_rotation) fail(probe, "rotations are large: its integrals are those of small ones");
    if (!model_.initial_stress.empty())
        fail(probe, "the body has an initial stress: its integrals know the stress of strains alone");
    for (const BoundaryEdge& edge : mesh.boundary_edges)
        for (const Index k : {edge.side, (edge.side + 1) % 3})
            if (const Index v = mesh.triangles[edge.triangle][k]; is_inside(v))
                refuse(probe, "the boundary", mesh.vertices[v]);
    double edges = 0, n = 0;
    for (const Interface& i : model_.interfaces) {
        if (!is_inside(i.vertex[0]) && !is_inside(i.vertex[1])) continue;
        edges += i.length, ++n;
        for (const Index v : i.vertex) {
            const Vec2 x = local(mesh.vertices[v] - tip_);
            if (i.cracked && is_inside(v) && (x.x() > 1e-9 * radius_ || std::abs(x.y()) > 1e-6 * radius_))
                refuse(probe, "another crack, or a bend of this one,", mesh.vertices[v]);
        }
    }
    if (radius_ < 4 * edges / n)
        fail(probe, "its radius of " + readable(radius_, "m", 6) + " is less than four edges of " +
                        readable(edges / n, "m", 6) + ": a larger radius or a finer mesh");
    for (const Index t : triangles_) {
        if (mesh.region[t] != mesh.region[triangles_.front()]) refuse(probe, "another material", mesh.centroid(t));
        if (!mesh.layer_angle.empty() && mesh.layer_angle[t] != mesh.layer_angle[triangles_.front()])
            refuse(probe, "another direction of the layers", mesh.centroid(t));
    }
}

/// Loads on corners inside the radius: a uniform body force has the same force over mass on all of them.
void TipIntegral::find_body_forces(const std::string& probe) {
    const Mesh& mesh = model_.mesh;
    std::map<Index, std::pair<Vec2, Index>> of_history;  // acceleration, number of corners
    Index n_inside = 0;
    for (const Index t : triangles_)
        for (Index c = mesh.corners_per_triangle() * t; c < mesh.corners_per_triangle() * (t + 1); ++c) {
            const Vec2 place = mesh.corner(c);
            if ((place - tip_).norm() >= radius_) continue;
            ++n_inside;
            if (model_.motion_of(c)) refuse(probe, "a prescribed motion", place);
            const auto loads = std::ranges::equal_range(model_.corner_loads, c, {}, &CornerLoad::corner);
            for (const CornerLoad& load : loads) {
                const Vec2 acceleration = load.force / model_.corner_mass[c];
                auto& [first, n] = of_history.try_emplace(load.history, acceleration, 0).first->second;
                ++n;
                if ((acceleration - first).norm() > 1e-9 * first.norm()) refuse(probe, "a load", place);
            }
        }
    for (const auto& [history, load] : of_history) {
        if (load.second != n_inside) refuse(probe, "the border of a load", tip_);
        body_forces_.push_back({history, load.first});
    }
}

void TipIntegral::find_faces() {
    for (std::size_t i = 0; i < model_.interfaces.size(); ++i) {
        const Interface& interface = model_.interfaces[i];
        if (!interface.cracked || !(is_inside(interface.vertex[0]) || is_inside(interface.vertex[1]))) continue;
        const Index first = model_.points_per_interface() * static_cast<Index>(i);
        Face face{.normal = local(interface.normal), .side = interface.normal.dot(turned_left(along_)) > 0 ? 1. : -1.};
        const double at[] = {distance(interface.vertex[0]), distance(interface.vertex[1])};
        const Index far = at[0] > at[1] ? 0 : 1, last = model_.mesh.order;  // the middle is point 2
        face.point[0] = first + far, face.behind[0] = at[far];
        face.point[last] = first + 1 - far, face.behind[last] = at[1 - far];
        if (last == 2) face.point[1] = first + 2, face.behind[1] = 0.5 * (at[0] + at[1]);
        for (Index k = 0; k <= last; ++k) face.q[k] = q_at(face.behind[k]);
        faces_.push_back(face);
    }
}

bool TipIntegral::has_vanished() const {
    return std::ranges::any_of(triangles_, [&](Index t) { return model_.has_vanished(t); });
}

void TipIntegral::continue_from(TipIntegral&& other) {
    if (other.triangles_ != triangles_) return;
    velocity_ = std::move(other.velocity_), acceleration_ = std::move(other.acceleration_);
    last_step_ = other.last_step_, known_ = other.known_;
}

void TipIntegral::after_step(const State& state) {
    const bool first = velocity_.empty();
    const Index n = model_.mesh.corners_per_triangle();
    velocity_.resize(n * triangles_.size(), Vec2::Zero());
    acceleration_.resize(velocity_.size(), Vec2::Zero());
    // explicit bulk: velocities live at the middle of the steps
    const double elapsed = state.has_end_velocities() ? state.last_step : 0.5 * (last_step_ + state.last_step);
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

// The part - int t [u],x q ds of J and - int t [w],x q ds of both modes. x = -r on the faces. Williams' jumps from the
// right to the left face are g(r) along the normal (mode I) or along x (mode II),
//     g = (kappa + 1)/mu sqrt(r/(2 pi)),     int f g' dr = [f g] - f' int g dr     exactly, for f linear between points
TipFactors TipIntegral::of_faces(const State& state, double kappa, double shear) const {
    TipFactors sum{0, 0, 0};
    if (faces_.empty()) return sum;
    std::vector<double> pressures;
    if (fluids_) pressures = fluids_->pressures(state);
    const double g_1 = (kappa + 1) / (shear * std::sqrt(2 * std::numbers::pi));
    const auto g = [&](double r) { return g_1 * std::sqrt(r); };
    const auto integral_of_g = [&](double r) { return 2. / 3 * r * g(r); };
    const Index last = model_.mesh.order;
    for (const Face& face : faces_) {
        std::array<Vec2, 3> load{}, jump{};  // q t and [u], local
        for (Index k = 0; k <= last; ++k) {
            // corners at the tip move as one: its contact forces are not known, those of its neighbour act there
            const Index from = face.behind[k] > 1e-9 * radius_ ? face.point[k] : face.point[k - 1];
            const Vec2 in_frame = traction(model_, state, from), open = opening(model_, state, face.point[k]);
            const double pressure = pressures.empty() ? 0 : pressures[face.point[k]];
            load[k] = face.q[k] * ((in_frame.x() + pressure) * face.normal + in_frame.y() * turned_left(face.normal));
            jump[k] = open.x() * face.normal + open.y() * turned_left(face.normal);
        }
        for (Index k = 0; k < last; ++k) {
            const double far = face.behind[k], near = face.behind[k + 1], length = far - near;
            // of order 2 linear on the halves of the edge
            sum.J -= 0.5 * (load[k] + load[k + 1]).dot(jump[k + 1] - jump[k]);
            const Vec2 slope = (load[k] - load[k + 1]) / length,
                       part = g(far) * load[k] - g(near) * load[k + 1] -
                              (integral_of_g(far) - integral_of_g(near)) * slope;
            sum.K_I += face.side * part.y();
            sum.K_II += face.side * part.x();
        }
    }
    return sum;
}

TipFactors TipIntegral::factors(const State& state) const {
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    if (!known_ || !stands(state)) return {unknown, unknown, unknown};
    const Mesh& mesh = model_.mesh;
    Elastic material = model_.elastic(triangles_.front());
    if (material.bedding) material.bedding->angle -= std::atan2(along_.y(), along_.x());
    const double nu = material.nu, shear = material.shear_modulus();
    const double kappa = model_.plane == PlaneModel::strain ? 3 - 4 * nu : (3 - nu) / (1 + nu);
    const Eigen::Matrix3d D = material.stiffness(model_.plane);
    const Eigen::Vector3d expanded = strain_of(material.expansion_in_plane(model_.plane));
    const Eigen::Matrix2d turn = (Eigen::Matrix2d() << along_, turned_left(along_)).finished().transpose();
    const Index n = mesh.corners_per_triangle(), n_places = mesh.order == 1 ? 1 : 3;
    Vec2 body_force = Vec2::Zero();  // [m/s2] local
    for (const BodyForce& force : body_forces_)
        body_force += model_.histories[force.history](state.time) * (turn * force.acceleration);
    const TipFactors faces = of_faces(state, kappa, shear);
    double J = faces.J, M[2] = {faces.K_I, faces.K_II};
    const Expansion* expansion =
        state.temperature ? &model_.heat->materials[mesh.region[triangles_.front()]].expansion : nullptr;
    const double in_plane = model_.plane == PlaneModel::strain ? 1 + nu : 1;  // of the thermal strain
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
        const Index t = triangles_[i];
        const auto g = shape_gradients(mesh, t);
        std::array<double, 3> q_of;
        Vec2 dq = Vec2::Zero();
        double warming = 0;  // e_,x
        for (Index k = 0; k < 3; ++k) {
            q_of[k] = q_at(distance(mesh.triangles[t][k])), dq += q_of[k] * turn * g[k];
            if (expansion)
                warming += in_plane * (*expansion)(state.temperature->of_corner[n * t + k]) * along_.dot(g[k]);
        }
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
            Eigen::Vector3d strain = strain_of(H);
            if (expansion) strain -= state.temperature->strain[n_places * t + m] * expanded;
            const Eigen::Vector3d stress = D * strain;
            a -= body_force;
            const Vec2 flux = stress_matrix(stress) * dq, along = H.col(0);
            const double area = mesh.area(t) / n_places, density = material.density;
            J += area * (flux.dot(along) - 0.5 * (stress.dot(strain) + density * v.squaredNorm()) * dq.x() +
                         density * (a.dot(along) - v.dot(rates.col(0))) * here + stress.dot(expanded) * warming * here);
            for (const int mode : {0, 1}) {
                const Eigen::Matrix2d W = williams_gradient(x, mode, kappa, shear);
                const Eigen::Vector3d other = strain_of(W), tau = D * other;
                M[mode] +=
                    area * (flux.dot(W.col(0)) + (stress_matrix(tau) * dq).dot(along) - stress.dot(other) * dq.x() +
                            (density * a.dot(W.col(0)) + (tau[0] + tau[1]) * warming) * here);
            }
        }
    }
    if (material.bedding) return {unknown, unknown, J};  // Williams' fields are those of isotropic bodies
    const double half_modulus = 0.5 * material.plane_modulus(model_.plane);
    return {half_modulus * M[0], half_modulus * M[1], J};
}

}  // namespace knap
