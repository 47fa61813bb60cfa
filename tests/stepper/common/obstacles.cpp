// Rigid obstacles with the explicit bulk: driven platens and free boulders. Exact points, balances, waves,
// random bodies.
#include "support/obstacles.hpp"
#include "support/bodies.hpp"
#include "support/paths.hpp"
#include "support/random_bodies.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace obstacles_test {

using namespace knap;
using namespace knap::tests;

namespace {

void check_energy_balance(const Run& run) { tests::check_energy_balance(run, 1e-12, 1e-14); }

/// Three masses of 1 without stiffness; the lower two at y = 0, x = 0 and 2.
ModelInput free_points() {
    ModelInput input = point_masses({.sigma_c = 0}, false);
    input.supports.clear();
    return input;
}

/// Momentum of body and free obstacles.
Vec2 momentum(const Run& run) {
    Vec2 sum = Vec2::Zero();
    for (Index c = 0; c < run.model.mesh.n_corners(); ++c)
        sum += run.model.corner_mass[c] * run.now.velocity[run.now.node_of_corner[c]];
    for (std::size_t o = 0; o < run.model.obstacles.size(); ++o)
        if (run.model.obstacles[o].is_free())
            sum += run.model.obstacles[o].mass * run.now.obstacles[o].velocity.head<2>();
    return sum;
}

/// An elastic block of 1 x 1 that breaks, from the origin.
ModelInput block(int n, const CohesiveLaw& law) {
    ModelInput input = body_with(bar_mesh(n, n, 1, 1), {.density = 1, .E = 100, .nu = 0.2}, law);
    return input;
}

}  // namespace

TEST_CASE("B14 points slide down an inclined platen as Coulomb says and stop where it is flat enough") {
    describe(
        "Two masses slide down a platen that is inclined by .1 or .5, from .1 m/s: acceleration g (sin - mu cos), rest "
        "where that has taken their speed.");
    on_path(both_explicit);
    const double g = 9.81, h = 1e-3;
    for (const double angle : {0.1, 0.5})
        for (const double mu : {0.0, 0.3}) {
            double worst = 0;
            ModelInput input = free_points();
            const Vec2 down(-std::cos(angle), -std::sin(angle)), normal(-std::sin(angle), std::cos(angle));
            for (Vec2& x : input.mesh.vertices) x = -x.x() * down + x.y() * normal + Vec2(3, 7);
            input.obstacles = {platen(Vec2(3, 7), normal, {.friction = mu})};
            input.loads = {load(Load::Kind::acceleration, "", 0.0, -g)};
            const double v0 = 0.1;
            input.initial_velocities = {{.on = {}, .value = v0 * down}};
            Run run(input);
            const double a = g * (std::sin(angle) - mu * std::cos(angle));
            for (int i = 0; i < 200; ++i) {
                run.step(h);
                const double v = v0 + a * (run.now.time - 0.5 * h);  // velocities live at the middle of the steps
                if (v > 0) worst = std::max(worst, std::abs(run.v(0, 0).dot(down) / v - 1));
                else if (v < -a * h) CHECK(run.v(0, 0).norm() <= 1e-15);
                CHECK(std::abs(run.v(0, 1).dot(normal)) <= 1e-15);
            }
            verify_small("relative error of the speed while it slides, angle " + digits(angle) + ", mu = " + digits(mu),
                         worst, {1e-12});
            // two masses of 1 press on it
            CHECK(run.now.obstacles[0].reaction.head<2>().dot(normal) == relative(-2 * g * std::cos(angle), 1e-12));
            check_energy_balance(run);
        }
}

