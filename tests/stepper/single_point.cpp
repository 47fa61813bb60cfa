// Exact one-point cases: imposed motion (A1, A3, A5), the strength polygon (A6), one mass under constant force (B1), a
// bouncing ball (B13). All go through the whole stepper: a triangle without stiffness on a support is a set of point
// masses on cohesive points.
#include "support/bodies.hpp"
#include "support/paths.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace single_point_test {

using namespace knap;
using namespace knap::tests;

TEST_CASE("A1 mode I cycle under imposed opening") {
    describe(
        "One interface point with sigma_c = .5, delta_c = 1 is opened to u_N = .5 (t = 1), closed (t = 2) and opened "
        "again until it breaks (t = 4). Reference: the law, by hand; "
        "Psi = beta sigma_c u_N + G_c (1 - beta)^2.");
    const CohesiveLaw law{.sigma_c = 0.5, .G_c = 0.25, .gamma = 1};
    for (const SchemeOptions& path : all_paths()) {
        on_path(path);
        ModelInput input = point_masses(law, true);
        // comes back to 0; the published case holds it there by contact, here the motion is imposed and never
        // penetrates
        input.loads = {load(Load::Kind::displacement, "base", 0.0, 1.0, {{0, 1, 2, 3, 5}, {0, 0.5, 0, 0.5, 1.5}})};
        Run run(input, path);
        const int n =
            1024;  // a power of two: times and ways add up without rounding, and what is left is the error of the law
        const double h = 1.0 / n;
        const auto beta = [&] { return cohesion(run.model, run.now, 0); };
        const auto psi = [&] { return law.surface_energy(beta(), opening(run.model, run.now, 0).x(), 0); };
        const auto go_on = [&] {
            for (int i = 0; i < n; ++i) run.step(h);
        };
        go_on();
        verify("beta at t = 1", beta(), 0.5, {1e-12});
        verify("Psi at t = 1", psi(), 0.1875, {1e-12});
        go_on();
        verify("beta at t = 2", beta(), 0.5, {1e-12});
        verify("Psi at t = 2", psi(), 0.0625, {1e-12});
        go_on();
        verify("Psi at t = 3", psi(), 0.1875, {1e-12});
        go_on();
        verify_small("beta at t = 4", beta(), {1e-12});
        verify("Psi at t = 4 is G_c", psi(), law.G_c, {1e-12});
        // the work of the forces follows the energy of the state up to the lag of the explicit cohesion, first order in
        // h
        CHECK(std::abs(run.ledger.row().law_lag) < 2 * h * 2 * law.G_c);
        CHECK(run.ledger.largest_residual() < 1e-12 * run.ledger.largest_energy());
    }
}

// The contact balances the cohesion, p = beta sigma_c, so that friction takes mu G_c/gamma; a pressure p_0 adds
// mu p_0 u_T to the friction work, and nothing to that part.
TEST_CASE("sliding costs G_c (1 + friction/gamma) and the second part of it has no contact pressure") {
    const CohesiveLaw law{.sigma_c = 1, .G_c = 1, .gamma = 2, .friction = 0.5};  // breaks at u_T = delta_c/gamma = 1
    for (const SchemeOptions& path : all_paths())
        for (const double pressure : {0.0, 0.3}) {
            CAPTURE(pressure);
            ModelInput input = point_masses(law, true);  // two points of area 1
            input.loads = {load(Load::Kind::displacement, "base", 1.0, std::nullopt, {{0, 1, 2}, {0, 1.2, 2.4}}),
                           load(Load::Kind::body_force, "", 0.0, -3 * pressure)};
            Run run(input, path);
            for (int i = 0; i < 1024; ++i) run.step(1.0 / 1024);
            REQUIRE(cohesion(run.model, run.now, 0) == 0);
            const EnergyRow& row = run.ledger.row();
            CHECK(row.dissipated == relative(2, 1e-12));
            CHECK(row.cohesive_work == relative(2, 0.002));  // the law lag of the last step
            CHECK(row.cohesive_friction_work == relative(-0.25 * row.cohesive_work, 1e-9));
            const double slid = opening(run.model, run.now, 0).y(), on_pressure = 2 * 0.5 * pressure * std::abs(slid);
            CHECK(row.friction_work == relative(row.cohesive_friction_work - on_pressure, 0.002));
            CHECK(std::abs(row.residual) < 1e-12 * run.ledger.largest_energy());
        }
}

