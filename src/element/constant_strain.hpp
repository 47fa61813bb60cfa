#pragma once
// Forces of constant-strain triangles: the kernel of the explicit bulk. It takes several triangles at once, one per
// lane of the registers, and is compiled once per instruction set (constant_strain_*.cpp), with the same bits from
// each. These files include nothing with inline functions: the linker might keep a copy of one that not every machine
// can run.
#include <cstdint>

namespace knap {

/// Which strain a triangle has, from H = grad u = sum_k u_k (x) grad l_k; F = I + H.
///     small  strain = sym H,                       sigma = D strain,         f_k = -V sigma grad l_k
///     green  E = 1/2 (H + H' + H' H),   S = D E,   P = F S,                  f_k = -V P grad l_k = -dU/du_k
/// green (St. Venant-Kirchhoff): a turned body has the turned forces, and where nothing turns it is linear elasticity
/// plus terms of second order in H. It is meant for small strains: compression softens from 42 % on. H instead of F:
/// small strains do not cancel.
enum class StrainMeasure { small, green };

/// [Pa] lambda of the plane law and 2 mu of a material.
struct LameConstants {
    double lambda, twice_shear;
};

/// [Pa] What the layers of a material add to its stiffness (xx, yy, xy) over (xx, yy, 2 xy); zero without layers.
struct LayerStiffness {
    double xx_xx, xx_yy, xx_xy, yy_yy, yy_xy, xy_xy;
};

struct ConstantStrainTriangle {
    double gradient1[2], gradient2[2];  // [1/m] of l_1 and l_2; that of l_0 is minus their sum
    double volume;                      // [m3]
    float threshold;                    // [Pa2] smallest of the three fans, rounded down
    std::int32_t kind;                  // of elastic constants
};
static_assert(sizeof(ConstantStrainTriangle) == 48);  // on large meshes the step is limited by memory bandwidth

/// What does not change during a run.
struct ConstantStrainBody {
    const ConstantStrainTriangle* triangles;
    const LameConstants* stiffness;  // per kind
    const LayerStiffness* layers;    // per kind; read by the kernels of layers
    const std::int32_t* fan_of_corner;
    const double* threshold_of_fan;  // [Pa2]
};

/// Artificial viscosity of these triangles (bulk_viscosity.hpp).
struct ViscousTriangles {
    const double *linear, *quadratic;  // per triangle: [Pa s] rho h b1 c_d, [Pa s2] rho h^2 b2^2
    const double* largest_rate;        // per triangle: [1/s] of the quadratic term
    const double* shear;               // per triangle: [Pa s] rho h b3 c_d
    const double* velocity;            // [m/s] of nodes, x and y in turns
    double last_step;                  // [s]
    const double* before;              // [Pa] s, q_xx, q_xy per triangle
    double* now;                       // [Pa] likewise
    double work, unmoved;              // [J] sums, see ViscousStep
};

/// Force [N] on the corners of the triangles from `first` to before `last`, x and y in turns, from the
/// displacement [m] of the nodes; sum_k f_k = 0. Sets fan_is_candidate [0/1] where |sigma|_F^2 exceeds the threshold
/// of a fan; with Green's strain |P|_F^2, since |f_k| <= V |P|_F |grad l_k| at any strain. Returns the energy U [J],
/// with small strains zero: there it is 1/2 u' K u. `viscous` is read and filled by a viscous kernel.
using ConstantStrainForces = double (*)(std::int32_t first, std::int32_t last, const ConstantStrainBody& body,
                                        const double* displacement, const std::int32_t* node_of_corner, double* force,
                                        std::uint8_t* fan_is_candidate, ViscousTriangles* viscous);

struct KernelKind {
    StrainMeasure measure;
    bool is_viscous, has_layers;
};
/// The kernel that takes two triangles at once, and the one that takes four, with AVX2 where the compiler has it. Same
/// bits.
ConstantStrainForces baseline_kernel(const KernelKind& kind);
ConstantStrainForces avx2_kernel(const KernelKind& kind);

}  // namespace knap
