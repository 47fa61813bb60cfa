#pragma once
// Element matrices of constant-strain triangles, unknowns (x, y) of corner 0, 1, 2.
//     K_ij = V [ lambda g_i g_j' + mu (g_j g_i' + g_i . g_j I) ],   M_ij = m (own delta_ij + shared) I
#include "bulk/mass_matrix.hpp"
#include "geometry/mesh.hpp"
#include "material/elastic.hpp"

namespace knap {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// [N/m] for a triangle of this mesh with unit out-of-plane thickness times `thickness` [m].
Matrix6 stiffness_matrix(const Mesh& mesh, Index triangle, const Elastic& material, PlaneModel plane, double thickness);

/// [kg] from the mass of a corner (a third of the triangle's).
Matrix6 mass_matrix(double corner_mass, MassMatrix mass);

}  // namespace knap
