#pragma once
// Stress intensity factors and J at the tip of a pre-crack that stands, by integrals over a domain round it. With q
// falling from 1 round the tip to 0 at the radius, and x along the crack (B. Moran and C. F. Shih, Eng. Fract. Mech. 27
// (1987); T. Nakamura, C. F. Shih, L. B. Freund, Int. J. Fract. 27 (1985)):
//
//     J = int [sigma_ij u_i,x q_,j - (W + T) q_,x + rho (a_i u_i,x - v_i v_i,x) q]     W, T: elastic, kinetic energy
//     K = E'/2 int [(sigma_ij w_i,x + tau_ij u_i,x) q_,j - sigma_ij w_i,j q_,x + rho a_i w_i,x q]
//
// with Williams' static field (w, tau) of K_I = 1, then of K_II = 1. All domains give the same.
#include "model/state.hpp"

#include <algorithm>

namespace knap {

struct TipFactors {
    double K_I, K_II;  // [Pa m^1/2]
    double J;          // [J/m2]
};

class TipIntegral {
public:
    /// At the tip nearest to `at`. Throws SimulationError, which names `probe`, where there is none within the radius
    /// [m], or where the domain is not that of one straight crack without loads in one material.
    TipIntegral(const Model& model, const Vec2& at, double radius, const std::string& probe);

    /// At the start and at the end of every step: accelerations are differences of velocities.
    void after_step(const State& state);
    /// NaN where an interface in the domain is damaged, so that the tip does not stand any more, and while
    /// accelerations are not known.
    TipFactors factors(const State& state) const;
    bool has_vanished() const;

private:
    void place_tip(const Vec2& at, const std::string& probe);
    void check_domain(const std::string& probe) const;
    bool stands(const State& state) const;
    Vec2 local(const Vec2& global) const { return {along_.dot(global), turned_left(along_).dot(global)}; }
    double distance(Index vertex) const { return (model_.mesh.vertices[vertex] - tip_).norm(); }
    double q(Index vertex) const { return std::clamp(2 * (1 - distance(vertex) / radius_), 0.0, 1.0); }

    const Model& model_;
    double radius_;                              // [m]
    Vec2 tip_, along_;                           // [m] and the direction in which the crack would go on
    std::vector<Index> triangles_;               // of the domain
    std::vector<Index> points_;                  // of the interfaces between them that are no cracks
    std::vector<Vec2> velocity_, acceleration_;  // per corner of the domain
    double last_step_ = 0;                       // [s] of those velocities
    bool known_ = false;                         // the accelerations: from the start, or from the second step on
};

}  // namespace knap
