// Momentum of what is free, in steps so large that inertia is hidden behind the rounding of theta^2 h^2 K.
#include "support/bodies.hpp"
#include "support/relative.hpp"
#include "support/springs.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace free_motions_test {

using namespace knap;
using namespace knap::tests;

namespace {

/// Rock of 1 x 0.2 m, 520 kg/m.
ModelInput slab(int n = 12) {
    ModelInput input =
        body_with(bar_mesh(n, 3, 1, 0.2), {.density = 2600, .E = 50e9, .nu = 0.25}, CohesiveLaw::unbreakable());
    return input;
}

struct Momenta {
    Vec2 linear = Vec2::Zero(), centre = Vec2::Zero();  // [kg m/s], [m] displacement of the centre of mass
    double angular = 0, mass = 0;                       // [kg m2/s] about the origin of the undeformed body
};
Momenta momenta(const Run& run, Index region = -1) {
    Momenta sum;
    for (Index c = 0; c < run.model.mesh.n_corners(); ++c) {
        if (region >= 0 && run.model.mesh.region[c / 3] != region) continue;
        const double m = run.model.corner_mass[c];
        const Vec2 v = run.now.velocity[run.now.node_of_corner[c]];
        sum.mass += m, sum.linear += m * v, sum.angular += m * cross(run.model.mesh.corner(c), v);
        sum.centre += m * run.now.displacement_of(c);
    }
    sum.centre /= sum.mass;
    return sum;
}

}  // namespace

TEST_CASE("a pushed free body gains exactly the impulse and the moment of its loads in steps of any size") {
    for (const double h : {1e-3, 1.0, 1e3, 1e5}) {
        CAPTURE(h);
        ModelInput input = slab();
        input.loads = {load(Load::Kind::traction, "left", 1e-3, 0.0), load(Load::Kind::acceleration, "", 0.0, 1e-7),
                       load(Load::Kind::traction, "top", 2e-4, -3e-4)};
        Run run(input, implicit(0.6));
        for (int i = 0; i < 10; ++i) REQUIRE(run.step_if_taken(h));
        const Momenta p = momenta(run);
        const double t = 10 * h;
        CHECK(p.linear.x() == relative(t * (1e-3 * 0.2 + 2e-4), 1e-11));
        CHECK(p.linear.y() == relative(t * (520 * 1e-7 - 3e-4), 1e-11));
        const double moment = -1e-3 * 0.2 * 0.1 + 520 * 1e-7 * 0.5 - 2e-4 * 0.2 - 3e-4 * 0.5;
        CHECK(p.angular == relative(t * moment, 1e-11));
    }
}

TEST_CASE("a free slab that balanced loads stretch and bend does not drift") {
    for (const double h : {1e3, 1e5}) {
        CAPTURE(h);
        ModelInput input = slab();
        const TimeFunction ramp{{0, 20 * h}, {0, 1}};
        input.loads = {
            load(Load::Kind::traction, "left", -3e6, 0.0, ramp),
            load(Load::Kind::traction, "right", 3e6, 0.0, ramp),
            {.kind = Load::Kind::stress, .on = {.boundary = "top"}, .stress = {0, -2e6, 0}, .history = ramp},
            {.kind = Load::Kind::stress, .on = {.boundary = "bottom"}, .stress = {0, -2e6, 0}, .history = ramp}};
        Run run(input, implicit(1));
        double largest = 0;
        for (int i = 0; i < 20; ++i) REQUIRE(run.step_if_taken(h));
        for (const Vec2& u : run.now.displacement) largest = std::max(largest, u.norm());
        REQUIRE(largest > 1e-5);
        // rounding of loads that balance: 1e-16 of 6e5 N moves 520 kg by 1e-11 of the stretch in 1e4 s
        const double load = 1e-15 * 6e5 * h * 20 / 520 * 20 * h;
        CHECK(momenta(run).centre.norm() <= 1e-11 * largest + load);
    }
}

TEST_CASE("what is free along a support gains exactly the impulse along it") {
    for (const double h : {1.0, 1e4}) {
        CAPTURE(h);
        ModelInput input = slab();
        input.loads = {load(Load::Kind::displacement, "bottom", std::nullopt, 0.0),
                       load(Load::Kind::traction, "top", 2e-3, -1e5)};
        Run run(input, implicit(0.7));
        for (int i = 0; i < 10; ++i) REQUIRE(run.step_if_taken(h));
        CHECK(momenta(run).linear.x() == relative(10 * h * 2e-3, 1e-10));
    }
}

}  // namespace free_motions_test
