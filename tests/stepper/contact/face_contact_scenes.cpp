// Bodies that meet: momentum, angular momentum and energy of impacts; Coulomb's law on an incline; stacks at rest.
#include "support/obstacles.hpp"
#include "support/several_bodies.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace knap;
using namespace knap::tests;

namespace {

Load everywhere(Load::Kind kind, double x, double y) { return {.kind = kind, .value = {x, y}}; }
Load in_box(Load::Kind kind, const Box& box, double x, double y) {
    return {.kind = kind, .on = {.boundary = "", .box = box}, .value = {x, y}};
}

Vec2 momentum(const Run& run, Index body = -1) {
    Vec2 p = Vec2::Zero();
    for (Index c = 0; c < run.model.mesh.n_corners(); ++c)
        if (body < 0 || run.model.mesh.region[c / 3] == body)
            p += run.model.corner_mass[c] * run.now.velocity[run.now.node_of_corner[c]];
    return p;
}

double mass(const Run& run, Index body) {
    double m = 0;
    for (Index c = 0; c < run.model.mesh.n_corners(); ++c)
        if (run.model.mesh.region[c / 3] == body) m += run.model.corner_mass[c];
    return m;
}

/// About the origin; of central differences, x at the start of the step and v at its middle commute with it up to h v x v.
double angular_momentum(const Run& run) {
    double L = 0;
    for (Index c = 0; c < run.model.mesh.n_corners(); ++c)
        L += run.model.corner_mass[c] *
             cross(run.model.mesh.corner(c) + run.now.displacement_of(c), run.now.velocity[run.now.node_of_corner[c]]);
    return L;
}

double stable(const Run& run) { return run.stepper.stable_step(); }

}  // namespace

TEST_CASE("an oblique impact of two bars keeps momentum and angular momentum and never gains energy") {
    struct Case {
        double friction, restitution, step;
    };
    for (const auto& [friction, restitution, step] :
         {Case{0.5, 0, 0.4}, Case{0.5, 0, 0.8}, Case{0, 0, 0.4}, Case{0, 1, 0.4}, Case{0.5, 0.6, 0.4}}) {
        Bodies bodies;
        bodies.add(bar_mesh(8, 2, 1, 0.25), {0, 0}, 0.3);
        bodies.add(bar_mesh(8, 2, 1, 0.25), {0.4, 0.8}, -0.2);
        ModelInput input = bodies.input({friction, restitution});
        input.initial_velocities = {{.on = {.boundary = "", .box = Box{{-1, -1}, {3, 0.565}}}, .value = {0.3, 1}},
                                    {.on = {.boundary = "", .box = Box{{-1, 0.565}, {3, 3}}}, .value = {-0.3, -1}}};
        Run run(std::move(input));
        const double h = step * stable(run), scale = 2 * mass(run, 0);
        const Vec2 p0 = momentum(run);
        const double L0 = angular_momentum(run), E0 = run.ledger.row().kinetic;
        int n_contacts = 0;
        for (int i = 0; i < 0.4 / h; ++i) {
            run.step(h);
            REQUIRE(run.last.rejection == Rejection::none);
            n_contacts += static_cast<int>(run.now.face_contacts.size());
        }
        CAPTURE(friction);
        CAPTURE(restitution);
        CAPTURE(step);
        CHECK(n_contacts > 20);
        CHECK((momentum(run) - p0).norm() < 1e-13 * scale);
        CHECK(std::abs(angular_momentum(run) - L0) < 1e-13 * scale);
        CHECK(run.ledger.largest_residual() < 1e-13 * run.ledger.largest_energy());
        CHECK(run.ledger.worst().worst_impact_work < 1e-14 * E0);
        CHECK(run.ledger.worst().worst_friction_work < 1e-14 * E0);
        const double energy = (run.ledger.row().kinetic + run.ledger.row().strain) / E0;
        MESSAGE("E/E0 = " << energy << ", deepest over the edge " << run.ledger.worst().penetration / 0.125
                          << " residual " << run.ledger.worst().residual);
        if (friction == 0 && restitution == 1) CHECK(energy == doctest::Approx(1).epsilon(1e-4));
        // with restitution faces must meet first: a step of the approach
        CHECK(run.ledger.worst().penetration < (restitution > 0 ? 3 * h : 1e-3 * 0.125));
        CHECK(run.mean_velocity([&](Index t) { return run.model.mesh.region[t] == 0; }).y() < 0.5);  // they met
    }
}

TEST_CASE("a block slides down a plane by its weight and Coulomb's law") {
    for (const double friction : {0.0, 0.3}) {
        Bodies bodies;
        bodies.add(bar_mesh(20, 1, 6, 0.3), {0, -0.3 - 1e-6});
        bodies.add(bar_mesh(4, 3, 0.8, 0.6), {0.55, 0});
        const double g = 10, phi = M_PI / 6, v0 = 1;
        ModelInput input = bodies.input({friction, 0});

        input.loads = {everywhere(Load::Kind::acceleration, g * std::sin(phi), -g * std::cos(phi)),
                       in_box(Load::Kind::displacement, Box{{-1, -1}, {7, -5e-7}}, 0, 0)};
        input.initial_velocities = {{.on = {.boundary = "", .box = Box{{0, 0}, {9, 9}}}, .value = {v0, 0}}};
        input.materials[0].E = 1e9;
        Run run(std::move(input));
        const double h = 0.8 * stable(run), end = 0.3;
        int n = 0;
        for (; n < end / h; ++n) {
            run.step(h);
            REQUIRE(run.last.rejection == Rejection::none);
        }
        const Vec2 v = momentum(run, 1) / mass(run, 1);
        const double t = (n - 0.5) * h;  // the velocities live at the middle of the steps; the first has k = h/2
        const double exact = v0 + g * std::sin(phi) * t - friction * (g * std::cos(phi) * t + v.y());
        CAPTURE(friction);
        MESSAGE("v " << v.x() << " exact " << exact << " deepest " << run.ledger.worst().penetration);
        CHECK(v.x() == doctest::Approx(exact).epsilon(friction == 0 ? 1e-12 : 2e-3));
        CHECK(run.ledger.largest_residual() < 1e-13 * run.ledger.largest_energy());
        CHECK(run.ledger.row().friction_work <= 0);
        CHECK(run.ledger.worst().penetration < 1e-3 * 0.2);
        CHECK(std::abs(v.y()) < 0.05);
    }
}

