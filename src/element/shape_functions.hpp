#pragma once
// Shape functions of triangles with straight edges, in barycentric coordinates l_0, l_1, l_2 (corners: mesh.hpp).
// Order 1: the l_k. Order 2: six quadratic functions and the bubble 27 l_0 l_1 l_2 (derivation and sources: README.md).
// With m_k the middle of the edge opposite to vertex k, where l_k = 0, and g_k = grad l_k:
//
//     a   = u_c + (u_0 + u_1 + u_2)/9 - 4/9 (u_m0 + u_m1 + u_m2)                            amplitude of the bubble
//     G_k = sum_i u_i (x) g_i + d_k (x) g_k,    d_k = 2 (sum u_m - 2 u_mk - u_k) + 2.7 a    gradient at m_k
//     R   = 1.62 V sum_k [lambda g_k g_k' + mu (g_k g_k' + |g_k|^2 I)]                      the rest of the bubble
//
// and the energy is (V/3) sum_k 1/2 sigma_k : eps_k + 1/2 a' R a, exactly.
#include "material/elastic.hpp"
#include "mesh/mesh.hpp"

#include <optional>

namespace knap {

/// [1/m] g_0, g_1, g_2; their sum is zero.
inline std::array<Vec2, 3> shape_gradients(const Mesh& mesh, Index t) {
    std::array<Vec2, 3> gradients;
    for (Index k = 0; k < 3; ++k)
        gradients[k] = turned_left(mesh.corner(t, (k + 2) % 3) - mesh.corner(t, (k + 1) % 3)) / (2 * mesh.area(t));
    return gradients;
}

/// The corner in the middle of the edge opposite to vertex k.
inline Index opposite_middle(Index k) { return 3 + (k + 1) % 3; }

/// a = sum_c u_c bubble_weight[c]
inline constexpr std::array<double, 7> bubble_weight{1. / 9, 1. / 9, 1. / 9, -4. / 9, -4. / 9, -4. / 9, 1};

/// [1/m] G_k = sum_c u_c (x) (weight of corner c at m_k)
inline std::array<Vec2, 7> middle_gradients(const std::array<Vec2, 3>& g, Index k) {
    // d_k = sum_c w_c u_c with w = 2 (1, -2 opposite, -1 at vertex k) + 2.7 (bubble weights 1/9, -4/9, 1)
    std::array<Vec2, 7> weight;
    for (Index i = 0; i < 3; ++i) {
        weight[i] = g[i] + (i == k ? -1.7 : 0.3) * g[k];
        weight[3 + i] = (3 + i == opposite_middle(k) ? -3.2 : 0.8) * g[k];
    }
    weight[6] = 2.7 * g[k];
    return weight;
}

/// [N/m] R of a triangle of this volume [m3], and what the layers of a material add to it: B' D B in the sum above.
inline Eigen::Matrix2d bubble_stiffness(const std::array<Vec2, 3>& g, double volume, double lame, double shear,
                                        const std::optional<Eigen::Matrix3d>& layers = {}) {
    Eigen::Matrix2d R = Eigen::Matrix2d::Zero();
    for (const Vec2& g_k : g) {
        R += (lame + shear) * g_k * g_k.transpose() + shear * g_k.squaredNorm() * Eigen::Matrix2d::Identity();
        if (layers) R += strain_of_gradient(g_k).transpose() * *layers * strain_of_gradient(g_k);
    }
    return 1.62 * volume * R;
}

/// [m2] The largest force on corner k of a triangle of this volume [m3] under a uniform stress of norm 1. Order 1:
/// V |g_k|. Order 2: 1/6 of both neighbouring edges at a vertex, 4/6 of its own at the middle of an edge.
inline double force_of_unit_stress(const std::array<Vec2, 3>& g, double volume, Index order, Index k) {
    if (order == 1) return volume * g[k].norm();
    if (k < 3) return volume / 3 * g[k].norm();
    return k < 6 ? 4 * volume / 3 * g[(k + 2) % 3].norm() : 0;  // edge k - 3 is opposite to vertex (k - 1) % 3
}

}  // namespace knap
