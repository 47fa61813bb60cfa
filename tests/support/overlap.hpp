#pragma once
// Overlaps of triangles, from their positions alone: whatever the stepper knows of contacts.
#include "model/state.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <span>

namespace knap::tests {

inline Vec2 place(const Model& model, const State& state, Index corner) {
    return model.mesh.corner(corner) + state.displacement_of(corner);
}

/// [m] By how much two triangles would have to be moved apart: the least overlap along the normals of their edges.
inline double overlap(const std::array<Vec2, 3>& a, const std::array<Vec2, 3>& b) {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [one, other] : {std::pair(&a, &b), std::pair(&b, &a)})
        for (int k = 0; k < 3; ++k) {
            const Vec2 along = (*one)[(k + 1) % 3] - (*one)[k], normal = -turned_left(along).normalized();
            double gap = std::numeric_limits<double>::infinity();
            for (const Vec2& x : *other) gap = std::min(gap, normal.dot(x - (*one)[k]));
            if ((least = std::min(least, -gap)) <= 0) return 0;
        }
    return least;
}

/// [-] Of two triangles, over their longest edge and over their shortest one: the largest.
struct Overlap {
    double of_longest = 0, of_shortest = 0;
};
/// `piece_of`: if it is not empty, only of triangles of different pieces.
inline Overlap largest_overlap(const Model& model, const State& state, std::span<const Index> piece_of = {}) {
    struct Triangle {
        std::array<Vec2, 3> x;
        Vec2 low, high;
        double longest = 0, shortest = std::numeric_limits<double>::infinity();
    };
    std::vector<Triangle> triangles;
    for (Index t = 0; t < model.mesh.n_triangles(); ++t) {
        Triangle one{};
        for (Index k = 0; k < 3; ++k) one.x[k] = place(model, state, 3 * t + k);
        one.low = one.x[0].cwiseMin(one.x[1]).cwiseMin(one.x[2]);
        one.high = one.x[0].cwiseMax(one.x[1]).cwiseMax(one.x[2]);
        for (Index k = 0; k < 3; ++k) {
            const double edge = (one.x[k] - one.x[(k + 1) % 3]).norm();
            one.longest = std::max(one.longest, edge), one.shortest = std::min(one.shortest, edge);
        }
        triangles.push_back(one);
    }
    Overlap most;
    for (std::size_t i = 0; i < triangles.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) {
            if (!piece_of.empty() && piece_of[i] == piece_of[j]) continue;
            const Triangle &a = triangles[i], &b = triangles[j];
            if ((a.low.array() > b.high.array()).any() || (b.low.array() > a.high.array()).any()) continue;
            const double found = overlap(a.x, b.x);
            most.of_longest = std::max(most.of_longest, found / std::max(a.longest, b.longest));
            most.of_shortest = std::max(most.of_shortest, found / std::min(a.shortest, b.shortest));
        }
    return most;
}

}  // namespace knap::tests
