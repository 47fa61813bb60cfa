// Tables over time between the ends of steps: impulses are exact, resolved tables keep their bits, large steps end at
// corners.
#include "model/time_tables.hpp"
#include "base/grid_table.hpp"
#include "model/make_model.hpp"

#include "support/bodies.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace time_tables_test {

using namespace knap;
using namespace knap::tests;

namespace {

struct Named {
    const char* name;
    TimeFunction table;
    double integral;
};
// over steps of 0.05 from 0 to 1; all begin and end with 0
const Named tables[] = {
    {"pulse within a step", {{0.212, 0.213, 0.217, 0.218}, {0, 1, 1, 0}}, 0.005},
    {"jumps", {{0.33, 0.33, 0.764, 0.764}, {0, 2, 2, 0}}, 0.868},
    {"jumps at ends of steps", {{0.35, 0.35, 0.7, 0.7}, {0, 2, 2, 0}}, 0.7},
    {"saw tooth over several steps", {{0.01, 0.26, 0.39}, {0, 2, 0}}, 0.38},
    {"both signs within a step", {{0.41, 0.42, 0.43, 0.44}, {0, 3, -1, 0}}, 0.02},
};

}  // namespace

TEST_CASE("tables over time: steps and kicks sum to the integral whatever lies between their ends") {
    for (const auto& [name, table, integral] : tables) {
        CAPTURE(name);
        double steps = 0, kicks = 0, uneven = 0, last = 0;
        for (int i = 0; i < 20; ++i) {
            const double t = 0.05 * i;
            steps += 0.05 * table.over_step(t, t + 0.05, 0.5);
            kicks += 0.5 * (i == 0 ? 0.05 : 0.1) * table.over_kick(t, i == 0 ? 0 : 0.05, 0.05);
        }
        for (double t = 0, h = 0.03; t < 1; last = h, t += h, h = h == 0.03 ? 0.05 : 0.03)
            uneven += 0.5 * (last + h) * table.over_kick(t, last, h);
        CHECK(steps == relative(integral, 1e-13));
        CHECK(kicks == relative(integral, 1e-13));
        CHECK(uneven == relative(integral, 1e-13));
    }
}

TEST_CASE("tables over time: a table that steps resolve keeps its bits and theta = 1 stays within the values") {
    const TimeFunction straight{{0, 0.1, 0.25, 1}, {0, 0.3, 0.75, 3}}, ramp{{0, 1}, {0, 1}};
    for (int i = 0; i < 100; ++i) {
        const double t = 0.0301 * i, h = 0.0301;
        CHECK(straight.beyond_trapezoid(t, std::min(t + h, 1.)) == 0);
        if (t + h < 1) CHECK(straight.over_step(t, t + h, 1) == straight(t + h));
        CHECK(straight.over_kick(std::min(t, 0.9), h, h) == straight(std::min(t, 0.9)));
        CHECK(ramp.beyond_trapezoid(i * 0.004001, (i + 1) * 0.004001) == 0);  // its end within one of 250 steps
    }
    const TimeFunction corner{{0, 0.55}, {0, 1}};
    CHECK(corner.beyond_trapezoid(0.5, 0.6) > 0.01);
    CHECK(corner.over_step(0.5, 0.6, 1) == 1);
    const TimeFunction jump{{0.5, 0.5}, {0, 1}};
    for (const double theta : {0.5, 1.}) {
        CHECK(jump.over_step(0.4, 0.5, theta) == 0);
        CHECK(jump.over_step(0.5, 0.6, theta) == 1);
    }
    CHECK(TimeFunction{}.over_step(0, 1, 0.5) == 1);
    CHECK(TimeFunction{}.over_kick(0, 1, 1) == 1);
    CHECK(TimeFunction{}.corner(0, 1, 0) == 1);
}

TEST_CASE("tables over time: large steps end at the corners that they would pass over") {
    ModelInput input = point_masses(CohesiveLaw::unbreakable(), true);
    const auto steps = [&](const TimeFunction& table, double h, double end) {
        input.loads = {load(Load::Kind::traction, "free", 1, 0, table)};
        const Model model = make_model(input);
        std::vector<double> times;
        for (double t = 0; t < end;) times.push_back(t += step_to_corner(model, t, h));
        return times;
    };
    CHECK(steps({{0, 12, 13, 17, 18}, {0, 0, 1, 1, 0}}, 50, 100) == std::vector<double>{12, 13, 17, 18, 68, 118});
    CHECK(steps({{0, 100}, {0, 1}}, 40, 200) == std::vector<double>{40, 80, 100, 140, 180, 220});
    CHECK(steps({{0, 5000}, {0, 1}}, 40, 80) == std::vector<double>{40, 80});
    CHECK(steps({{0, 75, 75.001, 100}, {0, 0, 1, 1}}, 50, 150) ==
          std::vector<double>{50, 75, 100, 150});  // no step of 1 ms
    CHECK(steps({}, 50, 100) == std::vector<double>{50, 100});
    // corners count whatever the values elsewhere, and where these lie
    CHECK(steps({{0, 10, 20, 21, 22, 90, 100}, {0, 0, 0, 1e-3, 0, 0, 1}}, 50, 100) ==
          std::vector<double>{20, 21, 22, 72, 90, 100});
    CHECK(steps({{0, 10, 20, 30}, {273, 273, 274, 274}}, 50, 30) == std::vector<double>{10, 20, 70});
    CHECK(steps({{0, 20, 20, 40}, {1, 1, 2, 2}}, 50, 50) == std::vector<double>{20, 70});
}

TEST_CASE("tables over time: large steps need not follow the samples of a smooth curve") {
    TimeFunction wave;
    for (int i = 0; i <= 1000; ++i)
        wave.time.push_back(0.1 * i), wave.value.push_back(300 + std::sin(0.02 * std::numbers::pi * wave.time.back()));
    std::vector<double> ends;
    for (double t = 0; t < 99.999;) ends.push_back(t = wave.corner(t, std::min(t + 2, 100.), 1e-3));
    CHECK(ends.size() < 60);
    for (const double peak : {25., 75.})
        CHECK(std::ranges::any_of(ends, [&](double t) { return std::abs(t - peak) < 1e-9; }));
    const GridTable grid({{0, 0, 0, 5},
                          {0, 0, 10, 5},
                          {0, 0, 20, 6},
                          {0, 0, 30, 1000},
                          {1, 0, 0, 5},
                          {1, 0, 10, 5},
                          {1, 0, 20, 5},
                          {1, 0, 30, 5}});
    CHECK(grid.corner(0, 15, 0) == 10);
    CHECK(grid.corner(10, 20, 0) == 20);
}

}  // namespace time_tables_test
