#pragma once
// Figures that are drawn from histories: curves over time, force over displacement, stress over strain, fragment sizes,
// and the rose diagram of breaks.
#include "figures/chart.hpp"
#include "output/history_csv.hpp"

namespace knap {

/// The energy balance; terms that are too small to be seen are left out.
Chart energy_chart(const History& energy);
Chart crack_length_chart(const History& cracks);
/// [m/s] `rayleigh_speed`: 0 = not drawn.
Chart crack_speed_chart(const History& cracks, double rayleigh_speed);
/// Force over displacement of the loads that move (of all if none moves), in the component that moves most; or all
/// forces over time.
Chart reaction_chart(const History& reactions, bool over_time = false);
/// Displacements, openings and slips, or velocities, except those that are too small to be seen.
Chart probe_chart(const History& probes, bool over_temperature = false, bool celsius = false);
Chart probe_velocity_chart(const History& probes);
Chart probe_stress_chart(const History& probes);
/// K_I and K_II of tips over time.
Chart tip_chart(const History& probes);
/// Of fluids in cracks; the volumes with those that have entered.
Chart fluid_pressure_chart(const History& fluids);
Chart fluid_volume_chart(const History& fluids);
Chart fluid_length_chart(const History& fluids);
/// Stress over all measured strains, with the stresses of crack initiation, dilatancy and crack damage.
Chart stress_strain_chart(const History& stress_strain);
/// Cumulative number of breaks in tension and in shear between two times [s].
Chart break_chart(const History& breaks, double start, double end);
/// Mass fraction in fragments up to a diameter.
Chart fragment_size_chart(const History& fragments);

/// Rose diagram of the directions of broken interfaces, weighted by length: the area of a petal is the broken length
/// within its 10 degrees, tension inside, shear outside. Directions have no sense, so every petal is drawn twice.
DrawnFigure draw_rose(const History& breaks, const std::string& title, const std::filesystem::path& file, int pixels,
                      const Page& page = {});

inline constexpr int n_petals = 18;

/// [m] Broken length.
struct Petal {
    double tensile = 0, shear = 0;
    double length() const { return tensile + shear; }
};
/// By direction, from 0 degrees on.
std::vector<Petal> petals(const History& breaks);

}  // namespace knap