TEST_CASE("A3 mode II with friction under imposed slip and constant pressure") {
    on_path(both_explicit);
    const CohesiveLaw law{.sigma_c = 0.5, .G_c = 0.25, .gamma = 1, .friction = 0.5};
    ModelInput input = point_masses(law, true);
    input.loads = {
        load(Load::Kind::displacement, "base", 1.0, std::nullopt, {{0, 1, 2, 6}, {0, 0.5, 0, -2}}),
        load(Load::Kind::body_force, "", 0.0, -3.0)};  // area 1 shared by three corners: a force of -1 on each
    Run run(input);
    const int n = 2000;
    const double h = 1.0 / n;
    const auto at = [&](int until) {
        while (run.now.n_steps < static_cast<std::int64_t>(until) * n) run.step(h);
        return std::pair{cohesion(run.model, run.now, 0), run.now.points[0].traction};
    };
    run.step(h);
    // r_N is the applied pressure; friction sees the cohesive pressure on top: (gamma + mu) sigma_c + mu r_N at the
    // first slip
    verify("r_N at the first slip", run.now.points[0].traction.x(), 1, {1e-12});
    verify("|r_T| at the first slip", std::abs(run.now.points[0].traction.y()), 0.5 + 0.5 * (1 + 0.5), {1e-12});
    const auto [beta1, r1] = at(1);
    verify("beta at t = 1", beta1, 0.5, {1e-12});
    const auto [beta2, r2] = at(2);
    verify("beta at t = 2", beta2, 0.5, {1e-12});
    verify_that("friction turns with the slip", r1.y() * r2.y() < 0);
    const auto [beta6, r6] = at(6);
    verify_small("beta at t = 6", beta6, {1e-12});
    verify("|r_T| at t = 6 is mu r_N", std::abs(r6.y()), 0.5, {1e-12});
    CHECK(run.now.points.size() == 2);
    // two points of area 1 each: surface energy G_c each, and friction work -mu (r_N |slip| + int beta sigma_c d|slip|)
    verify("surface energy over G_c", run.ledger.row().dissipated / (2 * law.G_c), 1, {1e-12});
    verify_at_most("largest friction work of a step", run.ledger.worst().worst_friction_work, 0);
}

TEST_CASE("A5 mixed mode breaks at its own opening and always dissipates G_c") {
    describe(
        "One point is driven along u_N = a s, u_T = (1 - a) s at 11 mixities a and gamma = 0, .5, 2. It breaks at s = "
        "delta_c/(a + gamma (1 - a)), having spent G_c. Also sheared "
        "then opened, and opened, closed, sheared.");
    for (const SchemeOptions& path : all_paths()) {
        on_path(path);
        double worst_beta = 0, worst_energy = 0;
        bool all_break = true;
        for (const double gamma : {0.0, 0.5, 2.0})
            for (int i = 0; i <= 10; ++i) {
                const double a = i / 10.0, reach = a + gamma * (1 - a);
                if (reach == 0) continue;
                const CohesiveLaw law{.sigma_c = 0.5, .G_c = 0.25, .gamma = gamma};
                ModelInput input = point_masses(law, true);
                const double breaks = law.delta_c() / reach;
                input.loads = {load(Load::Kind::displacement, "base", 1 - a, a, {{0, 1}, {0, 2 * breaks}})};
                Run run(input, path);
                for (int k = 0; k < 499; ++k) run.step(1e-3);
                worst_beta = std::max(worst_beta, std::abs(cohesion(run.model, run.now, 0) - 0.002));
                run.step(1e-3);
                run.step(1e-3);
                all_break = all_break && cohesion(run.model, run.now, 0) == 0;
                worst_energy = std::max(worst_energy, std::abs(run.ledger.row().dissipated / (2 * law.G_c) - 1));
            }
        verify_small("error of beta shortly before it breaks, worst of all", worst_beta, {1e-12});
        verify_that("broken at the exact opening, all", all_break);
        verify_small("error of G/G_c when broken, worst of all", worst_energy, {1e-12});

        // other ways to the same end: u_T first and then u_N; u_N half way, back to 0, then u_T
        const TimeFunction up_later{{1, 2}, {0, 1}}, up_first{{0, 1}, {0, 0.5}}, there_and_back{{0, 1, 2}, {0, 0.5, 0}},
            shear_later{{2, 4}, {0, 2}};
        double worst_way = 0;
        for (const bool shear_first : {true, false}) {
            const CohesiveLaw law{.sigma_c = 0.5, .G_c = 0.25, .gamma = 1};
            ModelInput input = point_masses(law, true);
            input.loads = {
                load(Load::Kind::displacement, "base", 1.0, std::nullopt, shear_first ? up_first : shear_later),
                load(Load::Kind::displacement, "base", std::nullopt, 1.0, shear_first ? up_later : there_and_back)};
            Run run(input, path);
            for (int k = 0; k < 4000; ++k) run.step(1e-3);
            worst_way = std::max(
                worst_way, std::abs(run.ledger.row().dissipated / (2 * law.G_c) - 1) + cohesion(run.model, run.now, 0));
        }
        verify_small("error of G/G_c, sheared then opened and opened, closed, sheared", worst_way, {1e-12});
    }
}

