// Rigid obstacles with the implicit bulk, and the start in equilibrium between them.
#include "support/obstacles.hpp"
#include "support/relative.hpp"
#include "support/springs.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace obstacles_implicit_test {

using namespace knap;
using namespace knap::tests;

namespace {

void check_energy_balance(const Run& run) { tests::check_energy_balance(run, 1e-10, 1e-12); }

/// A block of 1 x 2 from the origin, which does not break, between two platens.
ModelInput block_between_platens(double friction) {
    ModelInput input;
    input.mesh = bar_mesh(3, 6, 1, 2);
    input.materials = {{.density = 1, .E = 100, .nu = 0.2}};
    input.laws = {CohesiveLaw::unbreakable()};
    input.law_of_pair = {{0}};
    input.obstacles = {platen({0, 0}, {0, 1}, {.friction = friction}), platen({0, 2}, {0, -1}, {.friction = friction})};
    return input;
}

}  // namespace

TEST_CASE("a block pressed between smooth platens carries E' times its strain") {
    const double strain = 1e-3, modulus = 100 / (1 - 0.2 * 0.2);
    for (const BulkScheme bulk : {BulkScheme::implicit_theta, BulkScheme::explicit_lumped}) {
        ModelInput input = block_between_platens(0);
        input.obstacles[1].drive[1] = {.kind = Drive::Kind::displacement, .value = -2 * strain};
        SchemeOptions scheme = implicit();
        scheme.bulk = bulk;
        Run run(input, scheme);
        run.stepper.start_in_equilibrium(run.now);
        CHECK(run.now.obstacles[1].reaction.y() == relative(modulus * strain, 1e-9));
        CHECK(run.now.obstacles[0].reaction.y() == relative(-modulus * strain, 1e-9));
        // and it stays there
        run.ledger = EnergyLedger(run.model, run.now);
        const double energy = 0.5 * modulus * strain * strain * 2;
        CHECK(run.ledger.row().strain == relative(energy, 1e-9));
        for (int i = 0; i < 20; ++i) run.step(1e-2 * std::min(1.0, 50 * run.stepper.stable_step()));
        CHECK(run.ledger.row().kinetic <= 1e-12 * energy);
        CHECK(run.now.obstacles[1].reaction.y() == relative(modulus * strain, 1e-6));
        check_energy_balance(run);
    }
}

TEST_CASE("a guided platen under a force comes to press with it") {
    ModelInput input = block_between_platens(0.3);
    Obstacle& top = input.obstacles[1];
    top.mass = 0.5;
    top.drive[1].kind = Drive::Kind::free;
    top.forces = {{.value = Vec3(0, -0.2, 0), .history = {{0, 20}, {0, 1}}}};
    Run run(input, implicit(1));
    while (run.now.time < 60) run.step(1);  // theta = 1 damps what would ring
    CHECK(run.now.obstacles[1].reaction.y() == relative(0.2, 1e-6));
    CHECK(run.now.obstacles[0].reaction.y() == relative(-0.2, 1e-6));
    CHECK(run.now.obstacles[1].moved.y() < -0.2 * 2 / 110);
    check_energy_balance(run);
}

TEST_CASE("an implicit disc dropped on a point rebounds by the law of Newton") {
    for (const double e : {0.0, 0.4, 1.0}) {
        ModelInput input = point_masses({.sigma_c = 0}, false);
        input.supports.clear();
        input.materials[0].density = 30;                                          // ten times the mass of the disc
        input.obstacles = {boulder({1, 2.5}, 1, {0, -1.5}, {.restitution = e})};  // above the vertex (1, 1)
        Run run(input, implicit());
        double before = 0;
        while (run.v(0, 2).y() == 0) {
            before = run.now.obstacles[0].velocity.y();
            run.step(1e-3);
            REQUIRE(run.now.time < 1);
        }
        for (int i = 0; i < 3; ++i) run.step(1e-3);  // with e = 0 it lands first
        CHECK(run.now.obstacles[0].velocity.y() - run.v(0, 2).y() == within(-e * before, 1e-10));
        CHECK(run.now.obstacles[0].velocity.y() + 10 * run.v(0, 2).y() == relative(-1.5, 1e-12));
        CHECK(run.ledger.row().impact_work == within(-0.5 * 10 / 11.0 * 2.25 * (1 - e * e), 1e-10));
        check_energy_balance(run);
    }
}

