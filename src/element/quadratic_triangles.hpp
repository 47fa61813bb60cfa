#pragma once
// Internal forces of triangles of second order with straight edges: six nodes and a bubble, 27 l_0 l_1 l_2, seven corners with the masses
// m/20 (vertices), 2 m/15 (middles of the edges), 9 m/20 (centre): a quadrature of degree 3, so that lumping costs no order (I. Fried,
// D. S. Malkus, Int. J. Solids Struct. 11 (1975) 461; G. Cohen, P. Joly, J. Roberts, N. Tordjman, SIAM J. Numer. Anal. 38 (2001) 2047).
//
// The gradient of the quadratic part is linear, that of the bubble is not; only its projection on the linear functions works on the
// quadratic part. With l_k = 0 at the middle m_k of the edge opposite to vertex k, which belongs to corner 3 + (k + 1) % 3, and
//
//     a   = u_c + (u_0 + u_1 + u_2)/9 - 4/9 (u_m0 + u_m1 + u_m2)                            amplitude of the bubble
//     G_k = sum_i u_i (x) g_i + d_k (x) g_k,    d_k = 2 (sum u_m - 2 u_mk - u_k) + 2.7 a      gradient at m_k
//     R   = 1.62 V sum_k [lambda g_k g_k' + mu (g_k g_k' + |g_k|^2 I)]                       what the projection leaves of the bubble
//
// the energy is (V/3) sum_k 1/2 sigma_k : eps_k + 1/2 a' R a, exactly: three stresses and one 2 x 2 matrix. (By parts, the integral of grad b l_i
// is -9/20 A g_i; its projection at m_k is 2.7 g_k; the integral of grad b (x) grad b is 4.05 A sum g_k (x) g_k, of which 2.43 projected.)
#include "element/linear_triangles.hpp"

namespace knap {

/// The opposite to vertex k: the corner in the middle of the edge.
inline Index opposite_middle(Index k) { return 3 + (k + 1) % 3; }

/// Weights of a triangle's corners: G_k = sum_c u_c (x) (weight of c at m_k), the linear part and d_k together. [1/m]
std::array<Vec2, 7> middle_gradients(const std::array<Vec2, 3>& g, Index k);
/// a = sum_c u_c bubble_weight[c]
inline constexpr std::array<double, 7> bubble_weight{1. / 9, 1. / 9, 1. / 9, -4. / 9, -4. / 9, -4. / 9, 1};
/// [N/m] R of a triangle of this volume.
Eigen::Matrix2d bubble_stiffness(const std::array<Vec2, 3>& g, double volume, double lame, double shear);

class QuadraticTriangles {
public:
    QuadraticTriangles(const Mesh& mesh, const std::vector<Elastic>& materials, PlaneModel plane, double thickness);

    /// As in ElasticForces; here the forces themselves are compared, each with the largest that a uniform stress can make it.
    void set_stress_criterion(const std::vector<double>& threshold_of_fan, const std::vector<Index>& fan_of_corner);
    void evaluate(Index first, Index last, const std::vector<Vec2>& displacement, const std::vector<Index>& node_of_corner, Vec2* force,
                  std::vector<std::uint8_t>& fan_is_candidate) const;

private:
    struct Triangle {
        Vec2 gradient1, gradient2;  // [1/m] of the linear shape functions of vertices 1 and 2; vertex 0 has minus their sum
        double volume;              // [m3]
        double R_xx, R_yy, R_xy;    // [N/m]
        Index material;
    };
    struct Stiffness {
        double lame, twice_shear;  // [Pa]
    };
    std::vector<Triangle> triangles_;
    std::vector<Stiffness> stiffness_;        // per material
    std::vector<std::array<float, 6>> hold_;  // [N^2] per triangle: squares of the forces on corners 0 to 5 that their fans surely hold
    std::vector<Index> fan_of_corner_;
};

}  // namespace knap
