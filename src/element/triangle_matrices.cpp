#include "element/triangle_matrices.hpp"

#include "element/bulk_viscosity.hpp"
#include "element/shape_functions.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <span>

namespace knap {
namespace {

/// Adds V B' D B, with D by its Lame constants and, of layers, a further part; all of them are given times V.
void add_stiffness(std::span<const Vec2> gradient, double lambda, double mu, ElementMatrix& K,
                   const std::optional<Eigen::Matrix3d>& layers) {
    for (std::size_t i = 0; i < gradient.size(); ++i)
        for (std::size_t j = 0; j < gradient.size(); ++j) {
            const Vec2 &g = gradient[i], &e = gradient[j];
            K.block<2, 2>(2 * i, 2 * j) +=
                lambda * g * e.transpose() + mu * (e * g.transpose() + g.dot(e) * Eigen::Matrix2d::Identity());
            if (layers)
                K.block<2, 2>(2 * i, 2 * j) += strain_of_gradient(g).transpose() * *layers * strain_of_gradient(e);
        }
}

/// For the mass 1, M_ij = (own delta_ij + shared)/3.
ElementMatrix linear_mass(double own, double shared) {
    return own / 3 * ElementMatrix::Identity(3, 3) + ElementMatrix::Constant(3, 3, shared / 3);
}

ElementMatrix lumped_quadratic_mass() {
    ElementMatrix M = ElementMatrix::Zero(7, 7);
    for (Index k = 0; k < 7; ++k) M(k, k) = corner_share(2, k, 1);
    return M;
}

/// N = T P from the six quadratic functions and the bubble b, whose integrals P P', P b, b b over the unit mass are
/// known.
ElementMatrix consistent_quadratic_mass() {
    ElementMatrix P = ElementMatrix::Zero(7, 7), T = ElementMatrix::Identity(7, 7);
    for (Index i = 0; i < 3; ++i) {
        for (Index j = 0; j < 3; ++j) {
            P(i, j) = (i == j ? 6 : -1) / 180.;
            P(3 + i, 3 + j) = (i == j ? 32 : 16) / 180.;
        }
        P(i, opposite_middle(i)) = P(opposite_middle(i), i) = -4 / 180.;
        P(i, 6) = P(6, i) = -3 / 140.;
        P(3 + i, 6) = P(6, 3 + i) = 6 / 35.;
        T(i, 6) = bubble_weight[i];
        T(3 + i, 6) = bubble_weight[3 + i];
    }
    P(6, 6) = 81 / 280.;
    return T * P * T.transpose();
}

/// At the centre all other shape functions are zero.
ElementMatrix one_point_quadratic_mass() {
    ElementMatrix M = ElementMatrix::Zero(7, 7);
    M(6, 6) = 1;
    return M;
}

/// [1/s^2] Order 1: K = V B' D B, M = (m/3) I, V/m = 1/rho: the non-zero eigenvalues of M^-1 K are those of
/// (3/rho) L' B B' L with D = L L'.
double largest_eigenvalue_linear(const Mesh& mesh, Index t, const Elastic& material, const Eigen::Matrix3d& L) {
    Eigen::Matrix<double, 3, 6> B;
    const auto gradients = shape_gradients(mesh, t);
    for (int k = 0; k < 3; ++k) B.middleCols<2>(2 * k) = strain_of_gradient(gradients[k]);
    const Eigen::Matrix<double, 3, 6> LB = L.transpose() * B;
    const Eigen::Matrix3d A = 3 / material.density * LB * LB.transpose();
    return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(A, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff();
}

std::optional<Eigen::Matrix3d> times(double factor, std::optional<Eigen::Matrix3d> matrix) {
    if (matrix) *matrix *= factor;
    return matrix;
}

/// [Pa] Lame constants.
struct Further {
    double lambda = 0, mu = 0;
};

/// Stiffness of a triangle of order 2, with further Lame constants for its linear stresses.
ElementMatrix quadratic_stiffness(const Mesh& mesh, Index t, const Elastic& material, PlaneModel plane, double volume,
                                  const Further& further) {
    const double lambda = material.first_lame(plane), mu = material.shear_modulus();
    const auto g = shape_gradients(mesh, t);
    const std::optional<Eigen::Matrix3d> layers = material.stiffness_of_layers(plane),
                                         of_place = times(volume / 3, layers);
    ElementMatrix K = ElementMatrix::Zero(14, 14);
    for (Index k = 0; k < 3; ++k)
        add_stiffness(middle_gradients(g, k), volume / 3 * (lambda + further.lambda), volume / 3 * (mu + further.mu), K,
                      of_place);
    const Eigen::Matrix2d R = bubble_stiffness(g, volume, lambda, mu, layers);
    for (Index i = 0; i < 7; ++i)
        for (Index j = 0; j < 7; ++j) K.block<2, 2>(2 * i, 2 * j) += bubble_weight[i] * bubble_weight[j] * R;
    return K;
}

double largest_eigenvalue_quadratic(const Mesh& mesh, Index t, const Elastic& material, PlaneModel plane,
                                    const Further& further = {}) {
    ElementMatrix A = quadratic_stiffness(mesh, t, material, plane, mesh.area(t), further);
    const double mass = material.density * mesh.area(t);
    for (Index i = 0; i < A.rows(); ++i)
        for (Index j = 0; j < A.cols(); ++j)
            A(i, j) /= std::sqrt(corner_share(2, i / 2, mass) * corner_share(2, j / 2, mass));
    return Eigen::SelfAdjointEigenSolver<ElementMatrix>(A, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff();
}

/// [s] The largest ratio of a viscous stress s I + q over the elastic one of the same strain.
double largest_ratio(const Elastic& material, PlaneModel plane, double bulk, double shear) {
    const double mu = material.shear_modulus();
    if (!material.bedding) return std::max(bulk / (material.first_lame(plane) + mu), shear / mu);
    Eigen::Matrix3d viscous = shear * Eigen::Vector3d(2, 2, 1).asDiagonal().toDenseMatrix();
    viscous.topLeftCorner<2, 2>().array() += bulk - shear;
    return Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix3d>(viscous, material.stiffness(plane),
                                                                     Eigen::EigenvaluesOnly)
        .eigenvalues()[2];
}

/// [s] With viscous forces C v at the velocity before, central differences are stable while M - h/2 C - h^2/4 K is
/// positive: for h = 2/omega of the stiffness K + 2/h C. The stress s I + q is (bulk - shear) d I + 2 shear sym grad v,
/// which adds 2/h (bulk - shear) to lambda and 2/h shear to mu. As C is at most
/// largest_ratio() K, h/`undamped` = sqrt(1 + xi^2) - xi with xi of that factor over `undamped` is below the fixed
/// point, and so are the iterates from there on.
double viscous_step(const Mesh& mesh, Index t, const Elastic& material, PlaneModel plane, double undamped,
                    double mass_factor) {
    const auto [bulk, shear] = largest_viscosities(material, plane, viscous_length(mesh, t));
    const double xi = largest_ratio(material, plane, bulk, shear) / undamped;
    double h = undamped * (std::sqrt(1 + xi * xi) - xi);
    for (int i = 0; i < 4; ++i) {
        const Further further{.lambda = 2 * (bulk - shear) / h, .mu = 2 * shear / h};
        if (mesh.order == 2) {
            h = 2 / std::sqrt(largest_eigenvalue_quadratic(mesh, t, material, plane, further) / mass_factor);
        } else {
            Eigen::Matrix3d D = material.stiffness(plane);
            D.topLeftCorner<2, 2>().array() += further.lambda;
            D.diagonal() += further.mu * Eigen::Vector3d(2, 2, 1);
            h = 2 / std::sqrt(largest_eigenvalue_linear(mesh, t, material, D.llt().matrixL()) / mass_factor);
        }
    }
    return h;
}

}  // namespace

ElementMatrix stiffness_matrix(const Mesh& mesh, Index t, const Elastic& material, PlaneModel plane, double thickness) {
    const double volume = mesh.area(t) * thickness;
    if (mesh.order == 2) return quadratic_stiffness(mesh, t, material, plane, volume, {});
    ElementMatrix K = ElementMatrix::Zero(6, 6);
    add_stiffness(shape_gradients(mesh, t), volume * material.first_lame(plane), volume * material.shear_modulus(), K,
                  times(volume, material.stiffness_of_layers(plane)));
    return K;
}

double corner_share(Index order, Index k, double of_triangle) {
    if (order == 1) return of_triangle / 3;
    return k < 3 ? of_triangle / 20 : k < 6 ? 2 * of_triangle / 15 : 9 * of_triangle / 20;
}

const ElementMatrix& mass_matrix(Index order, MassMatrix mass) {
    static const std::array<ElementMatrix, 3> linear{linear_mass(1, 0), linear_mass(0.25, 0.25),
                                                     linear_mass(0, 1. / 3)};
    static const std::array<ElementMatrix, 3> quadratic{lumped_quadratic_mass(), consistent_quadratic_mass(),
                                                        one_point_quadratic_mass()};
    return (order == 1 ? linear : quadratic)[static_cast<std::size_t>(mass)];
}

StableStep::StableStep(const std::vector<Elastic>& materials, PlaneModel plane) : materials_(materials), plane_(plane) {
    for (const Elastic& material : materials) factor_.push_back(material.stiffness(plane).llt().matrixL());
}

double StableStep::operator()(const Mesh& mesh, Index triangle, double mass_factor) const {
    const Elastic elastic = elastic_of(mesh, materials_, triangle);
    const auto factor = [&]() -> Eigen::Matrix3d {
        if (mesh.layer_angle.empty()) return factor_[mesh.region[triangle]];
        return elastic.stiffness(plane_).llt().matrixL();
    };
    const double eigenvalue = mesh.order == 1 ? largest_eigenvalue_linear(mesh, triangle, elastic, factor())
                                              : largest_eigenvalue_quadratic(mesh, triangle, elastic, plane_),
                 step = 2 / std::sqrt(eigenvalue / mass_factor);
    return elastic.has_viscosity() ? viscous_step(mesh, triangle, elastic, plane_, step, mass_factor) : step;
}

std::vector<double> stable_steps(const Mesh& mesh, const std::vector<Elastic>& materials, PlaneModel plane,
                                 std::span<const double> mass_factors) {
    const StableStep stable_step(materials, plane);
    std::vector<double> steps;
    for (Index t = 0; t < mesh.n_triangles(); ++t)
        steps.push_back(stable_step(mesh, t, mass_factors.empty() ? 1 : mass_factors[t]));
    return steps;
}

}  // namespace knap
