// Implicit beta with the explicit bulk: its exact solution, properties that hold in every step, and a running crack.
#include "base/random.hpp"
#include "mesh/triangulate.hpp"
#include "support/bodies.hpp"
#include "support/paths.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace implicit_cohesion_test {

using namespace knap;
using namespace knap::tests;

namespace {

SchemeOptions implicit_cohesion(double theta = 0.5) {
    return {.cohesion = CohesionScheme::implicit_beta, .theta = theta};
}

/// A random mesh of 40 x 20 mm of glass with a crack of 15 mm from the left, pulled apart.
ModelInput pulled_block() {
    Shape shape;
    shape.outer = {.points = {{0, 0}, {0.04, 0}, {0.04, 0.02}, {0, 0.02}}, .boundary = {0, 1, 2, 3}};
    shape.cracks = {{.points = {{0, 0.01}, {0.015, 0.01}}}};
    shape.boundary_names = {"bottom", "right", "top", "left"};
    ModelInput input = body_with(triangulate(shape, {.size = 1.05e-3}), {.density = 2450, .E = 32e9, .nu = 0.2},
                                 {.sigma_c = 8e6, .G_c = 3, .gamma = 1, .friction = 0.5});
    input.thickness = 1e-3;
    input.loads = {load(Load::Kind::traction, "top", 0.0, 4e6), load(Load::Kind::traction, "bottom", 0.0, -4e6)};
    return input;
}

int n_broken(const Run& run) {
    int n = 0;
    for (Index p = 0; p < run.model.n_points(); ++p) n += cohesion(run.model, run.now, p) == 0;
    return n;
}

}  // namespace

TEST_CASE("B1 implicit beta with the explicit bulk solves its difference equation exactly") {
    // u' - 2 u + u_before = h^2 (F - sigma_c (1 - (theta u' + (1 - theta) u)/delta_c)), the first step with half a kick
    for (const double theta : {0.5, 0.75, 1.0}) {
        for (const double h : {0.1, 0.0123}) {
            ModelInput input = point_masses({.sigma_c = 1, .G_c = 0.5}, true);
            input.loads = {load(Load::Kind::body_force, "", 0.0, 3 * 1.5)};
            Run run(input, implicit_cohesion(theta));
            const auto next = [&](double drift, double kick, double u) {  // drift = u + h v
                return (drift + h * kick * (0.5 + (1 - theta) * u)) / (1 - h * kick * theta);
            };
            on_path(implicit_cohesion(theta));
            double before = 0, now = next(0, 0.5 * h, 0), worst = 0;
            for (int i = 0; now < 0.9; ++i) {
                run.step(h);
                worst = std::max(
                    {worst, std::abs(run.u(0, 0).y() - now), std::abs(cohesion(run.model, run.now, 0) - (1 - now))});
                const double after = next(2 * now - before, h, now);
                before = now;
                now = after;
            }
            CHECK(run.now.n_steps > 10);
            verify_small("error of u_n and beta_n against the difference equation, theta = " + digits(theta) +
                             ", h = " + digits(h),
                         worst, {1e-13});
            CHECK(run.ledger.worst().residual <= 1e-13);
            CHECK(run.ledger.largest_residual() <= 1e-14 * run.ledger.largest_energy());
        }
    }
}

TEST_CASE("E9 a point below its strength never breaks where implicit beta has several solutions") {
    // h kappa = 1.5 and more: softening outweighs inertia in the step; the solution that holds is the one that is found
    for (const double h : {1.5, 3.0}) {
        ModelInput input = point_masses({.sigma_c = 1, .G_c = 0.5}, true);
        input.loads = {load(Load::Kind::body_force, "", 0.0, 3 * 0.9)};
        Run run(input, implicit_cohesion(1));
        on_path(implicit_cohesion(1));
        bool holds = true;
        for (int i = 0; i < 100; ++i) {
            run.step(h);
            holds = holds && cohesion(run.model, run.now, 0) == 1 && run.u(0, 0) == Vec2(0, 0);
        }
        verify_that("intact and at rest for 100 steps of h kappa = " + digits(h) + " at .9 of the strength", holds);
    }
}

TEST_CASE("a crack runs with implicit beta and the explicit bulk and the energy balance closes") {
    const auto run_to = [](Run& run, double safety) {
        const double h = safety * run.stepper.stable_step();
        while (run.now.time < 20e-6) run.step(h);
        const StepReport& worst = run.ledger.worst();
        const double scale = run.ledger.largest_energy();
        CHECK(n_broken(run) > 20);
        CHECK(run.ledger.largest_residual() <= 1e-11 * scale);
        CHECK(worst.worst_friction_work <= 1e-14 * scale);
        CHECK(worst.worst_impact_work <= 1e-14 * scale);
        CHECK(worst.largest_beta_growth == 0);
        CHECK(worst.residual <= 1e-10);
        MESSAGE("steps ", run.now.n_steps, ", broken points ", n_broken(run), ", iterations a fan ",
                static_cast<double>(worst.fan_iterations) / worst.fan_solves, ", law lag over energy ",
                run.ledger.row().law_lag / scale, ", crossing loss ", run.ledger.row().crossing_loss / scale,
                ", residual of the laws ", worst.residual);
    };
    const ModelInput input = pulled_block();
    double last_lag = 0;
    for (const double safety : {0.8, 0.4}) {
        Run frozen(input), half(input, implicit_cohesion()), whole(input, implicit_cohesion(1));
        run_to(frozen, safety);
        run_to(half, safety);
        run_to(whole, safety);
        // the force of beta_theta is that of theta h later: the work is less than the energy of the surfaces, by an
        // amount of first order
        const double lag = half.ledger.row().law_lag;
        CHECK(lag < -2 * std::abs(frozen.ledger.row().law_lag));
        CHECK(whole.ledger.row().law_lag < 1.5 * lag);
        if (last_lag != 0) CHECK(last_lag / lag == relative(2, 0.25));
        last_lag = lag;
    }
}

TEST_CASE("implicit beta with the explicit bulk has the same bits with one thread and with two") {
    std::vector<std::vector<Vec2>> ends;
    for (const int n_threads : {1, 2}) {
        omp_set_num_threads(n_threads);
        Run run(pulled_block(), implicit_cohesion());
        while (run.now.time < 14e-6) run.step(0.8 * run.stepper.stable_step());
        CHECK(n_broken(run) > 0);
        ends.push_back(run.now.displacement);
    }
    omp_set_num_threads(1);
    CHECK(ends[0] == ends[1]);
}

}  // namespace implicit_cohesion_test
