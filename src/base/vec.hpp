#pragma once
// Numbers of the project: vectors are Eigen's; an `Index` counts triangles, corners, nodes, points.
#include <Eigen/Core>

#include <cstdint>
#include <limits>
#include <numbers>

namespace knap {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Index = std::int32_t;

inline constexpr Index no_index = -1;  // stands for none
inline constexpr double infinity = std::numeric_limits<double>::infinity();
inline constexpr double degree = std::numbers::pi / 180;  // [rad]

/// The vector turned by +90 degrees.
inline Vec2 turned_left(const Vec2& a) { return {-a.y(), a.x()}; }

/// z-component of the cross product.
inline double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

}  // namespace knap
