#include "element/elastic_forces.hpp"

#include "element/shape_functions.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

namespace knap {
namespace {

constexpr float infinite = std::numeric_limits<float>::infinity();

float rounded_down(double x) { return std::isinf(x) ? infinite : std::nextafter(static_cast<float>(x), -infinite); }

void mark(std::uint8_t& flag) { std::atomic_ref(flag).store(1, std::memory_order_relaxed); }

std::vector<LameConstants> lame_constants(const std::vector<Elastic>& materials, PlaneModel plane) {
    std::vector<LameConstants> constants;
    for (const Elastic& material : materials)
        constants.push_back({material.first_lame(plane), 2 * material.shear_modulus()});
    return constants;
}

/// Empty: all are isotropic.
std::vector<LayerStiffness> layer_stiffness(const std::vector<Elastic>& materials, PlaneModel plane) {
    std::vector<LayerStiffness> layers;
    if (std::ranges::none_of(materials, [](const Elastic& material) { return material.bedding.has_value(); }))
        return layers;
    for (const Elastic& material : materials) {
        const Eigen::Matrix3d D = material.stiffness_of_layers(plane).value_or(Eigen::Matrix3d::Zero());
        layers.push_back({D(0, 0), D(0, 1), D(0, 2), D(1, 1), D(1, 2), D(2, 2)});
    }
    return layers;
}

/// The fastest one that this machine can run.
ConstantStrainForces fastest_kernel(const KernelKind& kind) {
#ifdef KNAP_AVX2
    if (__builtin_cpu_supports("avx2")) return avx2_kernel(kind);
#endif
    return baseline_kernel(kind);
}

}  // namespace

ConstantStrainTriangles::ConstantStrainTriangles(const Mesh& mesh, const std::vector<Elastic>& materials,
                                                 const ElasticKinds& kinds, PlaneModel plane, double thickness,
                                                 StrainMeasure measure)
    : stiffness_(lame_constants(kinds.all, plane)),
      layers_(layer_stiffness(kinds.all, plane)),
      forces_(fastest_kernel({measure, false, !layers_.empty()})),
      viscous_forces_(fastest_kernel({measure, true, !layers_.empty()})),
      viscosity_(viscous_coefficients(mesh, materials, plane)) {
    triangles_.reserve(mesh.n_triangles());
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        const auto g = shape_gradients(mesh, t);
        triangles_.push_back({.gradient1 = {g[1].x(), g[1].y()},
                              .gradient2 = {g[2].x(), g[2].y()},
                              .volume = mesh.area(t) * thickness,
                              .threshold = infinite,
                              .kind = kinds.of_triangle[t]});
    }
}

void ConstantStrainTriangles::set_stress_criterion(const std::vector<double>& threshold_of_fan,
                                                   const std::vector<Index>& fan_of_corner) {
    threshold_of_fan_ = threshold_of_fan;
    fan_of_corner_ = fan_of_corner;
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
        const Index* fan = &fan_of_corner_[3 * t];
        triangles_[t].threshold =
            rounded_down(std::min({threshold_of_fan[fan[0]], threshold_of_fan[fan[1]], threshold_of_fan[fan[2]]}));
    }
}

double ConstantStrainTriangles::evaluate(Index first, Index last, const std::vector<Vec2>& displacement,
                                         const std::vector<Index>& node_of_corner, Vec2* force,
                                         std::vector<std::uint8_t>& fan_is_candidate, ViscousStep* viscous) const {
    const auto evaluate = [&](ConstantStrainForces forces, ViscousTriangles* own) {
        return forces(first, last,
                      {.triangles = triangles_.data(),
                       .stiffness = stiffness_.data(),
                       .layers = layers_.data(),
                       .fan_of_corner = fan_of_corner_.data(),
                       .threshold_of_fan = threshold_of_fan_.data()},
                      displacement.data()->data(), node_of_corner.data(), force->data(), fan_is_candidate.data(), own);
    };
    if (viscous == nullptr) return evaluate(forces_, nullptr);
    ViscousTriangles own{.linear = viscosity_.linear.data(),
                         .quadratic = viscosity_.quadratic.data(),
                         .largest_rate = viscosity_.largest_rate.data(),
                         .shear = viscosity_.shear.data(),
                         .velocity = viscous->velocity.data()->data(),
                         .last_step = viscous->last_step,
                         .before = viscous->before,
                         .now = viscous->now,
                         .work = 0,
                         .unmoved = 0};
    const double energy = evaluate(viscous_forces_, &own);
    viscous->work += own.work, viscous->unmoved += own.unmoved;
    return energy;
}

