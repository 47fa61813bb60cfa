#include "heat/corner_pairs.hpp"

#include <cmath>

namespace knap {
namespace {

/// [-] w/(k t) of the side opposite to `at` in a triangle: half the cotangent of the angle there.
double half_cotangent(const Vec2& at, const Vec2& a, const Vec2& b) {
    return 0.5 * (a - at).dot(b - at) / std::abs(cross(a - at, b - at));
}

}  // namespace

std::span<const CornerPair> corner_pairs(Index order) {
    if (order == 1) return linear_pairs;
    return quadratic_pairs;
}

std::array<double, 12> half_cotangents(const Mesh& mesh, Index t) {
    std::array<double, 12> w{};
    if (mesh.order == 1) {
        for (Index i = 0; i < 3; ++i)
            w[i] = half_cotangent(mesh.corner(t, (i + 2) % 3), mesh.corner(t, i), mesh.corner(t, (i + 1) % 3));
        return w;
    }
    for (Index side = 0; side < 6; ++side) {
        const auto [a, b] = quadratic_pairs[side];
        const Vec2 x = mesh.corner(t, a), y = mesh.corner(t, b), z = mesh.corner(t, 6);
        w[side] += half_cotangent(z, x, y);
        w[6 + a] += half_cotangent(y, x, z);
        w[6 + b] += half_cotangent(x, y, z);
    }
    return w;
}

}  // namespace knap
