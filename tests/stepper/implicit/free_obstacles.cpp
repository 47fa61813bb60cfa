// Free obstacles between the body, other obstacles and what is held, in implicit steps and at the start in equilibrium.
#include "support/obstacles.hpp"
#include "support/relative.hpp"
#include "support/springs.hpp"

#include <doctest/doctest.h>

namespace free_obstacles_test {

using namespace knap;
using namespace knap::tests;

namespace {

constexpr double g = 0.5;

void check_energy_balance(const Run& run) { tests::check_energy_balance(run, 1e-10, 1e-12); }

Obstacle box(const Vec2& low, const Vec2& high, double friction) {
    return polygon({low, {high.x(), low.y()}, high, {low.x(), high.y()}}, {.friction = friction});
}
Obstacle free_box(const Vec2& low, const Vec2& high) {
    Obstacle made = box(low, high, 0.5);
    set_free(made, 1);
    return made;
}

/// Of 1 x 1, rho = 1, E = 100, beside or below obstacles.
ModelInput block_with(std::vector<Obstacle> obstacles) {
    ModelInput input = free_block(1, CohesiveLaw::unbreakable());
    input.obstacles = std::move(obstacles);
    input.loads = {load(Load::Kind::acceleration, "", 0.0, -g)};
    return input;
}

}  // namespace

TEST_CASE("stacks of free obstacles beside a body and on it start in equilibrium with their weights") {
    for (const BulkScheme bulk : {BulkScheme::implicit_theta, BulkScheme::explicit_lumped}) {
        CAPTURE(bulk);
        SchemeOptions scheme = implicit();
        scheme.bulk = bulk;
        Run run(block_with({platen({0, 0}, {0, 1}, {.friction = 0.5}), free_box({2, 0}, {4, 0.5}),
                            free_box({2.5, 0.5}, {3.5, 1}), free_box({0.1, 1}, {0.9, 1.5}),
                            free_box({0.3, 1.5}, {0.7, 2})}),
                scheme);
        run.stepper.start_in_equilibrium(run.now);
        const auto check = [&](double accuracy) {
            const auto reaction = [&](std::size_t o) { return run.now.obstacles[o].reaction.y(); };
            CHECK(reaction(1) == relative(g * 1.0, accuracy));  // of what is below less that of what is above
            CHECK(reaction(2) == relative(g * 0.5, accuracy));
            CHECK(reaction(3) == relative(g * 0.4, accuracy));
            CHECK(reaction(4) == relative(g * 0.2, accuracy));
            CHECK(reaction(0) == relative(-g * (1 + 1.5 + 0.6), accuracy));
        };
        check(1e-9);
        run.ledger = EnergyLedger(run.model, run.now);
        const double energy = run.ledger.row().strain;
        const double h = bulk == BulkScheme::implicit_theta ? 0.05 : 0.8 * run.stepper.stable_step();
        double fastest = 0;
        for (int i = 0; i < 80; ++i) {
            run.step(h);
            fastest = std::max(fastest, run.last.kinetic);
        }
        CHECK(fastest <= 1e-14 * energy);
        check(1e-7);
        check_energy_balance(run);
    }
}

TEST_CASE("a heap that nothing holds is refused with its obstacle and its acceleration") {
    // without friction a disc between two others pushes them apart
    Run run(block_with({platen({0, 0}, {0, 1}), boulder({2.5, 0.5}, 0.5, {0, 0}), boulder({3.5, 0.5}, 0.5, {0, 0}),
                        boulder({3, 0.5 + std::sqrt(0.75)}, 0.5, {0, 0})}),
            implicit());
    CHECK_THROWS_WITH_AS(run.stepper.start_in_equilibrium(run.now),
                         doctest::Contains("nothing holds the free obstacle `boulder`"), SimulationError);
}

TEST_CASE("a lever on a block balances a ball or falls with it and is refused") {
    // the pivot lies in the middle of a lever of 4; a box pushes it onto the block, or off it
    for (const double at : {-0.5, 2.5}) {
        CAPTURE(at);
        Obstacle lever = box({-1, 1}, {3, 1.1}, 0.5);
        lever.drive[2].kind = Drive::Kind::free, lever.mass = lever.inertia = 1;
        Run run(block_with({platen({0, 0}, {0, 1}, {.friction = 0.5}), std::move(lever),
                            free_box({at - 0.2, 1.1}, {at + 0.2, 1.5})}),
                implicit());
        const auto start = [&] { run.stepper.start_in_equilibrium(run.now); };
        if (at > 0) {
            CHECK_THROWS_WITH_AS(start(), doctest::Contains("no equilibrium"), SimulationError);
            continue;
        }
        start();
        const double weight = g * 0.16;
        CHECK(run.now.obstacles[2].reaction.y() == relative(weight, 1e-9));
        CHECK(std::abs(run.now.obstacles[1].reaction.z()) < 1e-9);
        // the block lies between 0 and 1 from the pivot, the box 1.5
        CHECK(run.now.obstacles[0].reaction.y() < -g - 1.49 * weight);
    }
}

TEST_CASE("a free obstacle between a driven one and a block passes the pressure on") {
    const double strain = 1e-3, modulus = 100 / (1 - 0.2 * 0.2);
    ModelInput input =
        block_with({platen({0, 0}, {0, 1}), box({-0.5, 1.5}, {1.5, 2}, 0), box({-0.5, 1}, {1.5, 1.5}, 0)});
    input.loads.clear();
    set_free(input.obstacles[2], 0.01);  // far lighter than the block
    input.obstacles[1].drive[1] = {.kind = Drive::Kind::displacement, .value = -strain};
    Run run(input, implicit());
    run.stepper.start_in_equilibrium(run.now);
    // gaps below 1e-12 of the places count as closed: 2e-9 of the strain
    CHECK(run.now.obstacles[1].reaction.y() == relative(modulus * strain, 1e-8));
    CHECK(run.now.obstacles[0].reaction.y() == relative(-modulus * strain, 1e-8));
    CHECK(std::abs(run.now.obstacles[2].reaction.y()) < 1e-12);
    run.ledger = EnergyLedger(run.model, run.now);
    for (int i = 0; i < 20; ++i) run.step(1e-2);
    CHECK(run.now.obstacles[1].reaction.y() == relative(modulus * strain, 1e-6));
    check_energy_balance(run);
}

TEST_CASE("a block that is driven upwards lifts a free disc and feels its weight") {
    // all of it is held, so that no part of it gives way
    for (const double mu : {0.0, 0.5}) {
        CAPTURE(mu);
        ModelInput input = block_with({boulder({0.4, 1.2}, 0.2, {0, 0}, {.friction = mu})});
        input.loads = {load(Load::Kind::velocity, "", 0.0, 2.0)};
        input.obstacles[0].forces = {{.value = Vec3(0, -3, 0), .history = {}}};  // its mass is 1
        Run run(input, implicit(0.5));
        const double h = 1e-2;
        run.step(h);
        CHECK(run.now.obstacles[0].velocity.y() == relative(2, 1e-12));
        CHECK(run.now.obstacles[0].reaction.y() == relative(3 + 2 / h, 1e-9));  // and what lifts it at once
        for (int i = 0; i < 10; ++i) run.step(h);
        CHECK(run.now.obstacles[0].reaction.y() == relative(3, 1e-9));
        Vec2 sum = Vec2::Zero();
        for (const Vec2& reaction : run.now.reaction) sum += reaction;
        CHECK(sum.y() == relative(3, 1e-9));
        check_energy_balance(run);
    }
}

TEST_CASE("a disc rolls on a strip that is held everywhere as down an incline of a rigid slope") {
    const double h = 1e-3, pull = 0.6, radius = 0.2;
    for (const double mu : {1.0, 0.05}) {
        CAPTURE(mu);
        ModelInput input = block_with({boulder({0.4, 1 + radius}, radius, {0, 0}, {.friction = mu})});
        input.loads = {load(Load::Kind::displacement, "", 0.0, 0.0)};
        input.obstacles[0].forces = {{.value = Vec3(pull, -3, 0), .history = {}}};
        Run run(input, implicit(0.5));
        for (int i = 0; i < 200; ++i) run.step(h);
        const double t = 200 * h, rolling = 2.0 / 3 * pull * t;
        CHECK(run.now.obstacles[0].velocity.x() == relative(mu > 0.1 ? rolling : (pull - mu * 3) * t, 1e-3));
        CHECK(-run.now.obstacles[0].velocity.z() * radius == relative(mu > 0.1 ? rolling : 2 * mu * 3 * t, 1e-3));
        check_energy_balance(run);
    }
}

TEST_CASE("a block rests on two narrow platens between its nodes with half of its weight on each") {
    for (const BulkScheme bulk : {BulkScheme::implicit_theta, BulkScheme::explicit_lumped}) {
        CAPTURE(bulk);
        SchemeOptions scheme = implicit();
        scheme.bulk = bulk;
        Run run(block_with({box({0.1, -0.5}, {0.15, 0}, 0.3), box({0.85, -0.5}, {0.9, 0}, 0.3)}), scheme);
        run.stepper.start_in_equilibrium(run.now);
        for (const std::size_t o : {0, 1}) CHECK(run.now.obstacles[o].reaction.y() == relative(-0.5 * g, 1e-3));
        CHECK(run.now.obstacles[0].reaction.y() + run.now.obstacles[1].reaction.y() == relative(-g, 1e-9));
        run.ledger = EnergyLedger(run.model, run.now);
        const double h = bulk == BulkScheme::implicit_theta ? 0.05 : 0.8 * run.stepper.stable_step();
        for (int i = 0; i < 40; ++i) run.step(h);
        CHECK(run.now.obstacles[0].reaction.y() + run.now.obstacles[1].reaction.y() == relative(-g, 1e-7));
        check_energy_balance(run);
    }
}

}  // namespace free_obstacles_test
