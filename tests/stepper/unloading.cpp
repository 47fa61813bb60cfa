// Secant and vertical unloading on one point: the cycle of A1, a mass that closes, that vibrates on its ramp, that is
// held or thrown at its largest opening, and a block.
#include "support/bodies.hpp"
#include "support/paths.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace unloading_test {

using namespace knap;
using namespace knap::tests;

namespace {

/// Both points of the mass on its support, damaged to beta by linear softening and displaced by u, at rest.
void damage(Run& run, double beta, const Vec2& u) {
    for (PointState& point : run.now.points)
        point.cohesion = beta, point.largest_opening = (1 - beta) * run.model.laws[0].delta_c();
    for (Vec2& displacement : run.now.displacement) displacement = u;
}

CohesiveLaw law_with(Unloading unloading) { return {.sigma_c = 0.5, .G_c = 0.25, .gamma = 1, .unloading = unloading}; }

/// A point that opens to half of delta_c, closes, and opens until it breaks.
ModelInput cycled_point(const CohesiveLaw& law) {
    ModelInput input = point_masses(law, true);
    input.loads = {load(Load::Kind::displacement, "base", 0.0, 1.0, {{0, 1, 2, 3, 5}, {0, 0.5, 0, 0.5, 1.5}})};
    return input;
}

}  // namespace

TEST_CASE("A1 with secant unloading a cycle costs what the envelope encloses") {
    describe(
        "The same cycle with secant unloading: the work of the point is .1875, .125, .1875 and .25 at t = 1 to 4, and "
        "on the ramp (1 < t < 3) it is the change of the elastic energy to rounding.");
    for (const SchemeOptions& path : all_paths()) {
        on_path(path);
        const CohesiveLaw law = law_with(Unloading::secant);
        Run run(cycled_point(law), path);
        constexpr int n = 1024;
        const auto work = [&] {
            const double beta = cohesion(run.model, run.now, 0);
            const double kappa = (1 - beta) * law.delta_c();
            return law.consumed(beta, kappa) + law.elastic_energy(beta, kappa, opening(run.model, run.now, 0).x());
        };
        const auto go_on = [&] {
            for (int i = 0; i < n; ++i) run.step(1.0 / n);
        };
        go_on();
        verify("work at t = 1", work(), 0.1875, {1e-12});
        // with the explicit bulk works end in the middle of a step: those of the first step back turn round
        run.step(1.0 / n), run.step(1.0 / n);
        const double lag = run.ledger.row().law_lag;
        for (int i = 2; i < n - 2; ++i) run.step(1.0 / n);
        verify_small("change of the law lag on the way back", run.ledger.row().law_lag - lag, {1e-14, 1e-15});
        run.step(1.0 / n), run.step(1.0 / n);
        verify("work at t = 2", work(), 0.125, {1e-12});
        // with the explicit bulk kappa is the opening in the middle of a step
        verify("energy consumed at t = 2", run.ledger.row().dissipated, 2 * 0.125,
               {path.bulk == BulkScheme::explicit_lumped ? 0.5 / n : 1e-12});
        verify_small("elastic energy at t = 2", run.ledger.row().interface_elastic, {1.0 / n});
        go_on();
        verify("work at t = 3", work(), 0.1875, {1e-12});
        go_on();
        verify("work at t = 4", work(), 0.25, {1e-12});
        CHECK(cohesion(run.model, run.now, 0) == 0);
        CHECK(std::abs(run.ledger.row().cohesive_work - 0.5) < 4.0 / n);
        CHECK(run.ledger.largest_residual() < 1e-12 * run.ledger.largest_energy());
    }
}

TEST_CASE("A1 with secant unloading inside a plateau a cycle costs what the envelope encloses") {
    describe(
        "Trapezoidal softening with the plateau up to 1/3: opened to .25 (t = 1), closed (2), opened until it breaks. "
        "Work .125, then .0625, at last G_c; beta stays 1 on the plateau.");
    for (const SchemeOptions& path : all_paths()) {
        on_path(path);
        const CohesiveLaw law{.sigma_c = 0.5,
                              .G_c = 0.25,
                              .softening = make_softening({.shape = SofteningOptions::Shape::trapezoid}),
                              .unloading = Unloading::secant};
        ModelInput input = point_masses(law, true);
        input.loads = {load(Load::Kind::displacement, "base", 0.0, 1.0, {{0, 1, 2, 6}, {0, 0.25, 0, 1}})};
        Run run(input, path);
        constexpr int n = 1024;
        const auto go_on = [&](int times) {
            for (int i = 0; i < times * n; ++i) run.step(1.0 / n);
        };
        go_on(1);
        CHECK(cohesion(run.model, run.now, 0) == 1);
        verify_near("work at t = 1", run.ledger.row().cohesive_work / 2, 0.125, {1.0 / n});
        go_on(1);
        verify_near("work at t = 2", run.ledger.row().cohesive_work / 2, 0.0625, {1.0 / n});
        verify_near("energy consumed at t = 2", run.ledger.row().dissipated / 2, 0.0625, {1.0 / n});
        go_on(4);
        CHECK(cohesion(run.model, run.now, 0) == 0);
        verify("energy consumed when broken", run.ledger.row().dissipated / 2, law.G_c, {1e-12});
        CHECK(std::abs(run.ledger.row().law_lag) < 2.0 / n * law.G_c);
        CHECK(run.ledger.largest_residual() < 1e-12 * run.ledger.largest_energy());
    }
}

