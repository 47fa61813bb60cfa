#pragma once
// Circles and arcs as polygons with sides of the local mesh size: corners lie on the curve, so that areas converge at second order.
#include "geometry/size_field.hpp"

#include <optional>
#include <vector>

namespace knap {

struct Arc {
    Vec2 centre;
    double radius;       // [m]
    double from, sweep;  // [rad] direction of its begin from the centre; positive counterclockwise

    double length() const;  // [m]
    Vec2 at(double part) const;  // 0 its begin, 1 its end
};

/// The arc from a over `through` to b; nothing where they lie on a line, to 1e-9 of their distance.
std::optional<Arc> arc_through(const Vec2& a, const Vec2& through, const Vec2& b);

/// How many sides an arc gets: its length in local mesh sizes, at least twelve for a full turn.
double sides_of(const Arc& arc, const SizeField& size);

/// Positions on an arc, 0 and 1 left out, that cut it into pieces of the local mesh size.
std::vector<Vec2> points_within(const Arc& arc, const SizeField& size);

/// A full circle, counterclockwise; equal sides where the size is the same all round.
std::vector<Vec2> circle(const Vec2& centre, double radius, const SizeField& size);

}  // namespace knap
