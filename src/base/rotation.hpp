#pragma once
// Rotations in the plane.
#include "base/vec.hpp"

#include <cmath>

namespace knap {

struct Rotation {
    double cosine = 1, sine = 0;

    static Rotation by(double angle) { return {.cosine = std::cos(angle), .sine = std::sin(angle)}; }  // [rad]
    Vec2 turned(const Vec2& a) const { return sine == 0 ? a : Vec2(cosine * a + sine * turned_left(a)); }
    Vec2 turned_back(const Vec2& a) const { return sine == 0 ? a : Vec2(cosine * a - sine * turned_left(a)); }
};

/// First b, then a.
inline Rotation composed(const Rotation& a, const Rotation& b) {
    return {.cosine = a.cosine * b.cosine - a.sine * b.sine, .sine = a.sine * b.cosine + a.cosine * b.sine};
}
/// a^-1 b
inline Rotation from_to(const Rotation& a, const Rotation& b) {
    return composed({.cosine = a.cosine, .sine = -a.sine}, b);
}
/// (cosine, sine) of any length; the identity where it is zero.
inline Rotation rotation_along(const Vec2& direction) {
    const double length = std::hypot(direction.x(), direction.y());
    return length > 0 ? Rotation{direction.x() / length, direction.y() / length} : Rotation{};
}
/// By half of the angle, which is below 180 degrees.
inline Rotation half_of(const Rotation& a) { return rotation_along({1 + a.cosine, a.sine}); }
inline double angle_of(const Rotation& a) { return std::atan2(a.sine, a.cosine); }

}  // namespace knap
