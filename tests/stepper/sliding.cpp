// Coulomb friction: a sliding block stops and stays (B14), a stuck point does not creep (E8).
#include "support/bodies.hpp"
#include "support/paths.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace sliding_test {

using namespace knap;
using namespace knap::tests;

namespace {

/// An elastic block of 1 x 1 on the support.
ModelInput block_on_support(const CohesiveLaw& law) {
    ModelInput input;
    input.mesh = bar_mesh(4, 4, 1, 1);
    input.materials = {{.density = 1000, .E = 1e7, .nu = 0.3}};
    input.laws = {law, CohesiveLaw::unbreakable()};
    input.law_of_pair = {{1}};
    input.supports = {{.on = {.boundary = "bottom", .box = {}}, .law = 0, .glued = false}};
    return input;
}

/// n periods of a sine or cosine of period 1.
TimeFunction wave(int n, double phase) {
    TimeFunction made;
    for (int i = 0; i <= 100 * n; ++i) {
        made.time.push_back(0.01 * i);
        made.value.push_back(std::sin(2 * M_PI * 0.01 * i + phase));
    }
    return made;
}

void check_energy_balance(const Run& run) {
    CHECK(run.ledger.largest_residual() <= 1e-12 * run.ledger.largest_energy());
    CHECK(run.ledger.worst().worst_friction_work <= 1e-14 * run.ledger.largest_energy());
    CHECK(run.ledger.worst().worst_impact_work <= 1e-14 * run.ledger.largest_energy());
    CHECK(run.ledger.worst().residual <= 1e-10);
}

}  // namespace

TEST_CASE("B14 a sliding point stops at v0 over mu g and then rests exactly") {
    describe(
        "A point mass slides with v_0 = 2 under g = 9.81, mu = .3: v = v_0 - mu g t, until it stops at t = v_0/(mu g) "
        "= .67958 and then does not move at all.");
    const double mu = 0.3, g = 9.81, v0 = 2;
    for (const double h : {1e-3, 3.7e-4}) {
        on_path(both_explicit);
        const std::string at = ", h = " + digits(h);
        double worst = 0;
        ModelInput input = point_masses({.sigma_c = 0, .friction = mu}, false);
        input.loads = {load(Load::Kind::acceleration, "", 0.0, -g)};
        input.initial_velocities = {{.on = {}, .value = {v0, 0}}};
        Run run(input);
        while (run.v(0, 0).x() > 0) {
            run.step(h);
            // velocities live at the middle of the steps
            if (run.v(0, 0).x() > 0)
                worst = std::max(worst, std::abs(run.v(0, 0).x() - v0 + mu * g * (run.now.time - 0.5 * h)) / v0);
            REQUIRE(run.now.time < 1);
        }
        verify_small("error of v over v_0 while it slides" + at, worst, {1e-12});
        verify_near("stops at, within a step" + at, run.now.time, v0 / (mu * g), {2 * h, h});
        const Vec2 place = run.u(0, 0);
        verify_near("stops after" + at, place.x(), 0.5 * v0 * v0 / (mu * g), {2 * h * v0, 0.2 * h * v0});
        for (int i = 0; i < 5000; ++i) run.step(h);
        verify_that("5000 steps later it has the same place and no velocity, to the bit" + at,
                    run.v(0, 0) == Vec2(0, 0) && run.u(0, 0) == place);
        verify("friction work over the energy of the start" + at, run.ledger.row().friction_work / (-2 * 0.5 * v0 * v0),
               1, {1e-12});  // two points of mass 1
        check_energy_balance(run);
    }
}

TEST_CASE("B14 a sliding point stops at v0 over mu g and then rests by the implicit scheme") {
    const double mu = 0.3, g = 9.81, v0 = 2;
    for (const double theta : {0.5, 1.0}) {
        on_path(both_implicit);
        const std::string at = ", theta = " + digits(theta);
        const double h = 1e-3;
        ModelInput input = point_masses({.sigma_c = 0, .friction = mu}, false);
        input.loads = {load(Load::Kind::acceleration, "", 0.0, -g)};
        input.initial_velocities = {{.on = {}, .value = {v0, 0}}};
        SchemeOptions scheme = both_implicit;
        scheme.theta = theta;
        Run run(input, scheme);
        double worst = 0, stops = 0;
        while (run.now.time < 0.9) {
            const double before = run.u(0, 0).x();
            run.step(h);
            REQUIRE(run.last.rejection == Rejection::none);
            if (stops == 0 && run.now.time < v0 / (mu * g))
                worst = std::max(worst, std::abs(run.v(0, 0).x() - v0 + mu * g * run.now.time) / v0);
            if (stops == 0 && run.u(0, 0).x() == before) stops = run.now.time - h;
        }
        verify_small("error of v over v_0 while it slides" + at, worst, {1e-12});
        verify_near("stops at, within a step" + at, stops, v0 / (mu * g), {2 * h, h});
        const Vec2 place = run.u(0, 0);
        for (int i = 0; i < 5000; ++i) run.step(h);
        verify_that("5000 steps later it has the same place to the bit" + at, run.u(0, 0) == place);
        check_energy_balance(run);
    }
}