TEST_CASE("B1 a mass that closes from half its cohesion takes a quarter of a period of its ramp") {
    describe(
        "m = S = 1, released at beta = 1/2: secant unloading closes after (pi/2) sqrt(m/(K S)), K = beta "
        "sigma_c/kappa, "
        "and the impact takes G_c beta (1 - beta) a point; constant unloading after sqrt(2 s m/(beta sigma_c S)), and "
        "twice as much.");
    for (const Unloading unloading : {Unloading::secant, Unloading::constant})
        for (const SchemeOptions& path : both_paths()) {
            on_path(path);
            const CohesiveLaw law = law_with(unloading);
            Run run(point_masses(law, true), path);
            const double beta = 0.5, s = 0.5, h = 1e-3;
            damage(run, beta, {0, s});
            double closes = 0;
            while (closes == 0 || std::abs(run.v(0, 0).y()) > 1e-9) {
                run.step(h);
                REQUIRE(run.last.rejection == Rejection::none);
                REQUIRE(run.now.time < 3);
                if (closes == 0 && run.u(0, 0).y() <= 1e-3) closes = run.now.time;
            }
            const bool secant = unloading == Unloading::secant;
            const double time = secant ? M_PI / 2 * std::sqrt(s / (beta * law.sigma_c))
                                       : std::sqrt(2 * s / (beta * law.sigma_c)),
                         loss = (secant ? 1 : 2) * law.G_c * beta * (1 - beta);
            const std::string at = secant ? ", secant" : ", constant";
            verify_near("closes" + at, closes, time, {5 * h, 2 * h});
            verify("loss of the impacts" + at, -run.ledger.row().impact_work, 2 * loss, {2e-2, 2e-3});
            CHECK(cohesion(run.model, run.now, 0) == beta);
            for (int i = 0; i < 100; ++i) {  // at rest, and with secant unloading without forces
                run.step(h);
                REQUIRE(run.last.rejection == Rejection::none);
            }
        }
}

TEST_CASE("B1 a mass on the ramp of its shear loses what it loses at zero slip whatever the step") {
    describe(
        "A point with gamma = 1 and beta = 1/2 closed in N and displaced by kappa/2 in T: it vibrates with K S = .5, m "
        "= 1 on the ramp, across zero slip. With the explicit bulk its energy and the crossing loss stay together for "
        "K "
        "h^2/m from .01 to 100, with the implicit bulk its energy stays.");
    for (const SchemeOptions& path : both_paths())
        for (const double stiffness : {0.01, 1.0, 100.0}) {
            on_path(path);
            const CohesiveLaw law = law_with(Unloading::secant);
            Run run(point_masses(law, true), path);
            const double h = std::sqrt(stiffness / 0.5);
            // half a kick at the start of the leapfrog: a long first step reaches far beyond the first displacement
            const bool is_explicit = path.bulk == BulkScheme::explicit_lumped;
            damage(run, 0.5, {is_explicit ? 0.05 : 0.25, 0});
            run.step(h);
            const auto total = [&] {
                const EnergyRow& row = run.ledger.row();
                return row.kinetic + row.interface_elastic + row.crossing_loss;
            };
            const double lag = run.ledger.row().law_lag, energy = total();
            double worst = 0, growth = 0, loss = run.ledger.row().crossing_loss;
            int n_crossings = 0;
            for (int i = 0; i < 2000; ++i) {
                const double before = run.u(0, 0).x();
                run.step(h);
                const EnergyRow& row = run.ledger.row();
                worst = std::max({worst, std::abs(total() - energy), std::abs(row.law_lag - lag)});
                growth = std::min(growth, row.crossing_loss - loss), loss = row.crossing_loss;
                n_crossings += before * run.u(0, 0).x() < 0;
            }
            verify_small(
                "change of energy and crossing loss in 2000 steps over the energy, K h^2/m = " + digits(stiffness),
                worst / energy,
                {is_explicit ? 1e-12 * std::max(1.0, stiffness) : 1e-8});  // rounding; tolerance of Newton's method
            if (is_explicit) CHECK(growth >= -1e-12 * std::max(1.0, stiffness) * energy);
            if (!is_explicit) CHECK(std::abs(loss) <= 1e-8 * energy);
            if (is_explicit && stiffness == 0.01)  // each crossing takes its part of the second order
                verify_at_most("crossing loss of 32 periods over the energy, K h^2/m = .01", loss / energy, 0.95);
            CHECK(n_crossings > (is_explicit && stiffness > 0.01 ? 0 : 60));
            CHECK(cohesion(run.model, run.now, 0) == 0.5);
            CHECK(run.ledger.largest_residual() <= (is_explicit ? 1e-12 : 1e-8) * energy);
        }
}

