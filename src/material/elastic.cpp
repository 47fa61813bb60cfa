#include "material/elastic.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr int n_directions = 90;  // of plane waves, over a right angle

/// The root in (low, high) of a function that grows from negative values.
template <class F>
double bisected(double low, double high, const F& f) {
    for (int i = 0; i < 200; ++i) {
        const double x = 0.5 * (low + high);
        (f(x) < 0 ? low : high) = x;
    }
    return 0.5 * (low + high);
}

/// Stresses (xx, yy, xy) of the layers in the frame of x and y: T s, and T' takes strains (xx, yy, 2 xy) back.
Eigen::Matrix3d turned_stress(double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    return (Eigen::Matrix3d() << c * c, s * s, -2 * c * s, s * s, c * c, 2 * c * s, c * s, -c * s, c * c - s * s)
        .finished();
}

/// [Pa] D in the frame of the layers.
Eigen::Matrix3d stiffness_along(const Elastic& material, PlaneModel model) {
    const Bedding& across = *material.bedding;
    const double coupled = -across.nu / across.E;
    Eigen::Matrix3d compliance = Eigen::Matrix3d::Zero();
    compliance.topLeftCorner<2, 2>() << 1 / material.E, coupled, coupled, 1 / across.E;
    compliance(2, 2) = 1 / across.G;
    if (model == PlaneModel::strain) {  // s_z = nu s_x + nu' E/E' s_y
        const Vec2 strike(-material.nu / material.E, coupled);
        compliance.topLeftCorner<2, 2>() -= material.E * strike * strike.transpose();
    }
    return compliance.inverse();
}

/// [m/s] The slowest and the fastest plane wave of all directions in layers: roots of the eigenvalues of
///     (D11 c^2 + D33 s^2, (D12 + D33) c s; ., D33 c^2 + D22 s^2)/density,   c, s: cosine and sine to the layers
std::array<double, 2> extreme_speeds(const Elastic& material, PlaneModel model) {
    const Eigen::Matrix3d D = stiffness_along(material, model);
    double slowest = infinity, fastest = 0;
    for (int i = 0; i <= n_directions; ++i) {
        const double angle = 0.5 * std::numbers::pi * i / n_directions, c = std::cos(angle), s = std::sin(angle),
                     along = D(0, 0) * c * c + D(2, 2) * s * s, across = D(2, 2) * c * c + D(1, 1) * s * s,
                     mean = 0.5 * (along + across),
                     radius = std::hypot(0.5 * (along - across), (D(0, 1) + D(2, 2)) * c * s);
        slowest = std::min(slowest, mean - radius), fastest = std::max(fastest, mean + radius);
    }
    return {std::sqrt(slowest / material.density), std::sqrt(fastest / material.density)};
}

}  // namespace

double Elastic::first_lame(PlaneModel model) const {
    return model == PlaneModel::strain ? E * nu / ((1 + nu) * (1 - 2 * nu)) : E * nu / (1 - nu * nu);
}

double Elastic::plane_modulus(PlaneModel model) const {
    const double along = model == PlaneModel::strain ? E / (1 - nu * nu) : E;
    if (!bedding) return along;
    const Eigen::Matrix3d compliance = stiffness_along(*this, model).inverse();
    return std::min(1 / compliance(0, 0), 1 / compliance(1, 1));
}

double Elastic::dilatational_speed(PlaneModel model) const {
    if (bedding) return extreme_speeds(*this, model)[1];
    return std::sqrt((first_lame(model) + 2 * shear_modulus()) / density);
}

double Elastic::shear_speed(PlaneModel model) const {
    if (bedding) return extreme_speeds(*this, model)[0];
    return std::sqrt(shear_modulus() / density);
}

double Elastic::rayleigh_speed(PlaneModel model) const {
    if (bedding) {
        // D22 D33 X^2 (D11 - X) = (D33 - X) (D22 (D11 - X) - D12^2)^2,  X = density c^2 < D33
        // (D. Royer, E. Dieulesaint, J. Acoust. Soc. Am. 76, 1984, 1438)
        const Eigen::Matrix3d D = stiffness_along(*this, model) / bedding->G;
        const double x = bisected(0, std::min(1., D(0, 0)), [&](double x) {
            const double part = D(1, 1) * (D(0, 0) - x) - D(0, 1) * D(0, 1);
            return D(1, 1) * x * x * (D(0, 0) - x) - (1 - x) * part * part;
        });
        return std::sqrt(x * bedding->G / density);
    }
    // (2 - x)^2 = 4 sqrt(1 - x k) sqrt(1 - x),  x = (c/c_s)^2, k = (c_s/c_d)^2; one root in (0, 1)
    const double k = std::pow(shear_speed(model) / dilatational_speed(model), 2);
    return shear_speed(model) * std::sqrt(bisected(1e-3, 1 - 1e-15, [&](double x) {
               return (2 - x) * (2 - x) - 4 * std::sqrt(1 - x * k) * std::sqrt(1 - x);
           }));
}

Eigen::Matrix2d Elastic::wave_matrix(PlaneModel model, const Vec2& direction) const {
    if (!bedding) {
        const Vec2 across = turned_left(direction);
        return dilatational_speed(model) * direction * direction.transpose() +
               shear_speed(model) * across * across.transpose();
    }
    const Eigen::Matrix<double, 3, 2> B = strain_of_gradient(direction);
    const Eigen::Matrix2d C = B.transpose() * stiffness(model) * B / density;
    return Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(C).operatorSqrt();
}

Eigen::Matrix3d Elastic::stiffness(PlaneModel model) const {
    if (bedding) {
        const Eigen::Matrix3d T = turned_stress(bedding->angle);
        return T * stiffness_along(*this, model) * T.transpose();
    }
    const double l = first_lame(model), g = shear_modulus();
    return (Eigen::Matrix3d() << l + 2 * g, l, 0, l, l + 2 * g, 0, 0, 0, g).finished();
}

std::optional<Eigen::Matrix3d> Elastic::stiffness_of_layers(PlaneModel model) const {
    if (!bedding) return std::nullopt;
    Elastic isotropic = *this;
    isotropic.bedding.reset();
    return stiffness(model) - isotropic.stiffness(model);
}

double Elastic::stress_along_strike(const Eigen::Vector3d& stress) const {
    const double isotropic = nu * (stress[0] + stress[1]);
    if (!bedding) return isotropic;
    const double across = (turned_stress(-bedding->angle) * stress)[1];
    return isotropic + (bedding->nu * E / bedding->E - nu) * across;
}

Eigen::Matrix2d Elastic::expansion_in_plane(PlaneModel model) const {
    if (!bedding || model == PlaneModel::stress) return Eigen::Matrix2d::Identity();
    const Vec2 across(-std::sin(bedding->angle), std::cos(bedding->angle));
    const double ratio = (1 + bedding->nu * E / bedding->E) / (1 + nu);
    return Eigen::Matrix2d::Identity() + (ratio - 1) * across * across.transpose();
}

Eigen::Matrix2d Elastic::stress_of_expansion(PlaneModel model) const {
    if (!bedding) return 2 * (first_lame(model) + shear_modulus()) * Eigen::Matrix2d::Identity();
    return stress_matrix(stiffness(model) * strain_of(expansion_in_plane(model)));
}

}  // namespace knap
