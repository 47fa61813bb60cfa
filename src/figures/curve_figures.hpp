#pragma once
// Curves: energies, crack length and speed and probes over time; force over displacement of what is driven.
#include "figures/chart.hpp"
#include "figures/figures.hpp"

namespace knap {

/// Losses too small to be seen are left out.
Chart energy_chart(const History& energy);
Chart crack_length_chart(const History& cracks);
Chart crack_speed_chart(const History& cracks, double rayleigh_speed);
/// Force over displacement of every load that moves (of all when none does), in the component that moves most; or all forces over time.
Chart reaction_chart(const History& reactions, bool over_time = false);
/// Displacements, openings and slips that can be seen beside the largest; velocities likewise.
Chart probe_chart(const History& probes);
Chart probe_velocity_chart(const History& probes);

}  // namespace knap
