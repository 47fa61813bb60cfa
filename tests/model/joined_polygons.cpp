// Fixed polygons that touch or overlap have one surface, without the sides that lie in others of them.
#include "model/joined_polygons.hpp"

#include "base/random.hpp"
#include "support/obstacle_shapes.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <map>

namespace joined_polygons_test {

using namespace knap;
using knap::tests::relative;

namespace {

Obstacle rectangle(const Vec2& low, const Vec2& high) {
    return tests::polygon({low, {high.x(), low.y()}, high, {low.x(), high.y()}});
}

std::vector<Obstacle> joined(std::vector<Obstacle> obstacles) {
    join_fixed_polygons(obstacles);
    return obstacles;
}

double length_of(const Obstacle& obstacle) {
    double length = 0;
    for (const Polyline::Side& side : obstacle.outline.line->sides())
        if (side.owner == obstacle.outline.owner) length += side.length;
    return length;
}

std::vector<SurfaceDistance> planes_at(const std::vector<Obstacle>& obstacles, const Vec2& x, const Vec2& motion) {
    std::vector<SurfaceDistance> found;
    for (const Obstacle& obstacle : obstacles)
        ObstacleSurface(obstacle.outline, obstacle.start)
            .visit_planes(x, motion, 1e-4, 0.05, 0.1, [&](const SurfaceDistance& at) {
                if (at.gap <= 0.05) found.push_back(at);
            });
    return found;
}

}  // namespace

TEST_CASE("joined polygons: the surface of polygons that touch or overlap is that of their union") {
    SUBCASE("flush") {
        const auto two = joined({rectangle({0, 0}, {2, 1}), rectangle({2, 0}, {3, 1})});
        CHECK(length_of(two[0]) == relative(5));
        CHECK(length_of(two[1]) == relative(3));
    }
    SUBCASE("a step: a part of a side is hidden") {
        const auto two = joined({rectangle({0, 0}, {2, 1}), rectangle({2, 0}, {3, 0.4})});
        CHECK(length_of(two[0]) == relative(5.6));
        CHECK(length_of(two[1]) == relative(2.4));
    }
    SUBCASE("they overlap, and what faces the same way belongs to the first one") {
        const auto two = joined({rectangle({0, 0}, {2, 1}), rectangle({1.5, 0}, {3, 1})});
        CHECK(length_of(two[0]) == relative(5));
        CHECK(length_of(two[1]) == relative(3));
    }
    SUBCASE("a cross of two, of which each hides two parts of the other") {
        const auto two = joined({rectangle({-2, -1}, {2, 1}), rectangle({-1, -2}, {1, 2})});
        CHECK(length_of(two[0]) == relative(8));
        CHECK(length_of(two[1]) == relative(8));
    }
    SUBCASE("one inside another one has no surface") {
        const auto two = joined({rectangle({-1, -1}, {1, 1}), rectangle({-2, -2}, {2, 2})});
        CHECK(length_of(two[0]) == 0);
        CHECK(length_of(two[1]) == relative(16));
    }
    SUBCASE("those that are apart, or move, keep their own") {
        std::vector<Obstacle> three{rectangle({0, 0}, {2, 1}), rectangle({2, 0}, {3, 1}), rectangle({3.1, 0}, {4, 1})};
        three[1].drive[0] = tests::driven(1);
        join_fixed_polygons(three);
        for (const Obstacle& one : three) CHECK_FALSE(one.outline.line);
    }
    SUBCASE("a closed row of four round a hole: two loops, each side goes on where it ends") {
        const auto four = joined({rectangle({0, 0}, {3, 1}), rectangle({0, 2}, {3, 3}), rectangle({0, 1}, {1, 2}),
                                  rectangle({2, 1}, {3, 2})});
        double length = 0;
        for (const Obstacle& one : four) length += length_of(one);
        CHECK(length == relative(12 + 4));
        for (const Polyline::Side& side : four[0].outline.line->sides()) {
            REQUIRE(side.after >= 0);
            CHECK((four[0].outline.line->sides()[side.after].start - side.end).norm() < 1e-12);
        }
    }
}

TEST_CASE("joined polygons: a point near the seam of two slabs meets one plane and none of what lies inside") {
    // the tops fall by 31 and 40 degrees, then rise
    const auto slabs = joined({tests::polygon({{-5, 0}, {20, 0}, {20, 88}, {-5, 103}}),
                               tests::polygon({{20, 0}, {60, 0}, {60, 55}, {20, 88}}),
                               tests::polygon({{60, 0}, {90, 0}, {90, 70}, {60, 55}})});
    const Vec2 n_0 = Vec2(15, 25).normalized(), n_1 = Vec2(33, 40).normalized();
    Random random(3, "points");
    for (int k = 0; k < 2000; ++k) {
        const double side = random.uniform(-0.03, 0.03), depth = random.uniform(-0.03, 0.03);
        const Vec2 x = Vec2(20, 88) + Vec2(side, -depth), motion(random.uniform(0, 0.02), -0.01);
        CAPTURE(side);
        CAPTURE(depth);
        const auto found = planes_at(slabs, x, motion);
        REQUIRE(found.size() == 1);
        const bool is_first = found[0].normal.dot(n_0) > 1 - 1e-12;
        CHECK((is_first || found[0].normal.dot(n_1) > 1 - 1e-12));
        CHECK(found[0].gap == relative((is_first ? n_0 : n_1).dot(x - Vec2(20, 88))));
    }
    CHECK(planes_at(slabs, {60, 55.01}, Vec2::Zero()).size() == 2);  // in the valley
}

TEST_CASE("joined polygons: on a straight seam exactly one slab has a point wherever it is") {
    const auto slabs = joined({rectangle({-1, -1}, {0.1, 0}), rectangle({0.1, -1}, {1, 0})});
    for (const double x : {0.1, std::nextafter(0.1, 0), std::nextafter(0.1, 1), 0.1 - 1e-9, 0.1 + 1e-9})
        for (const double y : {0.01, 0.0, -1e-9, -0.01}) CHECK(planes_at(slabs, {x, y}, Vec2::Zero()).size() == 1);
    CHECK(planes_at(slabs, {0.1, -0.5}, Vec2::Zero()).empty());  // deep in the ground
}

TEST_CASE("joined polygons: the corners that may touch edges are the convex ones of the union") {
    const auto slabs = joined({rectangle({0, 0}, {2, 1}), rectangle({2, 0}, {3, 0.4}), rectangle({3, 0}, {4, 0.4})});
    std::map<std::pair<double, double>, int> corners;
    for (const Obstacle& slab : slabs) {
        const ObstacleSurface surface(slab.outline, slab.start);
        surface.visit_corners({2, 0.5}, 10, [&](std::size_t i) {
            const Vec2 x = surface.corner(i);
            ++corners[{std::round(1e9 * x.x()) / 1e9, std::round(1e9 * x.y()) / 1e9}];
        });
    }
    CHECK(corners ==
          std::map<std::pair<double, double>, int>{{{0, 0}, 1}, {{0, 1}, 1}, {{2, 1}, 1}, {{4, 0}, 1}, {{4, 0.4}, 1}});
}

}  // namespace joined_polygons_test
