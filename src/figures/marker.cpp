#include "figures/marker.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace knap {

std::vector<double> line_pattern(int kind, double width) {
    switch (kind % n_line_patterns) {
        case 1: return {4 * width, 2.5 * width};
        case 2: return {1.2 * width, 1.8 * width};
        case 3: return {4 * width, 1.8 * width, 1.2 * width, 1.8 * width};
        case 4: return {4 * width, 1.8 * width, 1.2 * width, 1.8 * width, 1.2 * width, 1.8 * width};
        default: return {};
    }
}

Marker marker(std::size_t i) {
    constexpr std::array all{Marker::circle, Marker::square, Marker::triangle, Marker::diamond, Marker::cross};
    return all[i % all.size()];
}

namespace {

constexpr double radius = 3.2;  // [unit] of the circle; the others have about its area

std::vector<Vec2> polygon(const Vec2& at, int n, double r, double first_angle) {
    std::vector<Vec2> points;
    for (int i = 0; i < n; ++i) {
        const double angle = first_angle + 2 * std::numbers::pi * i / n;
        points.push_back(at + r * Vec2(std::cos(angle), std::sin(angle)));
    }
    return points;
}

}  // namespace

void draw_marker(Canvas& canvas, Marker marker, const Vec2& at, const Colour& colour) {
    constexpr double up = std::numbers::pi / 2;
    switch (marker) {
        case Marker::none: return;
        case Marker::circle: return canvas.fill(polygon(at, 32, radius, 0), colour);
        case Marker::square: return canvas.fill(polygon(at, 4, 1.25 * radius, up / 2), colour);
        case Marker::triangle: return canvas.fill(polygon(at, 3, 1.4 * radius, up), colour);
        case Marker::diamond: return canvas.fill(polygon(at, 4, 1.4 * radius, up), colour);
        case Marker::cross: {
            const Vec2 a(radius, radius), b(radius, -radius);
            return canvas.segments({at - a, at + a, at - b, at + b}, colour, 1.4);
        }
    }
}

}  // namespace knap
