#pragma once
// What a rock test is judged by: stress over strain, breaks over time and by their direction, sizes of fragments.
#include "figures/chart.hpp"
#include "figures/figures.hpp"

namespace knap {

/// Stress over all strains that were measured, with the stresses at which cracks begin and become unstable.
Chart stress_strain_chart(const History& stress_strain);

/// Tensile and shear breaks so far, from `begin` to `end` [s].
Chart break_chart(const History& breaks, double begin, double end);

/// Part of the mass in fragments of a diameter or less.
Chart fragment_size_chart(const History& fragments);

/// Rose diagram of the directions of broken interfaces, weighted by their length: the area of a petal is the length in its 10 degrees; tension inside, shear
/// outside. A direction is none of two senses, so every petal is there twice.
DrawnFigure draw_rose(const History& breaks, const std::string& title, const std::filesystem::path& file, int pixels);

inline constexpr int n_petals = 18;

/// [m] broken in tension and in shear, per petal from angle 0 on.
struct Petal {
    double tensile = 0, shear = 0;
    double length() const { return tensile + shear; }
};
std::vector<Petal> petals(const History& breaks);

}  // namespace knap
