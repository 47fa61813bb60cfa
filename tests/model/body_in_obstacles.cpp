// Edges of a body in obstacles: their gaps by hand.
#include "model/body_in_obstacles.hpp"
#include "model/obstacle_gap.hpp"
#include "support/obstacle_shapes.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace body_in_obstacles_test {

using namespace knap;
using namespace knap::tests;

namespace {

/// Of an edge with the body to the left of a to b.
double gap(const Obstacle& obstacle, const Vec2& a, const Vec2& b) {
    return gap_to_edge({obstacle.outline, obstacle.start}, a, b).gap;
}

}  // namespace

TEST_CASE("edges in obstacles: gaps of half planes and discs and polygons from the upper side of a body") {
    const Vec2 a(1, 0), b(-1, 0);  // the body lies below
    CHECK(gap(platen({0, 0.3}, {0, -1}), a, b) == relative(0.3, 1e-14));
    CHECK(gap(platen({0, -0.3}, {1, -1}), a, b) == relative(-1.3 / std::sqrt(2), 1e-14));
    const auto disc = [](double x, double y) { return boulder({x, y}, 0.5, {0, 0}); };
    CHECK(gap(disc(0, 0.7), a, b) == relative(0.2, 1e-14));
    CHECK(gap(disc(0.2, 0.4), a, b) == relative(-0.1, 1e-14));
    CHECK(gap(disc(0.2, -0.2), a, b) == relative(-0.7, 1e-14));                       // most of it is below
    CHECK(gap(disc(0.2, -0.6), a, b) == relative(0.1, 1e-14));                        // another edge is concerned
    CHECK(gap(disc(1.3, 0.3), a, b) == relative(std::hypot(0.3, 0.3) - 0.5, 1e-14));  // the end
    const auto spike = [](double x, double y) { return polygon({{x, y}, {x + 0.05, y + 2}, {x - 0.05, y + 2}}); };
    CHECK(gap(spike(0, 0.1), a, b) == relative(0.1, 1e-14));
    CHECK(gap(spike(0, -0.2), a, b) == relative(-0.2, 1e-14));  // not by its thickness
    CHECK(gap(spike(3, -0.2), a, b) > 1);
    const auto bench = [](double x, double y) { return polygon({{x - 3, y - 2}, {x, y - 2}, {x, y}, {x - 3, y}}); };
    const Vec2 c(-1, 0), d(1, 0);  // the lower side of a body
    CHECK(std::abs(gap(bench(0, 0), c, d)) < 1e-15);
    CHECK(gap(bench(0, 0.1), c, d) == relative(-0.1, 1e-14));
    const Vec2 turn(std::cos(0.1), -std::sin(0.1));  // about the left end, down beyond the bench
    CHECK(gap(bench(0, 0), c, c + 2 * turn) == relative(-std::sin(0.1), 1e-13));
}

TEST_CASE("edges in obstacles: half widths") {
    CHECK(boulder({0, 0}, 0.5, {0, 0}).outline.half_width() == 0.5);
    CHECK(polygon({{0, 0}, {4, 0}, {4, 1}, {0, 1}}).outline.half_width() == relative(0.5, 1e-15));
    CHECK(polygon({{0, 0}, {3, 0}, {0, 4}}).outline.half_width() == relative(1.2, 1e-15));
    CHECK(platen({0, 0}, {0, 1}).outline.half_width() == infinity);
}

}  // namespace body_in_obstacles_test