TEST_CASE("a driven platen takes points along and its drive pays for it") {
    ModelInput input = free_points();
    input.obstacles = {platen({0, -0.5}, {0, 1})};
    input.obstacles[0].drive[1] = driven(2);
    Run run(input);
    for (int i = 0; i < 600; ++i) {
        run.step(1e-3);
        CHECK(run.u(0, 0).y() >= run.now.obstacles[0].pose.position.y() - 1e-12);
    }
    CHECK(run.v(0, 0).y() == relative(2, 1e-13));
    CHECK(run.v(0, 2) == Vec2(0, 0));
    CHECK(run.now.obstacles[0].moved.y() == relative(1.2, 1e-12));
    // landing on the wall takes two steps; all but what the impacts take is kinetic energy: m v^2 of work for m v^2/2
    // of energy, twice
    CHECK(run.ledger.row().external_work == relative(8, 1e-12));
    CHECK(run.ledger.row().kinetic == relative(4, 1e-12));
    check_energy_balance(run);
}

TEST_CASE("a polygon that turns sweeps points along with the speed of its surface") {
    ModelInput input = free_points();
    input.obstacles = {polygon({{-0.5, -1.1}, {2.5, -1.1}, {2.5, -0.1}, {-0.5, -0.1}})};
    input.obstacles[0].drive[2] = driven(0.5);
    Run run(input);
    for (int i = 0; i < 300; ++i) run.step(1e-3);
    check_energy_balance(run);
    // the right point is lifted, the left one is left behind
    CHECK(run.v(0, 0) == Vec2(0, 0));
    CHECK(run.v(0, 1).y() > 0.45);
    const auto [gap, normal] = ObstacleSurface(run.model.obstacles[0].outline, run.now.obstacles[0].pose)
                                   .distance_to(Vec2(2, 0) + run.u(0, 1));
    CHECK(gap >= -1e-6);
}

TEST_CASE("a disc dropped on a point rebounds by Newton's law") {
    for (const double e : {0.0, 0.4, 1.0}) {
        ModelInput input = free_points();
        input.materials[0].density = 30;                                          // ten times the mass of the disc
        input.obstacles = {boulder({1, 2.5}, 1, {0, -1.5}, {.restitution = e})};  // above the vertex (1, 1)
        Run run(input);
        double before = 0;
        while (run.v(0, 2).y() == 0) {
            before = run.now.obstacles[0].velocity.y();
            run.step(1e-3);
            REQUIRE(run.now.time < 1);
        }
        run.step(1e-3);  // with e = 0 it lands first
        CHECK(run.now.obstacles[0].velocity.y() - run.v(0, 2).y() == relative(-e * before, 1e-12));
        const double reduced = 1 * 10 / 11.0;
        CHECK(run.ledger.row().impact_work == within(-0.5 * reduced * before * before * (1 - e * e), 1e-12));  // of 1 J
        check_energy_balance(run);
    }
}

TEST_CASE("a spinning disc and a free block conserve momentum and the energy balance closes") {
    for (const double e : {0.0, 0.5})
        for (const double mu : {0.0, 0.4}) {
            ModelInput input = block(4, {.sigma_c = 0.5, .G_c = 0.01, .gamma = 1, .friction = 0});
            input.obstacles = {boulder({0.55, 1.35}, 0.3, {0.2, -3}, {.friction = mu, .restitution = e})};
            input.obstacles[0].initial_velocity.z() = 10;
            Run run(input);
            const Vec2 before = momentum(run);
            const double h = 0.8 * run.stepper.stable_step();
            for (int i = 0; i < 400; ++i) run.step(h);
            CHECK((momentum(run) - before).norm() <= 1e-12 * before.norm());
            CHECK(run.now.obstacles[0].velocity.y() > -2.5);  // it met the block
            CHECK((mu > 0) == (run.ledger.row().friction_work < -1e-6));
            CHECK((mu > 0) == (std::abs(run.now.obstacles[0].velocity.z() - 10) > 0.1));
            check_energy_balance(run);
        }
}

