#include "material/cohesive_law.hpp"

#include <algorithm>
#include <cmath>

namespace knap {

CohesiveLaw CohesiveLaw::at(double T) const {
    CohesiveLaw law = *this;
    if (!of_temperature) return law;
    if (const TemperatureTable& phi = of_temperature->strength; !phi.empty())
        law.sigma_c *= phi(T), law.G_c *= phi(T), law.G_II *= phi(T);
    if (!of_temperature->friction.empty()) law.friction = of_temperature->friction(T);
    if (over_pressure) law.friction = over_pressure->chord(law.sigma_c);
    return law;
}

double CohesiveLaw::smallest_phi() const {
    return of_temperature && !of_temperature->strength.empty() ? std::ranges::min(of_temperature->strength.value) : 1;
}

std::array<double, 2> CohesiveLaw::friction_range() const {
    if (over_pressure) return {friction, over_pressure->line(0).slope};
    if (slip_distance > 0) return {std::min(friction, kinetic_friction), std::max(friction, kinetic_friction)};
    if (!of_temperature || of_temperature->friction.empty()) return {friction, friction};
    const auto [low, high] = std::ranges::minmax(of_temperature->friction.value);
    return {low, high};
}

/// Mohr's circle touches |r_T| = c + mu r_N at sigma_1 = K^2 sigma_3 + 2 K c, K = mu + sqrt(1 + mu^2); the lowest line
/// decides.
CohesiveLaw::Strength CohesiveLaw::compressive_strength(double confinement) const {
    Strength least;
    visit_friction_lines([&](const FrictionLine& line) {
        const double mu = line.slope, root = std::hypot(1, mu),
                     cohesion = (gamma + (coupling == Coupling::sum ? mu : 0)) * sigma_c + line.offset;
        const double stress = (root + mu) * (root + mu) * confinement + 2 * cohesion / (root - mu);
        if (stress < least.stress) least = {stress, line};
    });
    return least;
}

double CohesiveLaw::equivalent_opening(double u_N, double u_T) const {
    if (coupling == Coupling::norm) return std::hypot(std::max(u_N, 0.0), gamma * u_T);
    return std::max(u_N, 0.0) + gamma * std::abs(u_T);
}

double CohesiveLaw::slip_part(double u_N, double u_T) const {
    const double s = equivalent_opening(u_N, u_T), part = s > 0 ? gamma * std::abs(u_T) / s : 0;
    return coupling == Coupling::norm ? part * part : part;
}

double CohesiveLaw::energy_factor(double u_N, double u_T) const {
    if (!has_mode_mix()) return 1;
    const double m = slip_part(u_N, u_T), ratio = G_II / G_c;
    if (mode_mix == ModeMix::benzeggagh_kenane) return 1 + (ratio - 1) * std::pow(m, mix_exponent);
    if (mix_exponent == 1) return 1 / (1 - m + m / ratio);
    return std::pow(std::pow(1 - m, mix_exponent) + std::pow(m / ratio, mix_exponent), -1 / mix_exponent);
}

double CohesiveLaw::damage_opening(double u_N, double u_T) const {
    const double s = equivalent_opening(u_N, u_T);
    return has_mode_mix() ? s / energy_factor(u_N, u_T) : s;
}

/// s_d = s/g(m) with dm = ((1 - m) gamma d|u_T| - m du_N)/s, so ds_d = (1/g) (ds - (g'/g) s dm).
Vec2 CohesiveLaw::damage_slope(double u_N, double u_T) const {
    if (!has_mode_mix()) return {1, gamma};
    const double m = slip_part(u_N, u_T), g = energy_factor(u_N, u_T), ratio = G_II / G_c, a = mix_exponent;
    double bends = 0;  // g'/g
    if (mode_mix == ModeMix::benzeggagh_kenane) bends = (ratio - 1) * a * std::pow(m, a - 1) / g;
    else if (a == 1) bends = g * (1 - 1 / ratio);
    else bends = std::pow(g, a) * (std::pow(1 - m, a - 1) - std::pow(m / ratio, a - 1) / ratio);
    return {(1 + bends * m) / g, gamma * (1 - bends * (1 - m)) / g};
}

double CohesiveLaw::next_cohesion(double cohesion, double u_N, double u_T, double h) const {
    // 0 <= A  perp  -d beta/dt >= 0,  A = sigma_c delta_c (1 - beta) - sigma_c s + xi,  0 <= xi perp beta >= 0
    if (cohesion == 0) return 0;
    if (relaxation_time > 0) {
        const double s = damage_opening(u_N, u_T),
                     B = softening ? softening->continued_traction(s * sigma_c / G_c) : 1 - s / delta_c();
        return std::clamp(cohesion - relaxed_part(h) * (cohesion - B), 0.0, cohesion);
    }
    if (softening) return std::min(cohesion, softening->traction(damage_opening(u_N, u_T) * sigma_c / G_c));
    return std::min(cohesion, std::max(0.0, 1 - damage_opening(u_N, u_T) / delta_c()));
}

double CohesiveLaw::surface_energy(double cohesion, double u_N, double u_T) const {
    if (cohesion == 0) return G_c;
    const double recoverable = cohesion * sigma_c * equivalent_opening(u_N, u_T);
    if (softening) return recoverable + G_c * softening->dissipated(cohesion);
    return recoverable + G_c * (1 - cohesion) * (1 - cohesion);
}

double CohesiveLaw::consumed(double cohesion, double kappa) const {
    const double part = unloading == Unloading::vertical ? 1 : 0.5;
    return surface_energy(cohesion, 0, 0) + part * cohesion * sigma_c * kappa;
}

double CohesiveLaw::viscous_dissipation(double before, double after, double s) const {
    if (relaxation_time == 0 || after >= before) return 0;
    const double at_rest = surface_energy(after, 0, 0) - surface_energy(before, 0, 0);  // int sigma_c s(beta) d beta
    return std::max(0.0, sigma_c * (before - after) * s - at_rest);
}

double CohesiveLaw::elastic_energy(double cohesion, double kappa, double s) const {
    if (cohesion == 0) return 0;
    return cohesion * sigma_c * stored_opening(kappa, s);
}

double CohesiveLaw::given_back(double cohesion, double kappa, double s) const {
    switch (unloading) {
        case Unloading::secant: return elastic_energy(cohesion, kappa, s);
        case Unloading::vertical: return 0;
        case Unloading::constant: break;
    }
    return cohesion * sigma_c * s;
}

}  // namespace knap
