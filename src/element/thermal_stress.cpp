#include "element/thermal_stress.hpp"

#include "element/shape_functions.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

namespace knap {

ThermalStress::ThermalStress(const Mesh& mesh, const std::vector<Elastic>& materials, PlaneModel plane,
                             double thickness, bool large_rotation)
    : mesh_(mesh), order_(mesh.order), large_rotation_(large_rotation) {
    ElasticKinds kinds(mesh, materials);
    for (const Elastic& kind : kinds.all) {
        const Eigen::Matrix2d A = kind.expansion_in_plane(plane);
        Eigen::Matrix2d P = Eigen::Matrix2d::Identity();
        if (kind.bedding) P = kind.stress_of_expansion(plane) / (2 * (kind.first_lame(plane) + kind.shear_modulus()));
        directions_.push_back({A, P, A.cwiseProduct(P).sum()});
    }
    kind_ = std::move(kinds.of_triangle);
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        const Elastic& material = materials[mesh.region[t]];
        const Vec2 origin = mesh.corner(t, 0);
        triangles_.push_back({.edge1 = mesh.corner(t, 1) - origin,
                              .edge2 = mesh.corner(t, 2) - origin,
                              .half_pressure = (material.first_lame(plane) + material.shear_modulus()) * thickness,
                              .threshold = infinity,
                              .volume = mesh.area(t) * thickness});
    }
}

void ThermalStress::set_stress_criterion(const std::vector<double>& threshold_of_fan,
                                         const std::vector<Index>& fan_of_corner) {
    threshold_of_fan_ = threshold_of_fan;
    fan_of_corner_ = fan_of_corner;
    for (Index t = 0; t < n_triangles(); ++t) {
        Triangle& here = triangles_[t];
        here.threshold = infinity;
        for (Index k = 0; k < n_corners(); ++k)
            here.threshold = std::min(here.threshold, threshold_of_fan[fan_of_corner[n_corners() * t + k]]);
        here.threshold *= here.volume * here.volume;
    }
}

/// Calls add(m, c, w) with the weights of grad u = sum_c u_c (x) w at the places m of the strains.
template <class Add>
void ThermalStress::for_each_weight(Index t, const Add& add) const {
    const auto g = shape_gradients(mesh_, t);
    if (order_ == 1) {
        for (Index c = 0; c < 3; ++c) add(0, c, g[c]);
        return;
    }
    for (Index m = 0; m < 3; ++m) {
        const auto weight = middle_gradients(g, m);
        for (Index c = 0; c < 7; ++c) add(m, c, weight[c]);
    }
}

/// On the corners of a triangle.
void ThermalStress::add_forces_of(Index t, std::span<const double> strain, double factor, Vec2* force) const {
    // V p = 2 (p t/2) area, over the number of strains
    const double of_strain = factor * 2 * triangles_[t].half_pressure * mesh_.area(t) / n_strains();
    const Eigen::Matrix2d& P = directions(t).stress;
    for_each_weight(t, [&](Index m, Index c, const Vec2& weight) {
        force[c] += of_strain * strain[n_strains() * t + m] * (P * weight);
    });
}

void ThermalStress::add_forces(std::span<const double> strain, double factor, std::vector<Vec2>& force) const {
#pragma omp parallel for schedule(static) if (n_triangles() > 1024)
    for (Index t = 0; t < n_triangles(); ++t) add_forces_of(t, strain, factor, &force[n_corners() * t]);
}

/// sigma : e A = 2 (lambda + mu) e (P : eps - e P : A)
double ThermalStress::product_of(Index t, const std::vector<Vec2>& displacement,
                                 const std::vector<Index>& node_of_corner, std::span<const double> strain,
                                 std::span<const double> other) const {
    const auto& [A, P, product] = directions(t);
    std::array<double, 3> trace{};  // P : eps
    const Vec2& origin = displacement[node_of_corner[n_corners() * t]];
    for_each_weight(t, [&](Index m, Index c, const Vec2& weight) {
        trace[m] += Vec2(P * weight).dot(displacement[node_of_corner[n_corners() * t + c]] - origin);
    });
    double sum = 0;
    if (large_rotation_) {  // of E
        const Eigen::Matrix2d H = gradient(t, displacement, node_of_corner);
        trace[0] += 0.5 * (H * P).cwiseProduct(H).sum();
    }
    for (Index m = 0; m < n_strains(); ++m)
        sum += (trace[m] - product * strain[n_strains() * t + m]) * other[n_strains() * t + m];
    return 2 * triangles_[t].half_pressure * mesh_.area(t) / n_strains() * sum;
}