TEST_CASE("A1 with vertical unloading a cycle gives nothing back") {
    describe(
        "The same cycle with vertical unloading: a point has no traction below its largest opening, so its work is "
        ".1875 at t = 1, 2 and 3, all of it dissipated, and .25 at t = 4.");
    for (const SchemeOptions& path : all_paths()) {
        on_path(path);
        const CohesiveLaw law = law_with(Unloading::vertical);
        Run run(cycled_point(law), path);
        constexpr int n = 1024;
        double pull = 0;  // the largest one below the largest opening
        const auto go_on = [&](bool is_below) {
            for (int i = 0; i < n; ++i) {
                run.step(1.0 / n);
                REQUIRE(run.last.rejection == Rejection::none);
                if (is_below && i < n - 1) pull = std::max(pull, std::abs(run.now.points[0].traction.x()));
                CHECK(run.ledger.row().recoverable == 0);
                CHECK(run.ledger.row().interface_elastic == 0);
            }
        };
        go_on(false);
        verify("energy consumed at t = 1", run.ledger.row().dissipated, 2 * 0.1875, {1e-12});
        const double work = run.ledger.row().cohesive_work;
        go_on(true), go_on(true);
        verify("energy consumed at t = 3", run.ledger.row().dissipated, 2 * 0.1875, {1e-12});
        verify_small("traction below the largest opening", pull, {1e-12});
        verify_near("work on the way back and forth", run.ledger.row().cohesive_work, work, {2.0 / n});
        go_on(false);
        verify("energy consumed at t = 4", run.ledger.row().dissipated, 2 * 0.25, {1e-12});
        CHECK(cohesion(run.model, run.now, 0) == 0);
        CHECK(std::abs(run.ledger.row().law_lag + run.ledger.row().crossing_loss) < 3.0 / n);
        CHECK(run.ledger.largest_residual() < 1e-12 * run.ledger.largest_energy());
    }
}

TEST_CASE("B1 with vertical unloading a mass at its largest opening bears any force up to its strength") {
    describe(
        "m = S = 1 at beta = 1/2 and s = kappa, at rest: under a force of .2 it stays, with just this traction; under "
        ".3, above beta sigma_c = .25, it opens at once.");
    for (const SchemeOptions& path : both_paths())
        for (const double force : {0.2, 0.3}) {
            on_path(path);
            const CohesiveLaw law = law_with(Unloading::vertical);
            ModelInput input = point_masses(law, true);
            input.loads = {load(Load::Kind::acceleration, "", 0.0, force)};
            Run run(input, path);
            damage(run, 0.5, {0, 0.5});
            double off = 0, moved = 0;
            for (int i = 0; i < 200; ++i) {
                run.step(1e-2);
                REQUIRE(run.last.rejection == Rejection::none);
                moved = std::max(moved, std::abs(run.u(0, 0).y() - 0.5));
                if (i > 2) off = std::max(off, std::abs(run.now.points[0].traction.x() + force));
            }
            if (force < 0.25) {
                verify_small("traction less the force", off, {1e-9});
                verify_small("way at rest", moved, {1e-8});
                CHECK(cohesion(run.model, run.now, 0) == relative(0.5, 1e-8));
            } else {
                CHECK(moved > 0.05);
            }
        }
}

