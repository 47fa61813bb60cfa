#pragma once
// Element matrices of triangles, unknowns (x, y) of corner 0, 1, ... (mesh.hpp), and how their mass is shared out.
//     order 1:  K_ij = V [ lambda g_i g_j' + mu (g_j g_i' + g_i . g_j I) ]
//     order 2:  the mean of that over the middles of the edges with the weights of middle_gradients, and R of the bubble
//               (quadratic_triangles.hpp)
#include "element/mass_matrix.hpp"
#include "material/elastic.hpp"
#include "mesh/mesh.hpp"

namespace knap {

/// Square, as many rows as a triangle has unknowns or corners; never on the heap.
using ElementMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 14, 14>;

/// [N/m] for a triangle of this mesh with unit out-of-plane thickness times `thickness` [m].
ElementMatrix stiffness_matrix(const Mesh& mesh, Index triangle, const Elastic& material, PlaneModel plane, double thickness);

/// What corner k of a triangle gets of its mass, lumped, or of a uniform body force.
double corner_share(Index order, Index k, double of_triangle);
/// A triangle's mass between its corners, for the mass 1 (mass_matrix.hpp).
const ElementMatrix& mass_matrix(Index order, MassMatrix mass);

/// 2/omega_max of each free triangle with lumped mass [s]: the stable step of the central difference scheme when everything is split.
std::vector<double> stable_steps(const Mesh& mesh, const std::vector<Elastic>& materials, PlaneModel plane);

}  // namespace knap
