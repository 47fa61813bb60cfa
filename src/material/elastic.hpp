#pragma once
// Linear elasticity in the plane: isotropic, or transversely isotropic in layers whose trace lies in the plane (S. G.
// Lekhnitskii, Theory of Elasticity of an Anisotropic Body, 1963; B. Amadei, IJRMMS 33, 1996, 293). With x along the
// layers, y across them and z along their strike, the compliance is
//
//     eps_x = s_x/E - nu' s_y/E' - nu s_z/E      eps_y = s_y/E' - nu' (s_x + s_z)/E'      2 eps_xy = s_xy/G'
//     eps_z = s_z/E - nu s_x/E - nu' s_y/E'
#include "base/vec.hpp"

#include <array>
#include <optional>

namespace knap {

enum class PlaneModel { strain, stress };

/// Strain (xx, yy, 2 xy) of the gradient of a displacement, or of a strain as a symmetric matrix.
inline Eigen::Vector3d strain_of(const Eigen::Matrix2d& H) { return {H(0, 0), H(1, 1), H(0, 1) + H(1, 0)}; }
/// The same of a displacement with the gradient a (x) g: B a.
inline Eigen::Matrix<double, 3, 2> strain_of_gradient(const Vec2& g) {
    return (Eigen::Matrix<double, 3, 2>() << g.x(), 0, 0, g.y(), g.y(), g.x()).finished();
}
/// The symmetric matrix of a stress (xx, yy, xy).
inline Eigen::Matrix2d stress_matrix(const Eigen::Vector3d& s) {
    return (Eigen::Matrix2d() << s[0], s[2], s[2], s[1]).finished();
}

/// Layers of a transversely isotropic material: constants across them. E and nu of Elastic hold along them.
struct Bedding {
    double E = 0;      // [Pa] E' under a stress across the layers
    double nu = 0;     // [-] nu': contraction along the layers over the extension across them, under such a stress
    double G = 0;      // [Pa] G' of shear along the layers
    double angle = 0;  // [rad] of the layers to the x axis
};

struct Elastic {
    double density = 0;                      // [kg/m3]
    double E = 0;                            // [Pa] Young's modulus
    double nu = 0;                           // [-]  Poisson's ratio
    std::array<double, 2> bulk_viscosity{};  // [-] b1, b2 (element/bulk_viscosity.hpp)
    double shear_viscosity = 0;              // [-] b3, likewise
    std::optional<Bedding> bedding{};        // none: isotropic

    // of the isotropic material with this E and nu
    double shear_modulus() const { return E / (2 * (1 + nu)); }  // [Pa]
    double first_lame(PlaneModel model) const;                   // [Pa] lambda of the plane law

    /// [Pa] E' = E/(1-nu^2) in plane strain, E in plane stress; of layers the smaller one of those along and across.
    double plane_modulus(PlaneModel model) const;
    // of layers: the fastest and the slowest plane wave of all directions, and the surface wave along the layers
    double dilatational_speed(PlaneModel model) const;  // [m/s] c_d
    double shear_speed(PlaneModel model) const;         // [m/s] c_s
    double rayleigh_speed(PlaneModel model) const;      // [m/s] c_R

    /// [m/s] sqrt(C/density), C_ik = D_ijkl n_j n_l: its eigenvalues are the speeds of the plane waves along the unit
    /// vector n, and a plane wave leaves through a boundary with this normal under the traction -density sqrt(..) v.
    Eigen::Matrix2d wave_matrix(PlaneModel model, const Vec2& direction) const;

    bool has_viscosity() const { return bulk_viscosity[0] > 0 || bulk_viscosity[1] > 0 || shear_viscosity > 0; }

    /// Stress (xx, yy, xy) = D * strain (xx, yy, 2 xy).  [Pa]
    Eigen::Matrix3d stiffness(PlaneModel model) const;
    /// [Pa] D less that of the isotropic material with this E and nu; none without layers.
    std::optional<Eigen::Matrix3d> stiffness_of_layers(PlaneModel model) const;
    /// [Pa] s_zz of a stress in the plane (xx, yy, xy) by Poisson's effect, in plane strain.
    double stress_along_strike(const Eigen::Vector3d& stress) const;
    /// Strain in the plane of a free expansion that is the same in all directions, over that of the isotropic material
    /// with this nu: I without layers, and in plane stress. In plane strain the third direction is held.
    Eigen::Matrix2d expansion_in_plane(PlaneModel model) const;
    /// [Pa] D applied to it: 2 (lambda + mu) I without layers.
    Eigen::Matrix2d stress_of_expansion(PlaneModel model) const;
};

}  // namespace knap
