// Friction that lags at points that cycle, and iterates of Newton that return.
#include "stepper/implicit/lagged_friction.hpp"
#include "stepper/implicit/newton_cycle.hpp"

#include <doctest/doctest.h>

using namespace knap;

namespace lagged_friction_test {
namespace {

std::vector<ActivePoint> broken_points(std::size_t n) {
    std::vector<ActivePoint> points(n);
    for (ActivePoint& point : points) point.law.friction = 0.5, point.law.cohesion = 0, point.multipliers.contact = 2;
    return points;
}

}  // namespace

TEST_CASE("Friction lags at points that cycle until no point changes its piece") {
    std::vector<ActivePoint> points = broken_points(3);
    points[2].law.cohesion = 0.5;
    LaggedFriction lag(3);
    lag.begin(3);
    CHECK(!lag.hold_back_cycling(points));
    for (int i = 0; i < 2; ++i) lag.count_change(0), lag.count_change(2), lag.settles(2, points);
    lag.count_change(1);
    CHECK(lag.hold_back_cycling(points));
    CHECK(!points[0].multipliers.friction_follows);
    CHECK(points[0].multipliers.pressed == 2);
    CHECK(points[1].multipliers.friction_follows);
    CHECK(points[2].multipliers.friction_follows);
    points[0].multipliers.contact = 3;
    lag.advance(points);
    CHECK(points[0].multipliers.pressed > 2.5);
    CHECK(points[0].multipliers.pressed < 3);
    CHECK(!lag.settles(0, points));
    CHECK(lag.settles(0, points));
    CHECK(points[0].multipliers.friction_follows);
    CHECK(!lag.is_used());
}

TEST_CASE("Changes while many points change are no cycle") {
    std::vector<ActivePoint> points = broken_points(1);
    LaggedFriction lag(1);
    lag.begin(1);
    for (int i = 0; i < 5; ++i) lag.count_change(0);
    lag.settles(100, points);
    CHECK(!lag.hold_back_cycling(points));
    lag.hold_back_all(points);
    CHECK(lag.end(points));
    CHECK(!lag.end(points));
}

TEST_CASE("Newton's method returns where pieces and residual do") {
    std::vector<ActivePoint> points = broken_points(2);
    NewtonCycle cycle(2);
    cycle.begin();
    const auto goes_on_at = [&](int i, double norm, std::uint32_t state) {
        points[1].response.state = state;
        return !cycle.returns(i, norm, points);
    };
    CHECK(goes_on_at(16, 1, 1));
    CHECK(goes_on_at(17, 0.5, 2));
    CHECK(goes_on_at(18, 1, 3));
    CHECK(goes_on_at(19, 1 + 1e-7, 1));
    CHECK(!goes_on_at(20, 1 + 1e-10, 1));
}

}  // namespace lagged_friction_test