TEST_CASE("A6 an intact point starts to move exactly on its strength polygon") {
    describe(
        "One point with sigma_c = 2, gamma = .7, mu = .4 under a force in 36 directions. It holds up to f_N = sigma_c "
        "and |f_T| = (gamma + mu) sigma_c - mu f_N: at 1 - 1e-9 of "
        "that it rests, at 1 + 1e-6 it moves.");
    const CohesiveLaw law{.sigma_c = 2, .G_c = 1, .gamma = 0.7, .friction = 0.4};
    for (const SchemeOptions& path : all_paths()) {
        on_path(path);
        int n_right = 0;
        for (int i = 0; i < 36; ++i) {
            const double angle = 2 * M_PI * i / 36;
            const Vec2 direction(std::cos(angle),
                                 std::sin(angle));  // of the force on the body: (tangential, normal) = (x, y)
            const double shear = std::abs(direction.x()) + law.friction * direction.y();
            double strength = 1e3;
            if (direction.y() > 1e-12) strength = law.sigma_c / direction.y();
            if (shear > 1e-12) strength = std::min(strength, (law.gamma + law.friction) * law.sigma_c / shear);
            bool right = true;
            for (const double factor : {1 - 1e-9, 1 + 1e-6}) {
                ModelInput input = point_masses(law, true);
                const Vec2 force = 3 * factor * strength * direction;
                input.loads = {load(Load::Kind::body_force, "", force.x(), force.y())};
                Run run(input, path);
                for (int k = 0; k < 3; ++k) run.step(0.1);
                const bool moved = run.v(0, 0).norm() > 0, should = factor > 1 && strength < 1e3;
                CHECK_MESSAGE(moved == should, "direction ", i * 10, " degrees, factor ", factor, ", speed ",
                              run.v(0, 0).norm());
                right = right && moved == should;
            }
            n_right += right;
        }
        verify("directions of 36 that start exactly there", n_right, 36, {1e-12});
    }
}

