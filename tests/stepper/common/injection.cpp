// Fluids that are injected into cracks: volume, pressure, energy, and how stiff they may be. And pressures over the
// depth.
#include "mesh/triangulate.hpp"
#include "model/make_model.hpp"
#include "stepper/common/crack_forces.hpp"
#include "stepper/common/surface_energy.hpp"
#include "support/plates.hpp"
#include "support/relative.hpp"
#include "support/verification.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

namespace injection_test {

using namespace knap;
using namespace knap::tests;

namespace {

constexpr double thickness = thickness_of_block;  // [m]

Load held_at(const Box& box, std::optional<double> x) {
    return {.kind = Load::Kind::displacement, .on = {.boundary = "", .box = box, .body = ""}, .value = {x, 0}};
}

SchemeOptions implicit(double theta = 0.5) {
    SchemeOptions scheme;
    scheme.bulk = BulkScheme::implicit_theta;
    scheme.theta = theta;
    return scheme;
}

/// A crack from the left that water drives through a weak block.
ModelInput driven(bool large_rotation = false) {
    ModelInput input = pressed_block(
        {{.points = {{0, 0.5}, {0.3, 0.45}}}},
        {.rate = 0.3, .storage = 3e-12, .from = Selection{.boundary = "left", .box = {}, .body = ""}}, 0.06);
    input.laws = {{.sigma_c = 3e6, .G_c = 20, .gamma = 1}};
    input.large_rotation = large_rotation;
    return input;
}

}  // namespace

TEST_CASE("an injected fluid that meets another one ends the run with the place") {
    for (const double rate : {0.3, 0.0}) {
        ModelInput input = driven();
        input.crack_pressures.push_back(input.crack_pressures[0]);
        input.crack_pressures[1].rate = rate, input.crack_pressures[1].pressure = 1e5;
        Run run(std::move(input));
        CHECK_THROWS_WITH_AS(run.step(run.stepper.stable_step()), doctest::Contains("meet at (0"), SimulationError);
    }
}

TEST_CASE("the integral of a function of time is that of its straight pieces") {
    CHECK(TimeFunction{}.integral(3) == 3);
    const TimeFunction f{.time = {1, 2, 2, 4}, .value = {2, 4, 0, 6}};
    CHECK(f.integral(0) == 0);
    CHECK(f.integral(1) == relative(2));
    CHECK(f.integral(1.5) == relative(2 + 1.25));
    CHECK(f.integral(3) == relative(2 + 3 + 1.5));
    CHECK(f.integral(6) == relative(2 + 3 + 6 + 12));
}

// With the storage C the fluid is a spring of 1/C along the volume A d of two blocks with masses m that move apart by d:
// m/2 d'' = A p and C p + A d = Q t, so that p = Q/(C omega) sin(omega t) with omega^2 = 2 A^2/(m C).
TEST_CASE("a fluid between two blocks is a spring of its storage") {
    for (const bool is_implicit : {false, true}) {
        CAPTURE(is_implicit);
        CrackPressure fluid{.rate = 1e-3, .storage = 1e-8};
        ModelInput input = pressed_block({{.points = {{0, 0.5}, {1, 0.5}}}}, fluid, 0.25);
        const double mass = 2500 * 0.5 * thickness, C = fluid.storage * thickness, A = thickness,
                     omega = A * std::sqrt(2 / (mass * C)), Q = fluid.rate * thickness,
                     period = 2 * std::numbers::pi / omega;
        Run run(std::move(input), is_implicit ? implicit() : SchemeOptions{});
        const double h = std::min(period / 2000, is_implicit ? infinity : 0.9 * run.stepper.stable_step()),
                     end = 0.45 * period;
        double largest = 0;
        CrackForces forces(run.model);
        while (run.now.time < end) {
            REQUIRE(run.step(h).rejection == Rejection::none);
            const double exact = Q / (C * omega) * std::sin(omega * run.now.time);
            largest = std::max(largest, std::abs(run.now.fluid_pressure[0] - exact) * C * omega / Q);
            const FluidMoment now = forces.moments(run.now)[0];
            CHECK(now.injected == relative(Q * run.now.time));
            CHECK(now.length == relative(1));
        }
        CHECK(largest < 5e-3);  // the blocks are a little elastic; p of the end of steps damps by omega h/4
        CHECK(run.ledger.largest_residual() < (is_implicit ? 1e-8 : 1e-12) * run.ledger.largest_energy());
    }
}

// Nothing but the fluid acts: every corner at the crack moves by itself, and the faces part with V = Q - C p, so that
// p of steps far beyond 2/omega with omega^2 = a' M^-1 a/C is the blow of the first step and then next to nothing.
TEST_CASE("an explicit step takes any storage of a fluid") {
    const CrackPressure fluid{.rate = 1e-3, .storage = 1e-10};
    ModelInput input = pressed_block({{.points = {{0, 0.5}, {1, 0.5}}}}, fluid, 0.25);
    input.materials[0].E = 1e-3;
    Run run(std::move(input));
    CrackForces forces(run.model);
    forces.find(run.now);
    const double omega = std::sqrt(forces.mobility(0, run.now) / forces.storage(0)), h = 1000 / omega;
    for (int i = 0; i < 200; ++i) {
        REQUIRE(run.step(h).rejection == Rejection::none);
        const double p = run.now.fluid_pressure[0];
        const FluidMoment now = forces.moments(run.now)[0];
        // [m3] the fluid does not pull: after the blow of the first step the faces fly on by 2e-10 of 5e-5 a step
        CHECK(now.volume + forces.storage(0) * p == within(now.injected, 5e-10));
        CHECK(p < 3 / (omega * h) * fluid.rate / fluid.storage /
                      omega);  // 2/(omega h) of the amplitude of the spring, in the first step
    }
}

TEST_CASE("a fluid that drives a crack keeps its volume and the energy balance of the body") {
    for (const bool large_rotation : {false, true})
        for (const bool is_implicit : {false, true}) {
            CAPTURE(large_rotation);
            CAPTURE(is_implicit);
            Run run(driven(large_rotation), is_implicit ? implicit() : SchemeOptions{});
            const double h = is_implicit ? 5e-6 : 0.5 * MoreauJean(run.model, {}).stable_step();
            CrackForces forces(run.model);
            const double length = forces.moments(run.now)[0].length;
            const double C = forces.storage(0);
            while (run.now.time < 4e-4) {
                const State before = run.now;
                for (double step = h; !run.step_if_taken(step); step *= 0.5) REQUIRE(step > 1e-3 * h);
                if (large_rotation) continue;  // the frames turn within the step
                forces.find(before);           // at the points on which the fluid pressed
                const double left = forces.injected(0, run.now.time) - forces.volume(0, run.now);
                CHECK(C * run.now.fluid_pressure[0] ==
                      within(std::max(0.0, left), 1e-6 * forces.injected(0, run.now.time)));
            }
            CHECK(forces.moments(run.now)[0].length > 2 * length);  // the fluid followed the crack
            CHECK(run.ledger.largest_residual() < (is_implicit ? 1e-9 : 1e-12) * run.ledger.largest_energy());
        }
}

// G_c times its growth is what a sharp crack takes: all that the interfaces have dissipated and would give back.
TEST_CASE("a fluid states the length of the sharp crack with the same fracture energy") {
    for (const bool in_process_zone : {false, true}) {
        CAPTURE(in_process_zone);
        ModelInput input = driven();
        input.crack_pressures[0].in_process_zone = in_process_zone;
        Run run(std::move(input));
        CrackForces forces(run.model);
        const double start = forces.moments(run.now)[0].length, h = 0.5 * run.stepper.stable_step();
        CHECK(forces.moments(run.now)[0].sharp_crack == relative(start));
        double broken = 0;
        while (broken < 0.1) {
            REQUIRE(run.step_if_taken(h));
            broken = 0;
            for (const Interface& interface : run.model.interfaces) {
                const Index first =
                    run.model.points_per_interface() * static_cast<Index>(&interface - run.model.interfaces.data());
                broken += (cohesion(run.model, run.now, first) == 0) * interface.length;
            }
            broken -= start;
        }
        const StepReport taken = surface_energy(run.model, run.now);
        CHECK(forces.moments(run.now)[0].sharp_crack - start ==
              relative((taken.dissipated + taken.recoverable) / (20 * thickness), 1e-9));
    }
}

TEST_CASE("a run with an injected fluid has the same bits after a resume") {
    for (const bool is_implicit : {false, true}) {
        const SchemeOptions scheme = is_implicit ? implicit() : SchemeOptions{};
        Run whole(driven(), scheme);
        const double h = is_implicit ? 5e-6 : 0.5 * MoreauJean(whole.model, {}).stable_step();
        for (int i = 0; i < 30; ++i) REQUIRE(whole.step(h).rejection == Rejection::none);
        MoreauJean resumed(whole.model, scheme);
        State now = whole.now, next = now;
        for (int i = 0; i < 15; ++i) whole.step(h), resumed.step(now, h, next), std::swap(now, next);
        CHECK(same_bits(whole.now, now));
        CHECK(whole.now.fluid_pressure == now.fluid_pressure);
    }
}

TEST_CASE("E34 a volume of fluid opens a crack") {
    describe(
        "A crack of length 2 a in an infinite body (Griffith 1921, Sneddon 1946) that a volume Q of fluid with the "
        "storage C fills: p = Q/(C + 2 pi a^2/E'), opening 4 p a/E' in its middle. The block is 20 a wide; "
        "triangles of second order, a/5 at the crack; thirty implicit steps with theta = 1.");
    on_path("implicit, implicit");
    constexpr double a = 0.05, E = 30e9 / (1 - 0.2 * 0.2), exact = 2 * std::numbers::pi * a * a / E;  // [m2/Pa]
    const double volume = 2e6 * exact;                                                                // [m2]
    const CrackPressure fluid{.rate = volume / 1e-3, .storage = 0.1 * exact, .history = {{0, 1e-3, 1e-3}, {1, 1, 0}}};
    ModelInput input = pressed_block({{.points = {{0.5 - a, 0.5}, {0.5 + a, 0.5}}}}, fluid, 0.05, 2,
                                     {{{{0.4, 0.4}, {0.6, 0.6}}, 0.01}});
    input.loads = {held_at({{-1, -1}, {1e-6, 1e-6}}, 0), held_at({{1 - 1e-6, -1}, {2, 1e-6}}, {})};
    Run run(std::move(input), implicit(1));
    for (int i = 0; i < 30; ++i) REQUIRE(run.step(1e-3).rejection == Rejection::none);
    CrackForces forces(run.model);
    const FluidMoment now = forces.moments(run.now)[0];
    CHECK(now.injected == relative(volume * thickness, 1e-12));
    CHECK(now.volume + fluid.storage * thickness * now.pressure == relative(now.injected, 1e-8));
    verify("pressure [Pa]", now.pressure, volume / (1.1 * exact), {0.02, 0.01});
    verify("opening in the middle [m]", now.aperture, 4 * now.pressure * a / E, {0.02, 0.01});
    // the work of the fluid is the energy that the body keeps, and what the steps with theta = 1 dissipate
    CHECK(run.ledger.largest_residual() < 1e-11 * run.ledger.largest_energy());
}

TEST_CASE("a water table presses with the depth below it") {
    double wet = 0;  // [m] of the last one
    const auto force_on_right = [&](const CrackPressure& fluid) {
        const Model model = make_model(pressed_block({{.points = {{0.5, 0.2}, {0.5, 0.8}}}}, fluid));
        CrackForces forces(model);
        double sum = 0;
        wet = forces.moments(initial_state(model))[0].length;
        for (const CornerLoad& at : forces.find(initial_state(model)))
            if (model.mesh.centroid(model.mesh.triangle_of(at.corner)).x() > 0.5) sum += at.force.x();
        return sum / thickness;
    };
    const double g = 9810;
    CHECK(force_on_right({.gradient = g, .level = 0.9}) == relative(0.6 * g * 0.4));
    CHECK(wet == relative(0.6));
    CHECK(force_on_right({.gradient = g, .level = 0.5}) == relative(0.5 * g * 0.3 * 0.3, 0.02));
    CHECK(wet == within(0.3, 0.05));  // [m] an edge: the rest is dry
    CHECK(force_on_right({.gradient = g, .level = 0.2}) == 0);
    CHECK(wet == 0);
    CHECK(force_on_right({.pressure = 1e4, .gradient = g, .level = 0.8}) == relative(0.6 * (1e4 + 0.3 * g)));
    PlaceField over_y{.path = "pressure", .text = "", .n_values = 1};
    over_y.formulas[0] = {.of_place = Expression("1 + 2*y"), .unit = 1e3};
    CHECK(force_on_right({.field = std::make_shared<PlaceField>(over_y)}) == relative(0.6 * 2000));
}

}  // namespace injection_test
