#pragma once
// Constant-strain triangles with Green's strain over a step of the theta scheme, as an energy-momentum method (J. C.
// Simo, N. Tarnow, ZAMP 43 (1992) 757). With H = grad u at the start, Delta = grad (u+ - u) and thermal strains e A (I
// without layers: Elastic::expansion_in_plane),
//
//     E = 1/2 (H + H' + H' H),   E+ - E = sym(F_mid' Delta),   F_mid = I + H + Delta/2
//     S_theta = D ((1 - theta) (E - e A) + theta (E+ - e+ A)),   f_k = -V F_mid S_theta grad l_k
//
// Their work is exactly the change of U = V/2 (E - e A) : D (E - e A), the work of the thermal strains, and the
// dissipation of the scheme; they have no resultant, and no moment about the places in the middle of the step. E+ - E
// is found from Delta without cancellation.
#include "element/constant_strain.hpp"
#include "element/elastic_of.hpp"

#include <span>
#include <vector>

namespace knap {

class GreenStep {
public:
    /// A triangle of order 1; all references must outlive it.
    GreenStep(const Mesh& mesh, const std::vector<Elastic>& materials, PlaneModel plane, double thickness);

    struct Motion {
        std::span<const Vec2> displacement, change;              // [m] per corner: u, u+ - u
        std::span<const double> thermal_strain, thermal_change;  // [-] per triangle: e, e+ - e; empty: no heat
        double theta = 0.5;
    };
    /// [N] On the three corners of a triangle.
    void find_forces(Index triangle, const Motion& motion, Vec2* force) const;

    struct Energies {
        double end = 0;         // [J] U at the end of the step
        double dissipated = 0;  // [J] of the scheme, >= 0
        double thermal = 0;     // [J] work of the thermal strains
        Energies& operator+=(const Energies& other) {
            end += other.end, dissipated += other.dissipated, thermal += other.thermal;
            return *this;
        }
    };
    Energies energies(Index triangle, const Motion& motion) const;

    /// (cosine, sine) of R in the polar decomposition F = R U in the middle of the step, times any length.
    Vec2 direction(Index triangle, const Motion& motion) const;

private:
    struct Gradients {
        Eigen::Matrix2d begin, change;  // H, Delta
        Eigen::Matrix2d middle() const { return Eigen::Matrix2d::Identity() + begin + 0.5 * change; }
    };
    Gradients gradients(Index triangle, const Motion& motion) const;

    /// [Pa] D applied to a symmetric strain of a triangle.
    Eigen::Matrix2d stress_of(const Eigen::Matrix2d& strain, Index triangle) const;
    /// [-] A
    const Eigen::Matrix2d& expansion(Index triangle) const { return expansion_[kind_[triangle]]; }

    const Mesh& mesh_;
    std::vector<Index> kind_;  // per triangle (elastic_of.hpp)
    // per kind
    std::vector<LameConstants> stiffness_;
    std::vector<std::optional<Eigen::Matrix3d>> layers_;
    std::vector<Eigen::Matrix2d> expansion_;  // [-] A
    double thickness_;                        // [m]
};

}  // namespace knap
