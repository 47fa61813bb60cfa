#pragma once
// What is plotted over time: the energies, the crack length, the crack speed.
#include "observe/chart.hpp"
#include "observe/figures.hpp"

namespace knap {

/// Losses too small to be seen are left out.
Chart energy_chart(const History& energy);
Chart crack_length_chart(const History& cracks);
Chart crack_speed_chart(const History& cracks, double rayleigh_speed);

}  // namespace knap
