#pragma once
// The extrinsic cohesive law with contact, Coulomb friction and impact (Acary, Collins-Craft, Bourrier).
//     Psi(u_N, u_T, beta) = beta sigma_c s + w f(beta),     s = u_N + gamma |u_T|,     w = G_c
//     on first loading  beta = B(s sigma_c/w),   and beta never grows
// Linear softening: f = (1 - beta)^2, beta = 1 - s/delta_c, delta_c = 2 w/sigma_c. Other shapes: softening_shape.hpp.
#include "material/softening_shape.hpp"

#include <limits>

namespace knap {

struct CohesiveLaw {
    double sigma_c = 0;      // [Pa]   tensile strength; 0 = no cohesion (contact and friction only)
    double G_c = 0;          // [J/m2] fracture energy
    double gamma = 1;        // [-]    mode II over mode I traction
    double friction = 0;     // [-]    Coulomb coefficient mu
    double restitution = 0;  // [-]    Newton's e
    std::shared_ptr<const SofteningShape> softening = nullptr;  // null: linear; shared by laws that differ in strength

    /// An interface that cannot break; it costs nothing.
    static CohesiveLaw unbreakable() { return {.sigma_c = std::numeric_limits<double>::infinity()}; }
    bool breakable() const { return sigma_c < std::numeric_limits<double>::infinity(); }

    /// [m] Opening at which the cohesion is lost; 2 G_c/sigma_c of linear softening.
    double delta_c() const {
        if (sigma_c <= 0) return 0;
        return softening ? softening->final_opening() * G_c / sigma_c : 2 * G_c / sigma_c;
    }
    /// [m] Smallest -ds/d beta of all cohesions below `cohesion`: of the steepest part of the softening branch.
    double softening_length(double cohesion = 1) const {
        return softening ? G_c / (sigma_c * softening->steepest(cohesion)) : delta_c();
    }
    /// The piece of the softening branch at the equivalent opening s [m], and its -ds/d beta [m].
    int piece_at(double s) const { return softening ? softening->piece_at(s * sigma_c / G_c) : 0; }
    double piece_length(int piece) const { return softening ? G_c / (sigma_c * softening->slope(piece)) : delta_c(); }
    /// [-] Half the opening, in units of G_c/sigma_c, over which the cohesion falls; linear softening: before - after.
    double opening_of_fall(double before, double after) const {
        return softening ? 0.5 * (softening->opening(after) - softening->opening(before)) : before - after;
    }
    /// [-] Newton's e in a step that begins with this cohesion. Restitution is for faces that meet: cohesion would pull
    /// a damaged point that is thrown back into the other side by the whole of its approach.
    double restitution_at(double cohesion) const { return cohesion > 0 ? 0 : restitution; }
    /// Equivalent opening s [m]; penetration does not count.
    double equivalent_opening(double u_N, double u_T) const;
    /// Cohesion at the end of a step that began with `cohesion` and ends at opening (u_N, u_T).
    double next_cohesion(double cohesion, double u_N, double u_T) const;
    /// Psi [J/m2] of the state.
    double surface_energy(double cohesion, double u_N, double u_T) const;
};

}  // namespace knap