TEST_CASE("B14 an elastic block stops when friction has taken its momentum") {
    // the bottom sticks and slides in waves, but the support's impulse is mu times the weight while the whole bottom
    // slides
    const double mu = 0.3, g = 9.81, v0 = 1;
    ModelInput input = block_on_support({.sigma_c = 0, .friction = mu});
    input.loads = {load(Load::Kind::acceleration, "", 0.0, -g)};
    input.initial_velocities = {{.on = {}, .value = {v0, 0}}};
    Run run(input);
    const double h = 0.9 * run.stepper.stable_step();
    const auto all = [](Index) { return true; };
    while (run.now.time < 0.5 * v0 / (mu * g)) run.step(h);
    on_path(both_explicit);
    describe(
        "An elastic block of 1 x 1 with v_0 = 1: its base sticks and slides in waves, but the impulse of the support "
        "is mu times the weight while it slides.");
    verify("mean velocity at v_0/(2 mu g), over v_0", run.mean_velocity(all).x() / v0, 0.5, {0.05, 0.01});
    while (run.now.time < 1.2 * v0 / (mu * g)) run.step(h);
    verify_small("mean velocity at 1.2 v_0/(mu g), over v_0", run.mean_velocity(all).x() / v0, {0.05, 0.01});
    check_energy_balance(run);
    CHECK(run.ledger.row().friction_work < -0.9 * 0.5 * 1000 * v0 * v0);
}

TEST_CASE("E8 a stuck point under a rotating load does not drift") {
    // inside the strength at every angle: in contact alone, glued, and glued again after damage
    describe(
        "10 000 steps of a rotating load on a point, at .99 of what holds it: by the friction of a pressure that "
        "varies by a third, or glued.");
    on_path(both_explicit);
    const int periods = 100;
    const double h = 0.01, sigma_c = 2, delta = 1e-3;
    const CohesiveLaw law{.sigma_c = sigma_c, .G_c = 0.5 * sigma_c * delta, .gamma = 0.7, .friction = 0.4};
    for (const bool glued : {false, true}) {
        ModelInput input = point_masses(law, glued);
        // contact: pressure 3 +- 1, shear up to .99 mu (3 - 1); glued: 0.99 of the inner circle of the strength polygon
        const double shear = (law.gamma + law.friction) * sigma_c / std::sqrt(1 + law.friction * law.friction);
        const double normal = glued ? 0.99 * std::min(sigma_c, shear) : 1,
                     tangential = glued ? normal : 0.99 * law.friction * 2;
        input.loads = {load(Load::Kind::body_force, "", 3 * tangential, std::nullopt, wave(periods, 0)),
                       load(Load::Kind::body_force, "", std::nullopt, 3 * normal, wave(periods, M_PI / 2)),
                       load(Load::Kind::body_force, "", 0.0, glued ? 0.0 : -9.0)};
        Run run(input);
        for (int i = 0; i < 100 * periods; ++i) run.step(h);
        verify_small(std::string("drift over delta_c in 10 000 steps, ") + (glued ? "glued" : "by friction alone"),
                     std::max(run.u(0, 0).norm(), run.u(0, 1).norm()) / delta, {1e-12});
        if (glued) CHECK(cohesion(run.model, run.now, 0) == 1);
        check_energy_balance(run);
    }
}

TEST_CASE("E8 a damaged point that has closed sticks again with what strength is left") {
    const double h = 0.01, sigma_c = 2, delta = 1;
    const CohesiveLaw law{.sigma_c = sigma_c, .G_c = 0.5 * sigma_c * delta, .gamma = 0.7, .friction = 0.4};
    ModelInput input = point_masses(law, true);
    // a pull opens it by part, a pressure closes it; then a shear within what is left pushes for 10 000 steps
    input.loads = {load(Load::Kind::body_force, "", 0.0, 3.0, {{0, 0.1, 0.5, 0.6, 3, 3.1}, {3, 3, 3, -20, -20, 0}}),
                   load(Load::Kind::body_force, "", 1.0, std::nullopt, {{3.0, 3.1}, {0, 1}})};
    Run run(input);
    while (run.now.time < 4) run.step(h);
    const double beta = cohesion(run.model, run.now, 0);
    CHECK(beta < 0.95);
    CHECK(beta > 0.3);
    const Vec2 place = run.u(0, 0);
    CHECK(run.v(0, 0).norm() <= 1e-14);
    for (int i = 0; i < 10000; ++i) run.step(h);
    on_path(both_explicit);
    verify_small("drift over delta_c in 10 000 steps, damaged and closed", (run.u(0, 0) - place).norm() / delta,
                 {1e-12});
    verify_that("its cohesion stays, to the bit", cohesion(run.model, run.now, 0) == beta);
    check_energy_balance(run);
}

}  // namespace sliding_test
