#pragma once
// A map of fracture traces as it comes from a digitised photograph of an outcrop.
#include "base/random.hpp"
#include "mesh/polygon.hpp"

#include <cmath>
#include <numbers>

namespace knap::tests {

/// Polylines in and around a box from the origin to `extent` [m]. Two sets of strikes (20 and 105 degree, scattered by 8
/// degree), lengths by a power law of exponent 2.5 between 0.4 m and 12 m, two to four wavy pieces each. Two thirds end
/// at an earlier trace and miss it by some `error` [m], short or beyond; one in forty is drawn twice.
inline std::vector<std::vector<Vec2>> trace_map(int n, const Vec2& extent, double error, std::uint64_t seed) {
    Random random(seed, "trace map");
    std::vector<std::vector<Vec2>> traces;
    std::vector<Segment> known;
    while (static_cast<int>(traces.size()) < n) {
        std::vector<Vec2> points;
        if (!traces.empty() && random.uniform() < 0.025) {
            points = traces[static_cast<std::size_t>(random.uniform() * static_cast<double>(traces.size()))];
            for (Vec2& x : points) x += error * Vec2(random.normal(), random.normal());
        } else {
            const double strike = ((random.uniform() < 0.6 ? 20 : 105) + 8 * random.normal()) * std::numbers::pi / 180,
                         u = random.uniform(),
                         length = std::pow(std::pow(0.4, -1.5) * (1 - u) + std::pow(12, -1.5) * u, -1 / 1.5);
            const Vec2 middle(extent.x() * random.uniform(), extent.y() * random.uniform()),
                along(std::cos(strike), std::sin(strike));
            Vec2 ends[2] = {middle - 0.5 * length * along, middle + 0.5 * length * along};
            for (Vec2& end : ends) {
                if (random.uniform() > 0.67) continue;
                double first = 1;
                for (const Segment& other : known)
                    if (double t = 0; segments_cross({middle, end}, other, t)) first = std::min(first, t);
                if (first < 1)
                    end = middle +
                          (first * (end - middle).norm() + error * random.normal()) * (end - middle).normalized();
            }
            const int pieces = 2 + static_cast<int>(3 * random.uniform());
            for (int i = 0; i <= pieces; ++i) {
                Vec2 x = ends[0] + i * (ends[1] - ends[0]) / pieces;
                if (i > 0 && i < pieces) x += 0.02 * length * random.normal() * turned_left(along);
                points.push_back(x);
            }
        }
        for (const Segment& side : sides_of(points, false)) known.push_back(side);
        traces.push_back(std::move(points));
    }
    return traces;
}

}  // namespace knap::tests