TEST_CASE("a boulder on an elastic bar is braked as the wave solution says") {
    // a rigid mass M at the end of a long bar: contact force rho c A v exp(-t/tau), tau = M/(rho c A), and so does its
    // velocity fall
    const double v = 1e-3;
    const ModelInput input = boulder_at_bar(200, v);
    const double tau = input.obstacles[0].mass / 0.01;
    Run run(input);
    const double h = 0.8 * run.stepper.stable_step();
    double worst_v = 0, impulse = 0;
    while (run.now.time < 0.9) {
        run.step(h);
        impulse -= h * run.now.obstacles[0].reaction.x();
        worst_v = std::max(worst_v, std::abs(run.now.obstacles[0].velocity.x() / v - std::exp(-run.now.time / tau)));
    }
    CHECK(tau == relative(0.22));
    CHECK(worst_v < 0.02);
    CHECK(impulse == relative(0.01 * tau * v * (1 - std::exp(-0.9 / tau)), 0.02));
    check_energy_balance(run);
}

TEST_CASE("a block rests on a rough platen with its weight") {
    ModelInput input = block(4, {.sigma_c = 5, .G_c = 0.1, .gamma = 1, .friction = 0.3});
    input.loads = {load(Load::Kind::acceleration, "", 0.0, -1.0, {{0, 3}, {0, 1}})};
    input.obstacles = {platen({0, 0}, {0, 1}, {.friction = 0.5})};
    Run run(input);
    const double h = 0.8 * run.stepper.stable_step();
    while (run.now.time < 6) run.step(h);
    CHECK(std::abs(run.now.obstacles[0].reaction.x()) < 1e-2);
    CHECK(run.now.obstacles[0].reaction.y() == relative(-1, 0.1));
    CHECK(run.ledger.row().surface() == 0);
    check_energy_balance(run);
}

namespace {

/// Some obstacles round a random body of the explicit bulk, on collision course.
Run random_scene(std::uint64_t seed, double unit_of_length = 1, double unit_of_time = 1, double unit_of_mass = 1) {
    RandomBodies bodies(seed, {.driven = false, .support = false, .units = false});
    RandomBody body = bodies.body();
    ModelInput& input = body.input;
    Random random(seed, "obstacles");
    ContactLaw contact{.friction = random.uniform() < 0.5 ? 0 : random.uniform(0, 0.5)};
    input.laws[0].restitution = 0;
    for (const double side : {-1.0, 1.0}) {
        const Vec2 centre(random.uniform(0, 2), side < 0 ? -0.02 : 3.4), towards(random.uniform(-0.3, 0.3), -side);
        const double kind = random.uniform(), speed = random.uniform(0.05, 0.5);
        Obstacle made = kind < 0.3 && input.obstacles.empty()
                            ? platen(centre, towards, contact)
                            : boulder(centre + Vec2(0, side), 1, speed * towards, contact);
        if (kind > 0.6) {
            const Rotation turned = Rotation::by(random.uniform(0, 6));
            std::vector<Vec2> corners;
            for (int i = 0; i < 5; ++i)
                corners.push_back(centre + Vec2(0, side) +
                                  turned.turned(Vec2(std::cos(i * 1.2566), std::sin(i * 1.2566))));
            made = polygon(corners, contact);
            set_free(made, 0.3);
            made.initial_velocity = Vec3(speed * towards.x(), speed * towards.y(), 0.1);
        }
        if (!made.is_free()) {
            made.drive[1] = driven(-side * speed);
            double nearest = 1e9;
            for (const Vec2& x : input.mesh.vertices)
                nearest = std::min(nearest, ObstacleSurface(made.outline, made.start).distance_to(x).gap);
            made.start.position += (nearest - 0.02) * made.outline.normal;
        }
        input.obstacles.push_back(made);
    }
    const double L = unit_of_length, T = unit_of_time, M = unit_of_mass;
    for (Vec2& x : input.mesh.vertices) x *= L;
    input.thickness *= L;
    for (Elastic& material : input.materials) material.density *= M / (L * L * L), material.E *= M / (L * T * T);
    input.laws[0].sigma_c *= M / (L * T * T);
    input.laws[0].G_c *= M / (T * T);
    input.loads.clear();
    for (Obstacle& o : input.obstacles) {
        o.start.position *= L;
        o.outline.radius *= L;
        for (Vec2& p : o.outline.points) p *= L;
        o.mass *= M;
        o.inertia *= M * L * L;
        o.initial_velocity.head<2>() *= L / T;
        o.initial_velocity.z() /= T;
        for (int k = 0; k < 2; ++k) o.drive[k].value *= L / T;
    }
    return Run(input);
}

}  // namespace