TEST_CASE("B1 with vertical unloading a mass that closes is free and nothing is given back") {
    describe(
        "m = S = 1 at beta = 1/2 and s = kappa = .5, thrown shut at .1: no traction, so its opening is .5 - .1 t; it "
        "meets "
        "at t = 5 and stays. Explicit and implicit.");
    for (const SchemeOptions& path : both_paths()) {
        on_path(path);
        Run run(point_masses(law_with(Unloading::vertical), true), path);
        damage(run, 0.5, {0, 0.5});
        for (Vec2& velocity : run.now.velocity) velocity = {0, -0.1};
        const double spent = 2 * (0.25 - 0.25 * 0.25), h = 1e-2;  // both points: G_c (1 - beta^2)
        run.ledger = EnergyLedger(run.model, run.now);
        double off = 0;
        for (int i = 1; i <= 700; ++i) {
            run.step(h);
            REQUIRE(run.last.rejection == Rejection::none);
            if (run.now.time < 4.9) off = std::max(off, std::abs(run.u(0, 0).y() - (0.5 - 0.1 * run.now.time)));
            CHECK(run.ledger.row().recoverable == 0);
            CHECK(run.ledger.row().interface_elastic == 0);
        }
        verify_small("way less that of a free mass", off, {1e-12});
        verify("energy dissipated", run.ledger.row().dissipated, spent, {1e-12});
        verify_small("opening after it has met", std::abs(run.u(0, 0).y()), {2e-3});
        CHECK(cohesion(run.model, run.now, 0) == 0.5);
    }
}

TEST_CASE("B1 with vertical unloading a mass thrown open comes to rest where its energy is spent") {
    describe(
        "m = S = 1 at beta = 1/2, closed, is thrown with v^2 = .08: it meets no traction up to s = .5, and rests at s "
        "= "
        ".7, where G_c (.5^2 - .3^2) = v^2/2 is dissipated.");
    for (const SchemeOptions& path : {both_explicit}) {  // implicit: what is held at kappa is thrown back
        on_path(path);
        const CohesiveLaw law = law_with(Unloading::vertical);
        Run run(point_masses(law, true), path);
        damage(run, 0.5, {0, 0});
        for (Vec2& velocity : run.now.velocity) velocity = {0, std::sqrt(0.08)};
        const double h = 1e-3;
        while (run.now.time < 5) {
            run.step(h);
            REQUIRE(run.last.rejection == Rejection::none);
        }
        verify_near("opening at rest", run.u(0, 0).y(), 0.7, {2 * h});
        verify_near("cohesion at rest", cohesion(run.model, run.now, 0), 0.3, {2 * h});
        CHECK(run.ledger.row().recoverable == 0);
    }
}

TEST_CASE("a pulled block breaks with secant and with vertical unloading and its energies balance") {
    for (const Unloading unloading : {Unloading::secant, Unloading::vertical})
        for (const SchemeOptions& path : both_paths()) {
            const CohesiveLaw law{.sigma_c = 8e6, .G_c = 60, .gamma = 1, .friction = 0.5, .unloading = unloading};
            ModelInput input = body_with(bar_mesh(12, 6, 0.04, 0.02), {.density = 2450, .E = 32e9, .nu = 0.2}, law);
            input.thickness = 1e-3;
            input.loads = {load(Load::Kind::traction, "top", 0.0, 8e6, {{0, 5e-6}, {0, 1}}),
                           load(Load::Kind::traction, "bottom", 0.0, -8e6, {{0, 5e-6}, {0, 1}})};
            Run run(input, path);
            const double h = 0.6 * MoreauJean(run.model, both_explicit).stable_step();
            double elastic = 0;
            while (run.now.time < 25e-6) {
                run.step(h);
                REQUIRE(run.last.rejection == Rejection::none);
                elastic = std::max(elastic, run.ledger.row().interface_elastic);
            }
            const double scale = run.ledger.largest_energy();
            if (unloading == Unloading::secant) CHECK(elastic > 1e-6 * scale);
            else CHECK(elastic == 0);
            CHECK(run.ledger.row().recoverable == 0);
            CHECK(run.ledger.row().dissipated > 0);
            CHECK(run.ledger.largest_residual() <= 1e-11 * scale);
            CHECK(run.ledger.worst().residual <= 1e-10);
            CHECK(run.ledger.worst().worst_impact_work <= 1e-14 * scale);
            CHECK(run.ledger.worst().worst_friction_work <= 1e-14 * scale);
            CHECK(run.ledger.worst().largest_beta_growth == 0);
            CHECK(std::abs(run.ledger.row().law_lag) <
                  (path.bulk == BulkScheme::explicit_lumped && unloading == Unloading::secant ? 0.005 : 0.05) *
                      run.ledger.row().dissipated);
            MESSAGE(name_of(unloading), ", ", name_of(path), ": law lag over dissipated ",
                    run.ledger.row().law_lag / run.ledger.row().dissipated, ", crossing loss ",
                    run.ledger.row().crossing_loss / run.ledger.row().dissipated, ", pivots ",
                    run.ledger.worst().fan_fallbacks, " of ", run.ledger.worst().fan_solves);
        }
}

}  // namespace unloading_test