namespace {

/// Momentum of body and free obstacles, and the moment of momentum about the origin.
Vec3 momentum(const Run& run) {
    Vec3 sum = Vec3::Zero();
    for (Index c = 0; c < run.model.mesh.n_corners(); ++c) {
        const Index node = run.now.node_of_corner[c];
        sum += wrench_of(run.model.corner_mass[c] * run.now.velocity[node],
                         run.model.mesh.corner(c) + run.now.displacement[node]);
    }
    for (std::size_t o = 0; o < run.model.obstacles.size(); ++o) {
        const Obstacle& obstacle = run.model.obstacles[o];
        if (!obstacle.is_free()) continue;
        const ObstacleState& state = run.now.obstacles[o];
        sum += wrench_of(obstacle.mass * state.velocity.head<2>(), state.pose.position);
        sum.z() += obstacle.inertia * state.velocity.z();
    }
    return sum;
}

/// One step, in halves where it is rejected.
void force_step(Run& run, double h, int depth = 0) {
    if (run.step_if_taken(h)) return;
    REQUIRE(depth < 12);
    force_step(run, h / 2, depth + 1);
    force_step(run, h / 2, depth + 1);
}

}  // namespace

TEST_CASE("an implicit spinning disc breaks a free block and keeps momentum and energy") {
    for (const int order : {1, 2})
        for (const double e : {0.0, 0.5})
            for (const double mu : {0.0, 0.4}) {
                if (order == 2 && (e == 0 || mu == 0)) continue;  // as dear as all of the first order
                CAPTURE(order);
                CAPTURE(e);
                CAPTURE(mu);
                ModelInput input = free_block(order, {.sigma_c = 0.5, .G_c = 0.01, .gamma = 1, .friction = 0});
                input.obstacles = {boulder({0.55, 1.35}, 0.3, {0.2, -3}, {.friction = mu, .restitution = e})};
                input.obstacles[0].initial_velocity.z() = 10;
                Run run(input, implicit(0.5));
                const Vec3 before = momentum(run);
                for (int i = 0; i < 60; ++i) force_step(run, 5e-3);
                CHECK((momentum(run) - before).head<2>().norm() <= 1e-10 * before.head<2>().norm());
                CHECK(run.now.obstacles[0].velocity.y() > -2.5);  // it met the block
                CHECK(run.now.split_fans.size() > 0);
                CHECK((mu > 0) == (run.ledger.row().friction_work < -1e-6));
                CHECK((mu > 0) == (std::abs(run.now.obstacles[0].velocity.z() - 10) > 0.1));
                check_energy_balance(run);
            }
}

TEST_CASE("the two bulks agree on a boulder and a block the better the smaller the step") {
    // a smooth contact: the boulder lies on the block and is pressed into it; rates of both schemes fall with h
    const auto end_of = [](const SchemeOptions& scheme, double part) {
        ModelInput input = block_between_platens(0.2);
        input.obstacles[1] = polygon({{0.1, 2}, {0.9, 2}, {0.9, 2.5}, {0.1, 2.5}}, {.friction = 0.2});
        set_free(input.obstacles[1], 1);
        TimeFunction push;
        for (int i = 0; i <= 200; ++i)
            push.time.push_back(i * 0.01), push.value.push_back(0.5 - 0.5 * std::cos(M_PI * i * 0.01));
        input.obstacles[1].forces = {{.value = Vec3(0.02, -1, 0), .history = push}};
        Run run(input, scheme);
        const double h = 4e-3 * part;
        for (int i = 0; i < std::lround(1.6 / h); ++i) run.step(h);
        check_energy_balance(run);
        return Vec2(run.now.obstacles[1].moved.x(), run.now.obstacles[1].moved.y());
    };
    const Vec2 exact = end_of({}, 0.125);
    const double coarse = (end_of(implicit(), 2) - exact).norm(), fine = (end_of(implicit(), 0.5) - exact).norm();
    CHECK(exact.y() < -5e-3);
    CHECK(coarse <= 1e-2 * exact.norm());
    CHECK(fine <= 0.4 * coarse);
}