QuadraticTriangles::QuadraticTriangles(const Mesh& mesh, const std::vector<Elastic>& materials, PlaneModel plane,
                                       double thickness)
    : viscosity_(viscous_coefficients(mesh, materials, plane)) {
    const ElasticKinds kinds(mesh, materials);
    stiffness_ = lame_constants(kinds.all, plane);
    for (const Elastic& kind : kinds.all) layers_.push_back(kind.stiffness_of_layers(plane));
    triangles_.reserve(mesh.n_triangles());
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        const auto g = shape_gradients(mesh, t);
        const Index kind = kinds.of_triangle[t];
        const Elastic& elastic = kinds.all[kind];
        const double volume = mesh.area(t) * thickness;
        const Eigen::Matrix2d R =
            bubble_stiffness(g, volume, elastic.first_lame(plane), elastic.shear_modulus(), layers_[kind]);
        triangles_.push_back({.gradient1 = g[1],
                              .gradient2 = g[2],
                              .volume = volume,
                              .R_xx = R(0, 0),
                              .R_yy = R(1, 1),
                              .R_xy = R(0, 1),
                              .kind = kind});
    }
}

void QuadraticTriangles::set_stress_criterion(const std::vector<double>& threshold_of_fan,
                                              const std::vector<Index>& fan_of_corner) {
    fan_of_corner_ = fan_of_corner;
    limit2_.resize(triangles_.size());
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
        const Vec2 &g1 = triangles_[t].gradient1, &g2 = triangles_[t].gradient2;
        for (Index k = 0; k < 6; ++k) {
            const double force = force_of_unit_stress({-(g1 + g2), g1, g2}, triangles_[t].volume, 2, k);
            limit2_[t][k] = rounded_down(threshold_of_fan[fan_of_corner[7 * t + k]] * force * force);
        }
    }
}

/// (s, q_xx, q_xy) at the middle of the edge opposite to vertex k; `strain` is (xx + yy, xx - yy, 2 xy), of which they
/// are conjugate.
Eigen::Vector3d QuadraticTriangles::viscous_stress(Index t, Index k, const Index* node, const std::array<Vec2, 3>& g,
                                                   const Eigen::Vector3d& strain, ViscousStep& viscous) const {
    const std::array<Vec2, 7> weight = middle_gradients(g, k);
    Eigen::Vector3d rate = Eigen::Vector3d::Zero();
    for (Index c = 0; c < 7; ++c) {
        const Vec2 &w = weight[c], &v = viscous.velocity[node[c]];
        rate += Eigen::Vector3d(w.dot(v), w.x() * v.x() - w.y() * v.y(), w.y() * v.x() + w.x() * v.y());
    }
    const double squeeze = std::clamp(-rate[0], 0.0, viscosity_.largest_rate[t]), volume = triangles_[t].volume / 3;
    const Eigen::Vector3d now{(viscosity_.linear[t] + viscosity_.quadratic[t] * squeeze) * rate[0],
                              viscosity_.shear[t] * rate[1], viscosity_.shear[t] * rate[2]};
    const std::ptrdiff_t place = viscous_components * (3 * t + k);
    const Eigen::Map<const Eigen::Vector3d> before(viscous.before + place);
    Eigen::Map<Eigen::Vector3d>(viscous.now + place) = now;
    viscous.work -= 0.5 * viscous.last_step * volume * (before + now).dot(rate);
    viscous.unmoved -= volume * now.dot(strain);
    return now;
}

