#pragma once
// The outline of a rigid obstacle, convex, in a frame of its own with the origin at its centre of mass (half plane: on
// its border).
#include "mesh/polygon.hpp"

#include <cmath>

namespace knap {

/// Position and orientation of a rigid body in the plane.
struct Pose {
    Vec2 position = Vec2::Zero();  // [m] of its origin
    double angle = 0;              // [rad] by which it is turned

    Vec2 turned(const Vec2& a) const { return std::cos(angle) * a + std::sin(angle) * turned_left(a); }
    Vec2 turned_back(const Vec2& a) const { return std::cos(angle) * a - std::sin(angle) * turned_left(a); }
};

struct Outline {
    enum class Kind { half_plane, disc, polygon };
    Kind kind = Kind::half_plane;
    Vec2 normal = Vec2(0, 1);  // of a half plane, out of it
    double radius = 0;         // [m] of a disc
    std::vector<Vec2> points;  // [m] of a polygon, counterclockwise, convex

    double area() const;           // [m2]; 0 of a half plane, negative of a clockwise polygon
    double second_moment() const;  // [m4] polar, about the origin; 0 of a half plane
};

/// Position of a point relative to an outline.
struct SurfaceDistance {
    double gap;   // [m] distance; negative inside
    Vec2 normal;  // out of the obstacle
};
SurfaceDistance distance_to(const Outline& outline, const Pose& pose, const Vec2& point);

/// False only where the point is farther away than `reach` [m]: a cheap test before the distance.
bool may_reach(const Outline& outline, const Pose& pose, const Vec2& point, double reach);

}  // namespace knap
