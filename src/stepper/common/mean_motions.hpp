#pragma once
// The mean motions of pieces:
//
//     V = sum m v/M,  c = sum m x/M,  w = sum m (x - c) x (v - V)/J,     M = sum m,  J = sum m |x - c|^2
#include "base/vec.hpp"

#include <vector>

namespace knap {

struct MeanMotions {
    std::vector<double> mass, inertia, spin;
    std::vector<Vec2> centre, velocity;
};
/// `near` [m] per piece: a place whose distance to its corners has little rounding. `for_corners(visit)` calls
/// visit(piece, m, x, v) for the corners of pieces; others stay as they are.
template <class ForCorners>
MeanMotions mean_motions(const std::vector<Vec2>& near, const ForCorners& for_corners) {
    const std::size_t n = near.size();
    MeanMotions mean{.mass = std::vector<double>(n, 0),
                     .inertia = std::vector<double>(n, 0),
                     .spin = std::vector<double>(n, 0),
                     .centre = near,
                     .velocity = std::vector<Vec2>(n, Vec2::Zero())};
    std::vector<Vec2> first_moment(n, Vec2::Zero());
    for_corners([&](Index p, double m, const Vec2& x, const Vec2& v) {
        mean.mass[p] += m, first_moment[p] += m * (x - near[p]), mean.velocity[p] += m * v;
    });
    for (std::size_t p = 0; p < n; ++p)
        if (mean.mass[p] > 0) mean.centre[p] += first_moment[p] / mean.mass[p], mean.velocity[p] /= mean.mass[p];
    for_corners([&](Index p, double m, const Vec2& x, const Vec2& v) {
        const Vec2 arm = x - mean.centre[p];
        mean.inertia[p] += m * arm.squaredNorm(), mean.spin[p] += m * cross(arm, Vec2(v - mean.velocity[p]));
    });
    for (std::size_t p = 0; p < n; ++p)
        if (mean.inertia[p] > 0) mean.spin[p] /= mean.inertia[p];
    return mean;
}

}  // namespace knap