double QuadraticTriangles::evaluate(Index first, Index last, const std::vector<Vec2>& displacement,
                                    const std::vector<Index>& node_of_corner, Vec2* force,
                                    std::vector<std::uint8_t>& fan_is_candidate, ViscousStep* viscous) const {
    for (std::ptrdiff_t t = first; t < last; ++t, force += 7) {
        const Triangle& here = triangles_[t];
        const Index* node = &node_of_corner[7 * t];
        Vec2 u[7];
        for (int c = 0; c < 7; ++c) u[c] = displacement[node[c]];
        const std::array<Vec2, 3> g{-(here.gradient1 + here.gradient2), here.gradient1, here.gradient2};
        const Vec2 middles = u[3] + u[4] + u[5];
        const Vec2 a = u[6] + (u[0] + u[1] + u[2]) / 9 - 4. / 9 * middles;
        const Vec2 along1 = u[1] - u[0], along2 = u[2] - u[0];  // linear part: sum_i u_i (x) g_i
        const double L_xx = along1.x() * g[1].x() + along2.x() * g[2].x(),
                     L_xy = along1.x() * g[1].y() + along2.x() * g[2].y();
        const double L_yx = along1.y() * g[1].x() + along2.y() * g[2].x(),
                     L_yy = along1.y() * g[1].y() + along2.y() * g[2].y();
        const LameConstants& elastic = stiffness_[here.kind];
        const std::optional<Eigen::Matrix3d>& layers = layers_[here.kind];

        double s_xx = 0, s_yy = 0, s_xy = 0;  // sum of the three stresses
        Vec2 pull[3], sum = Vec2::Zero();     // V/3 sigma_k g_k, conjugate to d_k
        for (int k = 0; k < 3; ++k) {
            const Vec2 d = 2 * (middles - 2 * u[3 + (k + 1) % 3] - u[k]) + 2.7 * a;
            const double xx = L_xx + d.x() * g[k].x(), yy = L_yy + d.y() * g[k].y();
            const double xy = 0.5 * (L_xy + L_yx + d.x() * g[k].y() + d.y() * g[k].x());
            double trace = elastic.lambda * (xx + yy);
            double q_xx = 0, q_xy = 0;
            if (viscous != nullptr) {
                const Eigen::Vector3d s = viscous_stress(t, k, node, g, {xx + yy, xx - yy, 2 * xy}, *viscous);
                trace += s[0], q_xx = s[1], q_xy = s[2];
            }
            double k_xx = trace + elastic.twice_shear * xx + q_xx, k_yy = trace + elastic.twice_shear * yy - q_xx,
                   k_xy = elastic.twice_shear * xy + q_xy;
            if (layers) {
                const Eigen::Vector3d further = *layers * Eigen::Vector3d(xx, yy, 2 * xy);
                k_xx += further[0], k_yy += further[1], k_xy += further[2];
            }
            s_xx += k_xx, s_yy += k_yy, s_xy += k_xy;
            pull[k] = here.volume / 3 * Vec2(k_xx * g[k].x() + k_xy * g[k].y(), k_xy * g[k].x() + k_yy * g[k].y());
            sum += pull[k];
        }
        // conjugate to a
        const Vec2 q = 2.7 * sum + Vec2(here.R_xx * a.x() + here.R_xy * a.y(), here.R_xy * a.x() + here.R_yy * a.y());
        Vec2 all = Vec2::Zero();
        for (int k = 0; k < 3; ++k) {
            const Vec2 linear =
                here.volume / 3 * Vec2(s_xx * g[k].x() + s_xy * g[k].y(), s_xy * g[k].x() + s_yy * g[k].y());
            force[k] = -linear + 2 * pull[k] - q / 9;
            force[3 + (k + 1) % 3] = -2 * (sum - 2 * pull[k]) + 4. / 9 * q;
            all += force[k] + force[3 + (k + 1) % 3];
        }
        force[6] = -all;
        if (limit2_.empty()) continue;
        for (int k = 0; k < 6; ++k)
            if (force[k].squaredNorm() > static_cast<double>(limit2_[t][k]))
                mark(fan_is_candidate[fan_of_corner_[7 * t + k]]);
    }
    return 0;
}

ElasticForces::ElasticForces(const Mesh& mesh, const std::vector<Elastic>& materials, PlaneModel plane,
                             double thickness, bool large_rotation)
    : triangles_(ConstantStrainTriangles(mesh, materials, plane, thickness,
                                         large_rotation ? StrainMeasure::green : StrainMeasure::small)),
      n_triangles_(mesh.n_triangles()),
      corners_per_triangle_(mesh.corners_per_triangle()) {
    if (mesh.order == 2) triangles_ = QuadraticTriangles(mesh, materials, plane, thickness);
}

void ElasticForces::set_stress_criterion(const std::vector<double>& threshold_of_fan,
                                         const std::vector<Index>& fan_of_corner) {
    std::visit([&](auto& triangles) { triangles.set_stress_criterion(threshold_of_fan, fan_of_corner); }, triangles_);
}

void ElasticForces::evaluate(const std::vector<Vec2>& displacement, const std::vector<Index>& node_of_corner,
                             std::vector<Vec2>& corner_force, std::vector<std::uint8_t>& fan_is_candidate) const {
    constexpr Index block = 1024;
#pragma omp parallel for schedule(static) if (n_triangles_ > block)
    for (Index first = 0; first < n_triangles_; first += block)
        evaluate(first, std::min(first + block, n_triangles_), displacement, node_of_corner,
                 &corner_force[corners_per_triangle_ * first], fan_is_candidate);
}

}  // namespace knap
