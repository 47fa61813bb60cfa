// Friction over pressure: its polygon is the minimum of its lines, and what is none is refused.
#include "material/cohesive_law.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace friction_over_pressure_test {

using namespace knap;
using knap::tests::relative;
using knap::tests::within;

TEST_CASE("friction over pressure is the polygon of its points and the minimum of its lines") {
    const std::vector<Vec2> points{{0, 0}, {1, 1.5}, {2, 3}, {4, 4}, {10, 5}};
    REQUIRE(fault_of_friction(points).empty());
    const FrictionOverPressure f(points);
    CHECK(f.n_lines() == 3);  // the first two pieces are one
    for (const Vec2& point : points) CHECK(f(point.x()) == relative(point.y(), 1e-15));
    CHECK(f(16) == relative(6));  // closed by its last slope
    CHECK(f(-1) == 0);
    for (double p = 0; p < 20; p += 0.1) {
        double lowest = INFINITY;
        for (const FrictionLine& line : f.lines()) lowest = std::min(lowest, line.slope * p + line.offset);
        CHECK(f(p) == relative(lowest, 1e-14));
    }
    CHECK(f.chord(0) == 1.5);
    CHECK(f.chord(4) == relative(1));
}

TEST_CASE("points that are no friction over pressure are refused with their fault") {
    const auto fault = [](const std::vector<Vec2>& points) { return fault_of_friction(points); };
    CHECK(fault({{0, 0}}) == "has fewer than two pairs");
    CHECK(fault({{1, 0}, {2, 1}}) == "does not start with threshold 0 at pressure 0");
    CHECK(fault({{0, 1}, {2, 1}}) == "does not start with threshold 0 at pressure 0");
    CHECK(fault({{0, 0}, {2, 1}, {2, 3}}) == "has pressures that do not ascend (pair 3)");
    CHECK(fault({{0, 0}, {2, 1}, {3, 0.5}}) == "has a threshold that falls with the pressure (pair 3)");
    CHECK(fault({{0, 0}, {2, 1}, {3, 2}}) == "is not concave: its slope grows (pair 3)");
    CHECK(fault({{0, 0}, {2, 0}}) == "has no friction at all");
    CHECK(fault(std::vector<Vec2>(14, Vec2::Zero())) == "has 14 pairs, more than 13");
}

TEST_CASE("the strength of a facet in the worst direction is that of the steepest search over directions") {
    CohesiveLaw law{.sigma_c = 8, .G_c = 1, .gamma = 0.4};
    law.over_pressure =
        std::make_shared<FrictionOverPressure>(std::vector<Vec2>{{0, 0}, {20, 34}, {80, 90}, {200, 150}});
    for (const Coupling coupling : {Coupling::sum, Coupling::norm})
        for (const double confinement : {0.0, 5.0, 40.0, 300.0}) {
            law.coupling = coupling;
            const double strength = law.compressive_strength(confinement).stress;
            const auto slack = [&](double sigma_1) {  // of all facets
                double least = INFINITY;
                for (int i = 1; i < 9000; ++i) {
                    const double a = i * 1e-2 * degree,
                                 r_N = confinement + (sigma_1 - confinement) * std::pow(std::sin(a), 2),
                                 r_T = (sigma_1 - confinement) * std::sin(a) * std::cos(a),
                                 p = r_N + (coupling == Coupling::sum ? law.sigma_c : 0);
                    least = std::min(least, law.gamma * law.sigma_c + (*law.over_pressure)(p)-r_T);
                }
                return least / sigma_1;
            };
            CAPTURE(confinement);
            CHECK(slack(strength) == within(0, 1e-6));
            CHECK(slack(0.999 * strength) > 0);
            CHECK(slack(1.001 * strength) < 0);
        }
}

}  // namespace friction_over_pressure_test
