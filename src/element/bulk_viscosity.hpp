#pragma once
// Artificial viscosity of the explicit bulk. A mean stress s resists changes of area and damps the shortest waves,
// which a mesh disperses behind a steep front; a deviator q resists changes of shape and damps the flutter of bodies
// whose faces rub, much of which is shear:
//
//     s = rho h (b1 c_d + b2^2 h max(0, -d)) d,    d = div v,    h = sqrt(2 A) (order 2: half of it)
//     q = 2 rho h b3 c_d dev sym grad v
//
// h is the edge of a square cell of two such triangles, c_d the dilatational speed. The linear term acts in both
// directions (Landshoff 1955, from memory), the quadratic one in compression (von Neumann and Richtmyer, J. Appl. Phys.
// 21 (1950) 232). Form and usual values b1 = 0.06, b2 = 1.2 are those of Abaqus (Getting Started, Bulk viscosity);
// M. L. Wilkins, J. Comput. Phys. 36 (1980) 281, and LS-DYNA have Q2 = b1, Q1 = b2^2 (from memory). The factor h |d| of
// the quadratic term grows up to 0.02 c_d, a compression by 2 % while a wave passes the triangle, so that the stable
// step holds at any speed. Neither s nor q is a stress of the material: neither stresses of the output nor probes have
// them. Interfaces transmit them, so the stress criterion knows them.
//
// Velocities are those of the middle of the last step, so the forces f = -V (s I + q) grad l belong to the leapfrog as
// follows, with Delta = h v of a step:
//
//     E_n+1/2  = 1/2 v' M v + 1/2 u_n' K u_n+1 - 1/2 f_n . Delta_n+1/2
//     work     = 1/2 (f_n-1 + f_n) . Delta_n-1/2
//
// of which each evaluation knows all but f_n . Delta_n+1/2, and NodeMotion has that in the sum of all forces. The last
// term of E, of first order in h, is energy that the next evaluation will have dissipated.
//
// Large rotations: d is the relative change of area over the last step, from F in its middle, so that a rigid spin has
// none; P = s cof F + F q with q from the rate of Green's strain, sym(F' dF/dt).
#include "base/vec.hpp"
#include "material/elastic.hpp"
#include "mesh/mesh.hpp"

#include <cmath>
#include <vector>

namespace knap {

struct ViscousCoefficients {
    std::vector<double> linear, quadratic;  // [Pa s] rho h b1 c_d, [Pa s2] rho h^2 b2^2
    std::vector<double> shear;              // [Pa s] rho h b3 c_d
    std::vector<double> largest_rate;       // [1/s] of -d in the quadratic term
};

/// Per triangle; empty: no material has a viscosity.
ViscousCoefficients viscous_coefficients(const Mesh& mesh, const std::vector<Elastic>& materials, PlaneModel plane);
/// [m] h of a triangle.
inline double viscous_length(const Mesh& mesh, Index t) { return std::sqrt(2 * mesh.area(t)) / mesh.order; }

/// [Pa s] Of s = bulk d and q = 2 shear dev sym grad v.
struct Viscosities {
    double bulk, shear;
};
/// The largest ones of a triangle.
Viscosities largest_viscosities(const Elastic& material, PlaneModel plane, double h);

/// [Pa] s, q_xx = -q_yy and q_xy.
constexpr Index viscous_components = 3;

/// What an evaluation of the forces needs and finds.
struct ViscousStep {
    const std::vector<Vec2>& velocity;  // [m/s] of nodes, in the middle of the last step
    double last_step;                   // [s]
    const double* before;               // [Pa] stresses of the last step: one set a triangle, order 2 three
    double* now;                        // [Pa] those of this one
    double work = 0;                    // [J] of the last step
    double unmoved = 0;                 // [J] sum of f . u with small strains; else zero
};

}  // namespace knap
