#pragma once
// Small shapes at the points of a curve, told apart without colour.
#include "observe/canvas.hpp"

namespace knap {

enum class Marker { none, circle, square, triangle, diamond, cross };

/// The i-th shape, none left out.
Marker marker(std::size_t i);

void draw_marker(Canvas& canvas, Marker marker, const Vec2& at, const Colour& colour);

}  // namespace knap