double ThermalStress::product(Index first, Index last, const std::vector<Vec2>& displacement,
                              const std::vector<Index>& node_of_corner, std::span<const double> strain,
                              std::span<const double> other) const {
    double sum = 0;
    for (Index t = first; t < last; ++t) sum += product_of(t, displacement, node_of_corner, strain, other);
    return sum;
}

Eigen::Matrix2d ThermalStress::gradient(Index t, const std::vector<Vec2>& displacement,
                                        const std::vector<Index>& node_of_corner) const {
    const auto g = shape_gradients(mesh_, t);
    Eigen::Matrix2d H = Eigen::Matrix2d::Zero();
    for (Index k = 0; k < 3; ++k) H += displacement[node_of_corner[3 * t + k]] * g[k].transpose();
    return H;
}

/// -int eps : D e A + 1/2 int e A : D e A
double ThermalStress::energy(Index first, Index last, const std::vector<Vec2>& displacement,
                             const std::vector<Index>& node_of_corner, std::span<const double> strain) const {
    double sum = 0;
    for (Index t = first; t < last; ++t) {
        sum -= product_of(t, displacement, node_of_corner, strain, strain);
        for (Index m = 0; m < n_strains(); ++m)
            sum -= directions(t).product * triangles_[t].half_pressure * mesh_.area(t) / n_strains() *
                   strain[n_strains() * t + m] * strain[n_strains() * t + m];
    }
    return sum;
}

// Order 1: V grad l_1 = -t/2 turned(e_2), V grad l_2 = t/2 turned(e_1), and the forces give the stress back:
//     V sigma = -(f_1 (x) e_1 + f_2 (x) e_2)
double ThermalStress::evaluate(Index first, Index last, const std::vector<Vec2>& displacement,
                               const std::vector<Index>& node_of_corner, std::span<const double> strain,
                               std::span<const double> other, Vec2* force,
                               std::vector<std::uint8_t>& fan_is_candidate) const {
    const auto mark = [&](Index fan) { std::atomic_ref(fan_is_candidate[fan]).store(1, std::memory_order_relaxed); };
    const Index n = n_corners();
    double sum = 0;
    for (Index t = first; t < last; ++t, force += n) {
        const Triangle& here = triangles_[t];
        if (order_ == 2) {
            add_forces_of(t, strain, 1, force);
            sum += product_of(t, displacement, node_of_corner, strain, other);
            const auto g = shape_gradients(mesh_, t);
            for (Index k = 0; k < 6 && !fan_of_corner_.empty(); ++k) {
                const double unit = force_of_unit_stress(g, here.volume, 2, k);
                const Index fan = fan_of_corner_[7 * t + k];
                if (force[k].squaredNorm() > threshold_of_fan_[fan] * unit * unit) mark(fan);
            }
            continue;
        }
        const double pressure = here.half_pressure * strain[t];
        const auto& [A, P, product] = directions(t);
        Vec2 p1 = -pressure * P * turned_left(here.edge2), p2 = pressure * P * turned_left(here.edge1);
        if (large_rotation_) {  // F turns them
            const Eigen::Matrix2d H = gradient(t, displacement, node_of_corner);
            p1 += H * p1, p2 += H * p2;
            sum += product_of(t, displacement, node_of_corner, strain, other);
        }
        const Vec2 f1 = force[1] + p1, f2 = force[2] + p2;
        force[0] = -(f1 + f2);
        force[1] = f1;
        force[2] = f2;
        if (!large_rotation_) sum -= (f1.dot(A * here.edge1) + f2.dot(A * here.edge2)) * other[t];
        const double norm2 = f1.squaredNorm() * here.edge1.squaredNorm() + 2 * f1.dot(f2) * here.edge1.dot(here.edge2) +
                             f2.squaredNorm() * here.edge2.squaredNorm();
        if (norm2 > here.threshold) {
            for (Index k = 0; k < 3; ++k) {
                const Index fan = fan_of_corner_[3 * t + k];
                if (norm2 > threshold_of_fan_[fan] * here.volume * here.volume) mark(fan);
            }
        }
    }
    return sum;
}

}  // namespace knap
