#pragma once
// Small shapes at the points of a curve, and patterns of its line: told apart without colour.
#include "figures/canvas.hpp"

namespace knap {

enum class Marker { none, circle, square, triangle, diamond, cross };

/// Lengths [unit] of dashes and gaps of a line of this width: 0 solid, 1 dashed, 2 dotted, 3 dash and dot, 4 dash and two dots, and again.
std::vector<double> line_pattern(int kind, double width);
inline constexpr int n_line_patterns = 5;

/// The i-th shape, none left out.
Marker marker(std::size_t i);

void draw_marker(Canvas& canvas, Marker marker, const Vec2& at, const Colour& colour);

}  // namespace knap