TEST_CASE("a boulder and a block rest on a rough plate with their weight from the first step on") {
    for (const int order : {1, 2})
        for (const BulkScheme bulk : {BulkScheme::implicit_theta, BulkScheme::explicit_lumped}) {
            CAPTURE(order);
            SchemeOptions scheme = implicit();
            scheme.bulk = bulk;
            ModelInput input = block_between_platens(0.5);
            input.mesh.order = order;
            input.obstacles[1] = polygon({{0.1, 2}, {0.9, 2}, {0.9, 2.5}, {0.1, 2.5}}, {.friction = 0.5});
            set_free(input.obstacles[1], 3);
            input.loads = {load(Load::Kind::acceleration, "", 0.0, -0.5)};
            Run run(input, scheme);
            run.stepper.start_in_equilibrium(run.now);
            run.ledger = EnergyLedger(run.model, run.now);
            const double energy = run.ledger.row().strain, stack = 0.5 * (2 + 3 * 0.4);
            CHECK(run.now.obstacles[0].reaction.y() == relative(-stack, 1e-9));
            CHECK(run.now.obstacles[1].reaction.y() == relative(0.5 * 1.2, 1e-9));
            const double h = bulk == BulkScheme::implicit_theta ? 0.05 : 0.8 * run.stepper.stable_step();
            double fastest = 0;
            for (int i = 0; i < 80; ++i) {
                run.step(h);
                fastest = std::max(fastest, run.last.kinetic);
            }
            CHECK(fastest <= 1e-15 * energy);
            CHECK(run.now.obstacles[0].reaction.y() == relative(-stack, 1e-8));
            CHECK(std::abs(run.now.obstacles[1].reaction.z()) <= 1e-8);
            check_energy_balance(run);
        }
}

TEST_CASE("implicit points slide down an inclined platen as Coulomb says") {
    const double g = 9.81, h = 1e-2, angle = 0.5, v0 = 0.1;
    for (const double mu : {0.0, 0.3}) {
        ModelInput input = point_masses({.sigma_c = 0}, false);
        input.supports.clear();
        const Vec2 down(-std::cos(angle), -std::sin(angle)), normal(-std::sin(angle), std::cos(angle));
        for (Vec2& x : input.mesh.vertices) x = -x.x() * down + x.y() * normal + Vec2(3, 7);
        input.obstacles = {platen(Vec2(3, 7), normal, {.friction = mu})};
        input.loads = {load(Load::Kind::acceleration, "", 0.0, -g)};
        input.initial_velocities = {{.on = {}, .value = v0 * down}};
        Run run(input, implicit());
        for (int i = 0; i < 20; ++i) {
            run.step(h);
            CHECK(run.v(0, 0).dot(down) ==
                  relative(v0 + g * (std::sin(angle) - mu * std::cos(angle)) * run.now.time, 1e-9));
        }
        CHECK(run.now.obstacles[0].reaction.head<2>().dot(normal) == relative(-2 * g * std::cos(angle), 1e-9));
        check_energy_balance(run);
    }
}

TEST_CASE("an implicit boulder on an elastic bar is braked as the wave solution says") {
    // as for the explicit bulk: the velocity of the mass falls with exp(-t/tau), tau = M/(rho c A)
    const double v = 1e-3;
    const ModelInput input = boulder_at_bar(100, v);
    const double tau = input.obstacles[0].mass / 0.01;
    Run run(input, implicit(0.55));
    double worst = 0;
    while (run.now.time < 0.9) {
        run.step(0.01);
        if (run.now.time > 0.05)
            worst = std::max(worst, std::abs(run.now.obstacles[0].velocity.x() / v - std::exp(-run.now.time / tau)));
    }
    CHECK(worst < 0.02);
    check_energy_balance(run);
}

}  // namespace obstacles_implicit_test
