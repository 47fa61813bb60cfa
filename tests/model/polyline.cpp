// Open polylines with the ground on their left: distances, planes that a point may touch, and what is near.
#include "model/polyline.hpp"

#include "base/random.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

namespace polyline_test {

using namespace knap;
using knap::tests::relative;

namespace {

struct Plane {
    double gap;
    Vec2 normal;
};

std::vector<Plane> planes_at(const Polyline& line, const Vec2& p, const Vec2& motion = Vec2::Zero()) {
    std::vector<Plane> found;
    line.visit_planes(p, motion, 1e-6, 0.1, 0.1, Polyline::nobody, [&](double gap, const Vec2& normal) {
        found.push_back({gap, normal});
    });
    return found;
}

double distance(const Polyline& line, const Vec2& p) {
    Vec2 normal;
    return line.distance_to(p, normal);
}

/// A rough terrain over 100 m from the right to the left.
std::vector<Vec2> rough(int n) {
    Random random(7, "terrain");
    std::vector<Vec2> points;
    for (int i = 0; i <= n; ++i) points.emplace_back(100 - 100. * i / n, random.uniform(0, 1));
    return points;
}

}  // namespace

TEST_CASE("polyline: the ground lies on the left and beyond the ends there is none") {
    const Polyline line({{2, 0}, {1, 1}, {0, 0}});  // a roof
    CHECK(distance(line, {1, 2}) == relative(1));
    CHECK(distance(line, {1, 0}) == relative(-std::sqrt(0.5)));
    CHECK(distance(line, {3, 0}) == relative(1));
    CHECK(distance(line, {2.1, -5}) > 5);
    CHECK(line.is_corner(0));
    CHECK(line.is_corner(1));
    CHECK_FALSE(Polyline({{2, 1}, {1, 0}, {0, 1}}).is_corner(1));  // a valley
    CHECK_FALSE(Polyline({{2, 0}, {1, 0}, {0, 0}}).is_corner(1));  // straight
}

TEST_CASE("polyline: a point touches both sides of a valley and one of a summit or a straight line") {
    const Polyline valley({{1, 1}, {0, 0}, {-1, 1}}), summit({{1, -1}, {0, 0}, {-1, -1}}),
        straight({{1, 0}, {0, 0}, {-1, 0}});
    CHECK(planes_at(valley, {0, 0.01}).size() == 2);
    CHECK(planes_at(valley, {0, -0.01}).size() == 2);
    CHECK(planes_at(valley, {0.2, 0.19}).size() == 1);
    for (const double x : {-0.05, -1e-9, 0.0, 1e-9, 0.05})
        for (const double y : {-0.02, -1e-9, 0.0, 1e-9, 0.02}) {
            CAPTURE(x);
            CAPTURE(y);
            CHECK(planes_at(summit, {x, y - std::abs(x)}).size() == 1);
            CHECK(planes_at(straight, {x, y}).size() == 1);
        }
    CHECK(planes_at(straight, {1.01, -0.01}).empty());  // beyond the end
    // the one that a point comes to when it moves over the summit
    CHECK(planes_at(summit, {0, -1e-8}, {-0.01, -1e-3}).front().normal.x() < 0);
    CHECK(planes_at(summit, {0, -1e-8}, {0.01, -1e-3}).front().normal.x() > 0);
}

TEST_CASE("polyline: what is near is found among many sides as among all") {
    const std::vector<Vec2> points = rough(300);
    const Polyline line(points);
    Random random(3, "places");
    for (int k = 0; k < 300; ++k) {
        const Vec2 p(random.uniform(-5, 105), random.uniform(-3, 4));
        double nearest = infinity;
        for (const Polyline::Side& side : line.sides()) {
            const double s = std::clamp(side.along.dot(p - side.start), 0.0, side.length);
            nearest = std::min(nearest, (p - side.start - s * side.along).norm());
        }
        CHECK(std::abs(distance(line, p)) == relative(nearest, 1e-12));
        if (line.may_reach(p, 0.5)) continue;
        CHECK(nearest > 0.5);
    }
    // below and above
    for (int i = 1; i < 300; ++i) {
        const Vec2 middle = 0.5 * (points[i - 1] + points[i]);
        CHECK(distance(line, middle + Vec2(0, 1e-6)) > 0);
        CHECK(distance(line, middle - Vec2(0, 1e-6)) < 0);
    }
}

}  // namespace polyline_test