TEST_CASE("B1 one mass under constant force follows the exact recursion of the scheme") {
    // central differences with beta_n = 1 - u_n/delta in the force: u_{n+1} - 2 u_n + u_{n-1} = h^2 kappa^2 (A + u_n),
    // and a first kick of h/2 gives u_1 = h^2 kappa^2 A/2:   u_n = A (cosh(n a) - 1), a = 2 asinh(h kappa/2), A = (F -
    // sigma_c S) delta/(sigma_c S)
    on_path(both_explicit);
    describe(
        "m = sigma_c = delta_c = S = 1, F = 1.5, from rest: u_n = A (cosh(n a) - 1) exactly, A = (F - sigma_c) "
        "delta_c/sigma_c, with a = 2 asinh(h kappa/2) for central differences "
        "and a = 2 artanh(h kappa/2) for the trapezoidal rule; in the limit it breaks at t = 1.76274717 with v = sqrt "
        "2. E5 is the step that breaks.");
    const CohesiveLaw law{.sigma_c = 1, .G_c = 0.5};
    double previous = 0, previous_h = 0;
    for (const double h : {0.1, 0.05, 0.025, 0.0123}) {
        ModelInput input = point_masses(law, true);
        input.loads = {load(Load::Kind::body_force, "", 0.0, 3 * 1.5)};
        Run run(input);
        const double A = 0.5, a = 2 * std::asinh(h / 2);
        double worst = 0;
        while (cohesion(run.model, run.now, 0) > 0) {
            run.step(h);
            const double exact =
                2 * A * std::pow(std::sinh(0.5 * a * static_cast<double>(run.now.n_steps)), 2);  // without cancellation
            worst = std::max(worst, std::abs(run.u(0, 0).y() / exact - 1));
        }
        const std::string at = ", h = " + digits(h);
        verify_small("relative error of u_n, worst of all steps" + at, worst, {1e-12});
        verify_small("energy residual" + at, run.ledger.largest_residual() / run.ledger.largest_energy(), {1e-13});
        CHECK(run.ledger.worst().largest_beta_growth == 0);
        verify("G/G_c" + at, run.ledger.row().surface() / (2 * law.G_c), 1, {1e-12});
        // order 2: the exact continuous motion A (cosh t - 1) at a fixed time inside the softening
        const int n = static_cast<int>(std::floor(1.5 / h));
        const double error = std::abs(std::cosh(n * a) - std::cosh(n * h)) / std::sinh(n * h) / (n * h);
        if (previous > 0)
            verify_near("order of u(1.5)" + at, std::log(error / previous) / std::log(h / previous_h), 2, {0.05});
        previous = error, previous_h = h;
    }
}

TEST_CASE("B13 a ball with restitution .8 comes to rest at its Zeno time") {
    describe(
        "A point mass falls by 1 under g = 9.81 and bounces with e = .8: infinitely many impacts until t = sqrt(2/g) "
        "(1 + e)/(1 - e) = 4.0637128, then rest. h = 1e-4.");
    for (SchemeOptions path : both_paths()) {
        on_path(path);
        const CohesiveLaw law{.sigma_c = 0, .restitution = 0.8};
        ModelInput input = point_masses(law, false);
        input.supports[0].gap = 1;
        input.loads = {load(Load::Kind::acceleration, "", 0.0, -9.81)};
        Run run(input, path);
        const double h = 1e-4, zeno = std::sqrt(2 / 9.81) * 9;
        double last_motion = 0, highest = 0, before = 0, tenth = std::sqrt(2 / 9.81);
        for (int k = 1; k < 10; ++k) tenth += 2 * std::pow(0.8, k) * std::sqrt(2 / 9.81);
        int n_impacts = 0;
        while (run.now.time < zeno + 0.1) {
            run.step(h);
            const double v = run.v(0, 0).y();
            if (before < 0 && v > 0 && ++n_impacts == 10)
                verify_near("time of the tenth impact", run.now.time, tenth, {20 * h, 5 * h});
            before = v;
            if (std::abs(v) > 2 * 9.81 * h) last_motion = run.now.time;
            if (run.now.time > 0.5 && run.now.time < 1.2) highest = std::max(highest, 1 + run.u(0, 0).y());
        }
        verify_near("first bounce reaches e^2", highest, 0.64, {1e-3});
        verify_near("last motion faster than 2 g h", last_motion, zeno, {0.01, 0.005});
        const double rest = run.u(0, 0).y();
        double fastest = 0;
        for (int i = 0; i < 1000; ++i) {
            run.step(h);
            fastest = std::max(fastest, std::abs(run.v(0, 0).y()));
        }
        verify_small("largest speed in 1000 steps after that", fastest, {1e-15});
        verify_small("movement in them", run.u(0, 0).y() - rest, {1e-15});
        CHECK(run.ledger.worst().worst_impact_work <= 0);
        verify_small("energy residual after all these steps",
                     run.ledger.largest_residual() / run.ledger.largest_energy(), {1e-10, 1e-11});
    }
}

}  // namespace single_point_test
