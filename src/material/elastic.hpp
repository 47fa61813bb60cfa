#pragma once
// Linear isotropic elasticity in the plane.
#include <Eigen/Core>

#include <array>

namespace knap {

enum class PlaneModel { strain, stress };

struct Elastic {
    double density = 0;                      // [kg/m3]
    double E = 0;                            // [Pa] Young's modulus
    double nu = 0;                           // [-]  Poisson's ratio
    std::array<double, 2> bulk_viscosity{};  // [-] b1, b2 (element/bulk_viscosity.hpp)
    double shear_viscosity = 0;              // [-] b3, likewise

    double shear_modulus() const { return E / (2 * (1 + nu)); }  // [Pa]
    double first_lame(PlaneModel model) const;                   // [Pa] lambda of the plane law
    double plane_modulus(PlaneModel model) const;       // [Pa] E' = E/(1-nu^2) in plane strain, E in plane stress
    double dilatational_speed(PlaneModel model) const;  // [m/s] c_d
    double shear_speed() const;                         // [m/s] c_s
    double rayleigh_speed(PlaneModel model) const;      // [m/s] c_R, root of the Rayleigh function

    bool has_viscosity() const { return bulk_viscosity[0] > 0 || bulk_viscosity[1] > 0 || shear_viscosity > 0; }

    /// Stress (xx, yy, xy) = D * strain (xx, yy, 2 xy).  [Pa]
    Eigen::Matrix3d stiffness(PlaneModel model) const;
};

}  // namespace knap