TEST_CASE("a free boulder on two blocks that touch keeps momentum and energy") {
    for (const auto& [x, friction] : {std::pair{0.02, 0.0}, std::pair{0.125, 0.0}, std::pair{0.3, 0.3}}) {
        CAPTURE(x);
        Bodies bodies;
        bodies.add(bar_mesh(4, 2, 1, 0.5), {-1, 0});
        bodies.add(bar_mesh(4, 2, 1, 0.5), {0, 0});
        ModelInput input = bodies.input({friction, 0});
        input.obstacles = {boulder({x, 0.5 + 0.2}, 0.2, {0.2, -3}, {.friction = friction})};
        set_free(input.obstacles[0], 400);
        input.initial_velocities = {{.on = {.boundary = "", .box = Box{{-2, -1}, {0, 1}}}, .value = {0.3, 0.1}}};
        Run run(std::move(input));
        const auto total = [&] {
            const Vec2 of_boulder = run.model.obstacles[0].mass * run.now.obstacles[0].velocity.head<2>();
            return Vec2(momentum(run) + of_boulder);
        };
        const Vec2 p0 = total();
        const double h = 0.4 * stable(run);
        int both = 0;  // steps in which blocks and boulder touch: their impulses are found in turns
        for (int i = 0; i < 60; ++i) {
            run.step(h);
            REQUIRE(run.last.rejection == Rejection::none);
            both += run.last.face_contacts > 0 && run.now.obstacles[0].reaction.norm() > 0;
        }
        CHECK(both >= 10);
        CHECK((total() - p0).norm() < 1e-13 * p0.norm());
        CHECK(run.ledger.largest_residual() < 1e-13 * run.ledger.largest_energy());
    }
}

TEST_CASE("a stack of five settled blocks stays at rest") {
    for (const double friction : {0.1, 0.5})
        for (const double restitution : {0.0, 0.5}) {
            Bodies bodies;
            bodies.add(bar_mesh(8, 1, 2, 0.25), {-0.5, -0.25});
            for (int i = 0; i < 5; ++i) bodies.add(bar_mesh(2 + i % 2, 2, 1, 0.5), {0.02 * i, 0.5 * i});
            ModelInput input = bodies.input({friction, restitution});
            input.loads = {everywhere(Load::Kind::acceleration, 0, -10),
                           in_box(Load::Kind::displacement, Box{{-1, -1}, {3, -0.2}}, 0, 0)};
            Run run(std::move(input));
            const double h = 0.8 * stable(run);
            for (int i = 0; i < 30000; ++i) {
                run.step(h);
                REQUIRE(run.last.rejection == Rejection::none);
                for (Vec2& v : run.now.velocity) v *= 0.99;
            }
            const std::vector<Vec2> start = run.now.displacement;
            double moved = 0;
            for (int i = 0; i < 15000; ++i) run.step(h);
            for (std::size_t n = 0; n < start.size(); ++n)
                moved = std::max(moved, (run.now.displacement[n] - start[n]).norm());
            CAPTURE(friction);
            CAPTURE(restitution);
            MESSAGE("moved " << moved << " of 2.5 m, kinetic " << run.last.kinetic);
            CHECK(moved < 1e-12 * 2.5);
        }
}

TEST_CASE("a new stepper goes on from a state of broken pieces in contact with the same bits") {
    Bodies bodies;
    bodies.add(bar_mesh(16, 1, 4, 0.25), {-1.5, -0.25 - 1e-6});
    bodies.add(bar_mesh(8, 8, 1, 1), {0, 0.02}, 0.1);
    ModelInput input = bodies.input({0.5, 0});
    input.laws.push_back({.sigma_c = 1e4, .G_c = 30, .gamma = 1, .friction = 0.5});
    input.law_of_pair[1][1] = 1;
    input.loads = {in_box(Load::Kind::displacement, Box{{-2, -1}, {7, -5e-7}}, 0, 0)};
    input.initial_velocities = {{.on = {.boundary = "", .box = Box{{-3, 0.001}, {9, 9}}}, .value = {0, -10}}};
    Run run(std::move(input));
    const double h = 0.5 * stable(run);
    for (int i = 0; i < 150; ++i)
        for (double part = h; !run.step_if_taken(part); part /= 2) REQUIRE(part > 1e-3 * h);
    CHECK(std::ranges::count(run.now.retired, 1) > 20);
    CHECK(run.now.face_contacts.size() > 10);
    CHECK(run.ledger.largest_residual() < 1e-12 * run.ledger.largest_energy());
    MoreauJean other(run.model, SchemeOptions{});
    State now = run.now, next;
    for (int i = 0; i < 50; ++i) {
        if (!run.step_if_taken(h)) break;
        CHECK(other.step(now, h, next).rejection == Rejection::none);
        std::swap(now, next);
        REQUIRE(same_bits(run.now, now));
    }
}
