#pragma once
// Element matrices of triangles; unknowns are x and y of corner 0, 1, ... (mesh.hpp).
//     order 1:  K_ij = V [ lambda g_i g_j' + mu (g_j g_i' + g_i . g_j I) ]
//     order 2:  the mean of that over the middles of the edges with middle_gradients, plus R of the bubble
//               (shape_functions.hpp)
#include "element/elastic_of.hpp"
#include "element/mass_matrix.hpp"

#include <span>

namespace knap {

/// Square, as many rows as a triangle has unknowns or corners; never on the heap.
using ElementMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 14, 14>;

/// [N/m]; `thickness` [m] out of the plane.
ElementMatrix stiffness_matrix(const Mesh& mesh, Index triangle, const Elastic& material, PlaneModel plane,
                               double thickness);

/// The share of corner k in the lumped mass or the uniform body force `of_triangle`.
double corner_share(Index order, Index k, double of_triangle);
/// One row per corner, for a triangle of mass 1.
const ElementMatrix& mass_matrix(Index order, MassMatrix mass);

/// [s] of a triangle: 2/omega_max with lumped mass and free boundaries, the stable step of central differences if every
/// interface is split. With bulk viscosity it is shorter (bulk_viscosity.hpp).
class StableStep {
public:
    StableStep(const std::vector<Elastic>& materials, PlaneModel plane);
    /// `mass_factor`: of the mass of its material.
    double operator()(const Mesh& mesh, Index triangle, double mass_factor = 1) const;

private:
    const std::vector<Elastic>& materials_;
    PlaneModel plane_;
    std::vector<Eigen::Matrix3d> factor_;  // Cholesky factor of the stiffness of each material
};
/// [s] Stable step of every triangle by itself; `mass_factors`: of their masses, or empty.
std::vector<double> stable_steps(const Mesh& mesh, const std::vector<Elastic>& materials, PlaneModel plane,
                                 std::span<const double> mass_factors = {});

}  // namespace knap
