#pragma once
// The extrinsic cohesive law with contact, Coulomb friction and impact (Acary, Collins-Craft, Bourrier).
//     Psi(u_N, u_T, beta) = beta sigma_c s + w (1 - beta)^2,     s = u_N + gamma |u_T|,     w = G_c
//     on first loading  beta = 1 - s/delta_c,   delta_c = 2 w/sigma_c,   and beta never grows
#include <limits>

namespace knap {

struct CohesiveLaw {
    double sigma_c = 0;      // [Pa]   tensile strength; 0 = no cohesion (contact and friction only)
    double G_c = 0;          // [J/m2] fracture energy
    double gamma = 1;        // [-]    mode II over mode I traction
    double friction = 0;     // [-]    Coulomb coefficient mu
    double restitution = 0;  // [-]    Newton's e

    /// An interface that cannot break; it costs nothing.
    static CohesiveLaw unbreakable() { return {.sigma_c = std::numeric_limits<double>::infinity()}; }
    bool breakable() const { return sigma_c < std::numeric_limits<double>::infinity(); }

    double delta_c() const { return sigma_c > 0 ? 2 * G_c / sigma_c : 0; }  // [m]

    /// [m] -ds/d beta on the softening branch at this cohesion.
    double softening_length(double /*cohesion*/) const { return delta_c(); }
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