TEST_CASE("random bodies among random obstacles hardly penetrate and never gain energy") {
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        CAPTURE(seed);
        Run run = random_scene(seed);
        const double h = 0.8 * run.stepper.stable_step();
        double fastest = 0;
        for (int i = 0; i < 200; ++i) {
            run.step(h);
            fastest = std::max({fastest, run.last.largest_speed, run.now.obstacles[0].velocity.norm(),
                                run.now.obstacles[1].velocity.norm()});
        }
        check_energy_balance(run);
        // what comes back from a wall in one step may be thrown back at its own speed and no faster, so that its work
        // stays negative
        for (std::size_t o = 0; o < 2; ++o)
            for (Index c = 0; c < run.model.mesh.n_corners(); ++c) {
                const Vec2 x = run.model.mesh.corner(c / 3, c % 3) + run.now.displacement[run.now.node_of_corner[c]];
                const ObstacleSurface surface(run.model.obstacles[o].outline, run.now.obstacles[o].pose);
                CHECK(surface.distance_to(x).gap > -2 * h * fastest);
            }
    }
}

TEST_CASE("a fan that two obstacles squeeze with friction is solved together with them in steps of full size") {
    // one of four hundred such scenes: with friction the fan has two solutions, and for given motions of the obstacles
    // neither balances both
    Run run = random_scene(186);
    const double h = 0.8 * run.stepper.stable_step();
    for (int i = 0; i < 200; ++i) REQUIRE(run.step_if_taken(h));
    check_energy_balance(run);
}

TEST_CASE("obstacles do not depend on the units") {
    for (const std::uint64_t seed : {1, 5, 9}) {
        const double L = 1e-3, T = 1e-6, M = 1e3;
        Run si = random_scene(seed), other = random_scene(seed, L, T, M);
        const double h = 0.8 * si.stepper.stable_step();
        for (int i = 0; i < 60; ++i) si.step(h), other.step(h * T);
        CHECK(si.ledger.largest_energy() > 0);
        for (std::size_t o = 0; o < 2; ++o)
            CHECK((si.now.obstacles[o].velocity.head<2>() - T / L * other.now.obstacles[o].velocity.head<2>()).norm() <=
                  1e-6);
        CHECK(other.ledger.row().kinetic * T * T / (L * L * M) == relative(si.ledger.row().kinetic, 1e-6));
    }
}

TEST_CASE("obstacles give the same bits for one and two threads") {
    const auto end_of = [](int n_threads) {
        omp_set_num_threads(n_threads);
        ModelInput input = block(12, {.sigma_c = 0.5, .G_c = 0.01, .gamma = 1, .friction = 0.3});
        input.obstacles = {boulder({0.55, 1.32}, 0.3, {0.2, -3}, {.friction = 0.3}),
                           platen({0, 0}, {0, 1}, {.friction = 0.5})};
        Run run(input);
        const double h = 0.8 * run.stepper.stable_step();
        for (int i = 0; i < 200; ++i)
            for (double t = 0, part = h; t < h * (1 - 1e-9);)
                if (run.step_if_taken(std::min(part, h - t))) t += part;
                else part *= 0.5, REQUIRE(part > 1e-3 * h);
        omp_set_num_threads(1);
        return run.now;
    };
    const State one = end_of(1), two = end_of(2);
    CHECK(one.split_fans.size() > 20);
    CHECK(same_bits(one, two));
    for (std::size_t o = 0; o < 2; ++o) CHECK(one.obstacles[o].velocity == two.obstacles[o].velocity);
}

}  // namespace obstacles_test
