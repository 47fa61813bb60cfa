#pragma once
// The extrinsic cohesive law with contact, Coulomb friction and impact (Acary, Collins-Craft, Bourrier).
//     Psi(u_N, u_T, beta) = beta sigma_c s + w f(beta),     w = G_c
//     s = u_N + gamma |u_T|   or (coupling norm)   s = sqrt(u_N^2 + gamma^2 u_T^2)
//     on first loading  beta = B(s sigma_c/w),   and beta never grows
// Unloading keeps beta and the traction beta sigma_c, or (secant) the traction falls with the opening, or (vertical:
// C. Talon, A. Curnier, Eur. J. Mech. A 22, 2003, 545) it falls to zero at once. With the largest s so far, kappa:
//     secant      sigma = beta sigma_c min(1, s/kappa)
//     vertical    sigma = 0 for s < kappa, in [0, beta sigma_c] at s = kappa: nothing is given back
// Linear softening: f = (1 - beta)^2, beta = 1 - s/delta_c, delta_c = 2 w/sigma_c. Other shapes: softening_shape.hpp.
//
// Slip may cost another fracture energy, G_II: cohesion then falls with another measure of the opening than s,
//     beta = B(s_d sigma_c/G_c),    s_d = s G_c/G(m),    m = slip_part, the part of slip in the work of the traction,
// with the traction as before. A point that opens in one proportion costs int beta sigma_c ds = G(m): what exceeds
// G_c f(beta) is dissipated while beta falls, at the rate (G(m)/G_c - 1) G_c df. With
//     power                G^-a = ((1 - m)/G_c)^a + (m/G_II)^a
//     benzeggagh-kenane    G = G_c + (G_II - G_c) m^a
// Power with a = 1 has s_d = u_N + gamma G_c/G_II |u_T|, and G_I/G_c + G_II/G_II = 1 holds on every way.
//
// Friction may fall with the slip: mu = friction + (kinetic_friction - friction) min(1, D/slip_distance), D: the way
// that the sides have slid so far. Or the threshold f(p) of a table over the pressure (friction_over_pressure.hpp)
// takes the place of mu p; with the sum p = r_N + beta sigma_c, as Coulomb's, so that a point at rest bears
//     |r_T| <= gamma beta sigma_c + f(r_N + beta sigma_c)         norm: gamma beta sigma_c + f(r_N)
// Damage takes the cohesion, and of f the part that its pressure had; f(r_N) stays.
//
// Strength may follow the temperature: phi(T) multiplies sigma_c and w alike, so that delta_c stays and beta means the
// same opening at every T; beta never grows, so what has opened does not heal when it freezes again.
// Delayed softening (O. Allix, J.-F. Deue, Eng. Trans. 45, 1997, 29): beta follows B in the relaxation time tau, with B
// continued below 0 by its last piece, so that a point that opens breaks in finite time. A step of size h takes
//     d beta/dt = -<beta - B>/tau        beta+ = beta - <beta - B(s+)>/(1 + tau/h)
// The strength stays, the energy of a break grows with the speed of opening: w + int sigma_c (s(beta) - s) d beta.
#include "base/vec.hpp"
#include "material/friction_over_pressure.hpp"
#include "material/softening_shape.hpp"
#include "material/thermal.hpp"

#include <algorithm>
#include <numbers>

namespace knap {

/// What the traction of a damaged point does at openings below its largest one.
enum class Unloading { constant, secant, vertical };

constexpr const char* name_of(Unloading unloading) {
    return unloading == Unloading::secant ? "secant" : unloading == Unloading::vertical ? "vertical" : "constant";
}

/// How opening and slip make the equivalent opening s: their sum, or their norm.
enum class Coupling { sum, norm };

/// How the fracture energy follows the part of slip in the work.
enum class ModeMix { power, benzeggagh_kenane };

/// phi(T) in (0, 1] [-] on sigma_c and G_c, and Coulomb's mu(T) [-]; either may be empty.
struct StrengthOfTemperature {
    TemperatureTable strength, friction;
};

struct CohesiveLaw {
    double sigma_c = 0;      // [Pa]   tensile strength; 0 = no cohesion (contact and friction only)
    double G_c = 0;          // [J/m2] fracture energy
    double gamma = 1;        // [-]    mode II over mode I traction
    double friction = 0;     // [-]    Coulomb coefficient mu; of friction over pressure f(sigma_c)/sigma_c
    double restitution = 0;  // [-]    Newton's e
    std::shared_ptr<const SofteningShape> softening = nullptr;  // null: linear; shared by laws that differ in strength

