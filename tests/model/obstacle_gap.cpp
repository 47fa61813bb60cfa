// Rigid obstacles among each other: their gaps by hand, and which pairs can meet.
#include "model/obstacle_gap.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

namespace obstacle_gap_test {

using namespace knap;
using knap::tests::relative;

namespace {

Obstacle half_plane(const Vec2& normal) { return {.outline = {.normal = normal}}; }

Obstacle disc(const Vec2& centre, double radius) {
    Obstacle obstacle{.outline = {.kind = Outline::Kind::disc, .radius = radius}};
    obstacle.start.position = centre;
    return obstacle;
}

Obstacle square(const Vec2& centre, double side) {
    const double a = side / 2;
    Obstacle obstacle{.outline = {.kind = Outline::Kind::polygon, .points = {{-a, -a}, {a, -a}, {a, a}, {-a, a}}}};
    obstacle.start.position = centre;
    return obstacle;
}

double gap(const Obstacle& a, const Obstacle& b) {
    const double gap = gap_between({a.outline, a.start}, {b.outline, b.start}).gap;
    CHECK(gap_between({b.outline, b.start}, {a.outline, a.start}).gap == relative(gap, 1e-14));
    return gap;
}

}  // namespace

TEST_CASE("gaps between half planes and discs and polygons that are apart or overlap") {
    const Obstacle floor = half_plane(Vec2(0, 1));
    CHECK(gap(floor, disc(Vec2(3, 2), 0.5)) == relative(1.5, 1e-14));
    CHECK(gap(floor, disc(Vec2(0, 0), 0.5)) == relative(-0.5, 1e-14));
    CHECK(gap(floor, square(Vec2(0, 2), 1)) == relative(1.5, 1e-14));
    CHECK(gap(disc(Vec2(0, 0), 1), disc(Vec2(3, 4), 1)) == relative(3, 1e-14));
    CHECK(gap(disc(Vec2(2, 0), 0.5), square(Vec2(0, 0), 2)) == relative(0.5, 1e-14));
    CHECK(gap(square(Vec2(0, 0), 1), square(Vec2(3, 0.2), 1)) == relative(2, 1e-14));
    CHECK(gap(square(Vec2(0, 0), 1), square(Vec2(0.9, 0.2), 1)) == relative(-0.1, 1e-12));
}

TEST_CASE("obstacles may meet if one is free unless the components that move keep them apart") {
    std::vector<Obstacle> obstacles{half_plane(Vec2(0, 1)), disc(Vec2(0, 2), 0.5)};
    CHECK(obstacles_that_may_meet(obstacles).empty());  // both held
    obstacles[1].drive[1].kind = Drive::Kind::free;
    CHECK(obstacles_that_may_meet(obstacles).size() == 1);  // it falls on the floor
    obstacles[1].drive[1].kind = Drive::Kind::displacement, obstacles[1].drive[0].kind = Drive::Kind::free;
    CHECK(obstacles_that_may_meet(obstacles).empty());  // it moves along the floor
    obstacles.push_back(square(Vec2(4, 2.2), 1));
    CHECK(obstacles_that_may_meet(obstacles).size() == 1);  // and against a block
    obstacles.back().start.position.y() = 3.5;
    CHECK(obstacles_that_may_meet(obstacles).empty());  // and below a block
}

}  // namespace obstacle_gap_test
