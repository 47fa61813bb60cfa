#pragma once
// Gradients of the three linear shape functions of a triangle (its barycentric coordinates), and what a uniform stress makes of them.
#include "mesh/mesh.hpp"

namespace knap {

/// [1/m] g_0 + g_1 + g_2 = 0
inline std::array<Vec2, 3> shape_gradients(const Mesh& mesh, Index t) {
    std::array<Vec2, 3> gradients;
    for (Index k = 0; k < 3; ++k)
        gradients[k] = turned_left(mesh.corner(t, (k + 2) % 3) - mesh.corner(t, (k + 1) % 3)) / (2 * mesh.area(t));
    return gradients;
}

/// [m2] The largest force on corner k of a triangle of this volume [m3] under a uniform stress of norm 1 (mesh.hpp numbers the corners).
/// Order 1: V |g_k|. Order 2: a sixth of both neighbouring edges at a vertex, four sixths of the own at the middle of an edge.
inline double force_of_unit_stress(const std::array<Vec2, 3>& g, double volume, Index order, Index k) {
    if (order == 1) return volume * g[k].norm();
    if (k < 3) return volume / 3 * g[k].norm();
    return k < 6 ? 4 * volume / 3 * g[(k + 2) % 3].norm() : 0;  // edge k - 3 is opposite to vertex (k - 1) % 3
}

}  // namespace knap