    double G_II = 0;                    // [J/m2] fracture energy of slip alone; 0: G_c
    ModeMix mode_mix = ModeMix::power;  // between the two
    double mix_exponent = 1;            // [-] a
    double kinetic_friction = 0;        // [-] mu after the slip distance
    double slip_distance = 0;           // [m] 0: mu is constant
    std::shared_ptr<const FrictionOverPressure> over_pressure = nullptr;  // null: mu p

    Coupling coupling = Coupling::sum;
    Unloading unloading = Unloading::constant;
    double relaxation_time = 0;  // [s] tau of delayed softening; 0: the cohesion follows the opening at once
    double incubation_time = 0;  // [s] that an overload needs to break a bond (explicit/incubation.hpp); 0: none
    std::shared_ptr<const StrengthOfTemperature> of_temperature = nullptr;  // null: the same at all; shared likewise

    /// The law at a temperature.
    CohesiveLaw at(double T) const;
    /// [-] Smallest phi, and smallest and largest mu, of all temperatures.
    double smallest_phi() const;
    std::array<double, 2> friction_range() const;
    /// visit(line) for the lines whose minimum friction is: mu p alone, or those of the table.
    template <class Visit>
    void visit_friction_lines(double mu, const Visit& visit) const {
        if (!over_pressure) return visit(FrictionLine{mu, 0});
        for (const FrictionLine& line : over_pressure->lines()) visit(line);
    }
    template <class Visit>
    void visit_friction_lines(const Visit& visit) const {
        visit_friction_lines(friction, visit);
    }
    /// Of a point, whose impulses are pressures times `unit` [N s/Pa].
    PressedFriction pressed_friction(double unit) const { return {over_pressure.get(), unit}; }
    /// [Pa] sigma_1 at which a facet in the worst direction yields under the confinement sigma_3, compression positive,
    /// without damage; and the line on which it lies then.
    struct Strength {
        double stress = infinity;
        FrictionLine line;
    };
    Strength compressive_strength(double confinement = 0) const;

    /// An interface that cannot break; it costs nothing.
    static CohesiveLaw unbreakable() { return {.sigma_c = infinity}; }
    bool breakable() const { return sigma_c < infinity; }

