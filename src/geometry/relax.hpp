#pragma once
// Moves single vertices of the worst triangles, for the sake of the explicit time step, and leaves the others where chance put them.
#include "geometry/mesh.hpp"
#include "geometry/size_field.hpp"

namespace knap {

/// The stable step of a free triangle with lumped mass over that of an equilateral triangle of the wanted edge length (1 = as good).
/// The fastest mode is taken as the one of a scalar wave: omega^2 = 3 c^2 lambda, lambda the largest eigenvalue of sum grad N grad N'.
double step_ratio(const Vec2& a, const Vec2& b, const Vec2& c, double size);

/// Sine of the smallest angle; negative for a triangle that is turned over.
double smallest_sine(const Vec2& a, const Vec2& b, const Vec2& c);

struct Wanted {
    double step_ratio = 0.66;  // [-]
    double min_angle = 22;     // [degree]
};

/// Tries to lift the step ratio and the smallest angle of every triangle above what is wanted. `fixed` has one flag per vertex.
/// Only vertices and triangles are used.
void relax_worst(Mesh& mesh, const std::vector<char>& fixed, const SizeField& size, const Wanted& wanted);

}  // namespace knap
