#include "bulk/triangle_matrices.hpp"

namespace knap {

Matrix6 stiffness_matrix(const Mesh& mesh, Index t, const Elastic& material, PlaneModel plane, double thickness) {
    const double area = mesh.area(t), volume = area * thickness;
    const double lambda = volume * material.first_lame(plane), mu = volume * material.shear_modulus();
    Vec2 g[3];
    for (Index k = 0; k < 3; ++k) g[k] = turned_left(mesh.corner(t, (k + 2) % 3) - mesh.corner(t, (k + 1) % 3)) / (2 * area);
    Matrix6 K;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            K.block<2, 2>(2 * i, 2 * j) =
                lambda * g[i] * g[j].transpose() + mu * (g[j] * g[i].transpose() + g[i].dot(g[j]) * Eigen::Matrix2d::Identity());
    return K;
}

Matrix6 mass_matrix(double corner_mass, MassMatrix mass) {
    const auto [own, shared] = shares_of(mass);
    Matrix6 M = Matrix6::Zero();
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            M.block<2, 2>(2 * i, 2 * j) = corner_mass * (shared + (i == j ? own : 0)) * Eigen::Matrix2d::Identity();
    return M;
}

}  // namespace knap