    /// [-] Shear strength without pressure, over sigma_c. Friction acts on cohesion with the sum alone.
    double shear_strength() const { return shear_strength(friction); }
    double shear_strength(double mu) const { return coupling == Coupling::norm ? gamma : gamma + mu; }
    /// [m] Opening at which the cohesion is lost; 2 G_c/sigma_c of linear softening.
    double delta_c() const {
        if (sigma_c <= 0) return 0;
        return softening ? softening->final_opening() * G_c / sigma_c : 2 * G_c / sigma_c;
    }
    /// [m] Smallest -ds/d beta of all cohesions below `cohesion`: of the steepest part of the softening branch.
    double softening_length(double cohesion = 1) const {
        return softening ? G_c / (sigma_c * softening->steepest(cohesion)) : delta_c();
    }
    /// [-] Steepest slope of the softening over that of linear softening.
    double steepness() const { return softening ? 2 * softening->steepest() : 1; }
    /// [m] E' G_c/sigma_c^2; 9 pi/32 of it is the process zone of a crack at rest (J. R. Rice 1968), of which the
    /// traction falls fastest in the steep zone.
    double cohesive_length(double plane_modulus) const { return plane_modulus * G_c / (sigma_c * sigma_c); }
    double process_zone(double plane_modulus) const {
        return 9 * std::numbers::pi / 32 * cohesive_length(plane_modulus);
    }
    double steep_zone(double plane_modulus) const { return process_zone(plane_modulus) / steepness(); }
    /// The piece of the softening branch at the equivalent opening s [m], and its -ds/d beta [m].
    int piece_at(double s) const { return softening ? softening->piece_at(s * sigma_c / G_c) : 0; }
    double piece_length(int piece) const { return softening ? G_c / (sigma_c * softening->slope(piece)) : delta_c(); }
    /// [-] Half the opening, in units of G_c/sigma_c, over which the cohesion falls; linear softening: before - after.
    double opening_of_fall(double before, double after) const {
        return softening ? 0.5 * (softening->opening(after) - softening->opening(before)) : before - after;
    }
    /// [m] kappa of a point that bears less below its largest opening, which is `largest` so far; else 0.
    double ramp(double cohesion, double largest) const {
        return unloading == Unloading::constant || cohesion <= 0 ? 0 : largest;
    }
    /// [m] The largest opening after a step that reaches the equivalent opening s; an opening by rounding is none.
    double largest_opening(double before, double s) const {
        return unloading == Unloading::constant || s <= 1e-12 * delta_c() ? before : std::max(before, s);
    }
    /// [-] Newton's e in a step that begins with this cohesion. Restitution is for faces that meet: cohesion would pull
    /// a damaged point that is thrown back into the other side by the whole of its approach.
    double restitution_at(double cohesion) const { return cohesion > 0 ? 0 : restitution; }
    /// Equivalent opening s [m]; penetration does not count.
    double equivalent_opening(double u_N, double u_T) const;
    /// [-] Part of the slip in it: gamma |u_T|/s, of the norm its square. 0: opened, 1: slid.
    double slip_part(double u_N, double u_T) const;
    bool has_mode_mix() const { return G_II > 0; }
    /// [-] G(m)/G_c.
    double energy_factor(double u_N, double u_T) const;
    /// [m] s_d, which decides on the cohesion.
    double damage_opening(double u_N, double u_T) const;
    /// [-] Its derivative by (u_N, |u_T|) with the sum, where the slip is not zero.
    Vec2 damage_slope(double u_N, double u_T) const;
    /// [-] Coulomb's mu after the slip D [m].
    double friction_after(double slid) const {
        if (slip_distance == 0) return friction;
        return friction + (kinetic_friction - friction) * std::min(1.0, slid / slip_distance);
    }
    bool friction_changes() const { return slip_distance > 0 || over_pressure; }
    /// [-] After the slip D [m] under a pressure [Pa]: of friction over pressure the chord.
    double friction_at(double slid, double pressure) const {
        return over_pressure ? over_pressure->chord(pressure) : friction_after(slid);
    }
    /// [-] Part of the way to B that the cohesion goes in a step of h [s].
    double relaxed_part(double h) const { return 1 / (1 + relaxation_time / h); }
    /// Cohesion at the end of a step of h [s] that began with `cohesion` and ends at opening (u_N, u_T).
    double next_cohesion(double cohesion, double u_N, double u_T, double h = infinity) const;
    /// [J/m2] Delayed softening: what a fall of the cohesion at the equivalent opening s dissipates beyond G_c f(beta),
    /// int sigma_c (s - s(beta)) d beta.
    double viscous_dissipation(double before, double after, double s) const;
    /// [J/m2] What a fall of the cohesion dissipates beyond G_c f(beta) and `viscous`, since `factor`, G(m)/G_c, is
    /// not 1.
    double mixed_dissipation(double before, double after, double viscous, double factor) const {
        if (!has_mode_mix() || after >= before) return 0;
        return (factor - 1) * (surface_energy(after, 0, 0) - surface_energy(before, 0, 0) + viscous);
    }
    /// Psi [J/m2] of the state, with constant unloading.
    double surface_energy(double cohesion, double u_N, double u_T) const;
    /// [J/m2] What a point that closes has lost for good: G_c f(beta), with vertical unloading beta sigma_c kappa more,
    /// with secant unloading half of that.
    double consumed(double cohesion, double kappa) const;
    /// [m] The energy that the traction beta sigma_c gives back, over it: s, on the ramp up to kappa s^2/(2 kappa).
    static double stored_opening(double kappa, double s) { return s < kappa ? 0.5 * s * s / kappa : s - 0.5 * kappa; }
    /// [J/m2] Secant unloading: beta sigma_c s^2/(2 kappa), which a point that closes gives back; linear beyond kappa.
    double elastic_energy(double cohesion, double kappa, double s) const;
    /// [J/m2] What a point gives back that closes from s.
    double given_back(double cohesion, double kappa, double s) const;
};

}  // namespace knap
