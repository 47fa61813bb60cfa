// Softening shapes on one point with all pairs of schemes: the work at break, one mass that is thrown apart, and
// Assumption 1 by the steepest piece.
#include "support/softening_shapes.hpp"
#include "support/bodies.hpp"
#include "support/paths.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace softening_shapes_test {

using namespace knap;
using namespace knap::tests;

TEST_CASE("A1 opened and closed and opened again points of every softening shape consume what f says") {
    describe(
        "The same cycle with other softening shapes: opened to .3 delta_c (t = 1), closed (2), opened until it breaks. "
        "Consumed: G_c f(B(.3 delta_c)), then G_c.");
    for (const SchemeOptions& path : all_paths()) {
        on_path(path);
        for (const auto& [name, softening] : all_softening_shapes()) {
            const CohesiveLaw law{.sigma_c = 0.5, .G_c = 0.25, .gamma = 1, .softening = softening};
            const double reach = 0.3 * law.delta_c(), b = softening->traction(0.3 * softening->final_opening());
            ModelInput input = point_masses(law, true);
            input.loads = {load(Load::Kind::displacement, "base", 0.0, 1.0, {{0, 1, 2, 6}, {0, reach, 0, 4 * reach}})};
            Run run(input, path);
            constexpr int n = 512;
            const auto go_on = [&](int times) {
                for (int i = 0; i < times * n; ++i) run.step(1.0 / n);
            };
            go_on(2);
            verify("beta, " + name, cohesion(run.model, run.now, 0), b, {1e-12});
            CHECK(run.ledger.row().dissipated / (2 * law.G_c) == within(softening->dissipated(b), 1e-12));
            go_on(4);
            CHECK(cohesion(run.model, run.now, 0) == 0);
            verify("G/G_c at break, " + name, run.ledger.row().dissipated / (2 * law.G_c), 1, {1e-12});
            CHECK(std::abs(run.ledger.row().law_lag) < 30.0 / n * law.G_c);
            CHECK(run.ledger.largest_residual() < 1e-12 * run.ledger.largest_energy());
        }
    }
}

TEST_CASE("A5 every softening shape breaks at its own opening in mixed mode and consumes G_c") {
    for (const SchemeOptions& path : all_paths()) {
        on_path(path);
        double worst = 0;
        bool all_break = true;
        for (const auto& [name, softening] : all_softening_shapes())
            for (const double a : {0.0, 0.3, 1.0}) {
                const CohesiveLaw law{.sigma_c = 0.5, .G_c = 0.25, .gamma = 2, .softening = softening};
                const double breaks = law.delta_c() / (a + law.gamma * (1 - a));
                ModelInput input = point_masses(law, true);
                input.loads = {load(Load::Kind::displacement, "base", 1 - a, a, {{0, 1}, {0, 2 * breaks}})};
                Run run(input, path);
                for (int k = 0; k < 499; ++k) run.step(1e-3);
                all_break = all_break && cohesion(run.model, run.now, 0) > 0;
                for (int k = 0; k < 2; ++k) run.step(1e-3);
                all_break = all_break && cohesion(run.model, run.now, 0) == 0;
                worst = std::max(worst, std::abs(run.ledger.row().dissipated / (2 * law.G_c) - 1));
            }
        verify_that("broken at the exact opening, all softening shapes", all_break);
        verify_small("error of G/G_c when broken, all softening shapes", worst, {1e-12});
    }
}

TEST_CASE("B1 a mass thrown off with too little energy stops where the energy says") {
    describe(
        "A mass m = 1 leaves with v0 = .5 or .9 of the speed v_e, v_e^2 = 2 S G_c/m, that would break the point: it "
        "stops "
        "where the area below the traction is its energy. Linear: s/delta_c = 1 - sqrt(1 - (v0/v_e)^2).");
    constexpr double sigma_c = 1, G_c = 0.5;
    auto shapes = all_softening_shapes();
    shapes.emplace_back("linear", nullptr);
    shapes.emplace_back("Dugdale", make_softening({.shape = SofteningOptions::Shape::trapezoid, .plateau = 1}));
    for (const SchemeOptions& path : all_paths()) {
        on_path(path);
        for (const auto& [name, softening] : shapes)
            for (const double part : {0.5, 0.9}) {
                const CohesiveLaw law{.sigma_c = sigma_c, .G_c = G_c, .softening = softening};
                if (path.cohesion == CohesionScheme::implicit_beta && std::isinf(1 / law.softening_length())) continue;
                ModelInput input = point_masses(law, true);
                input.initial_velocities = {{.on = {}, .value = {0, part * std::sqrt(2 * G_c)}}};
                Run run(input, path);
                constexpr double h = 2e-3;
                double furthest = 0;
                for (double before = -1; run.u(0, 0).y() > before;) {
                    before = run.u(0, 0).y();
                    run.step(h);
                    REQUIRE(run.last.rejection == Rejection::none);
                    furthest = std::max(furthest, run.u(0, 0).y());
                }
                // G_c f(beta) + beta sigma_c s at s is the area below the traction up to s
                double low = 0, high = law.delta_c();
                for (int i = 0; i < 60; ++i) {
                    const double s = 0.5 * (low + high);
                    (law.surface_energy(law.next_cohesion(1, s, 0), s, 0) < part * part * G_c ? low : high) = s;
                }
                if (name == "linear") CHECK(low / law.delta_c() == relative(part == 0.5 ? 0.133975 : 0.564110, 1e-5));
                if (name == "Dugdale") CHECK(low / law.delta_c() == relative(part * part, 1e-9));
                // forces and cohesion of different times: first order
                const bool mixed =
                    (path.bulk == BulkScheme::explicit_lumped) != (path.cohesion == CohesionScheme::explicit_beta);
                verify_near("furthest opening over delta_c, " + name + ", v0/v_e = " + digits(part),
                            furthest / law.delta_c(), low / law.delta_c(), {mixed ? 5e-3 : 1e-3});
            }
    }
}

TEST_CASE("B1 a mass thrown off moves as its softening says at every time") {
    describe(
        "The mass of before, m = S = sigma_c = 1, with .9 of v_e (exponential: v_e, at which it would not stop without "
        "its cut): largest difference to the exact motion until it stops or breaks. Linear: delta_c - s = delta_c "
        "cosh(kappa t) - (v0/kappa) sinh(kappa t), kappa^2 = S sigma_c/(m delta_c); Dugdale: v0 t - S sigma_c "
        "t^2/(2 m); exponential "
        "with the decay d: 2 d ln(1 + v_e t/(2 d)); other shapes: s'' = -B(s) by Runge and Kutta.");
    constexpr double G_c = 0.5, h = 2e-3;
    auto shapes = all_softening_shapes();
    shapes.emplace_back("linear", nullptr);
    shapes.emplace_back("Dugdale", make_softening({.shape = SofteningOptions::Shape::trapezoid, .plateau = 1}));
    for (const SchemeOptions& path : both_paths()) {
        on_path(path);
        for (const auto& [name, softening] : shapes) {
            const CohesiveLaw law{.sigma_c = 1, .G_c = G_c, .softening = softening};
            if (path.cohesion == CohesionScheme::implicit_beta && law.softening_length() == 0) continue;  // refused
            const double v0 = name == "exponential" ? 1 : 0.9, d = 1.048786 * G_c;
            ModelInput input = point_masses(law, true);
            input.initial_velocities = {{.on = {}, .value = {0, v0}}};
            Run run(input, path);
            double s = 0, v = v0, worst = 0, formula = 0;
            const auto pull = [&](double at) { return law.next_cohesion(1, at, 0); };
            for (int n = 0; v > 0 && pull(s) > 0; ++n) {
                run.step(h);
                REQUIRE(run.last.rejection == Rejection::none);
                const double v1 = v - h / 2 * pull(s), v2 = v - h / 2 * pull(s + h / 2 * v),
                             v3 = v - h * pull(s + h / 2 * v1),
                             next = v - h / 6 *
                                            (pull(s) + 2 * pull(s + h / 2 * v) + 2 * pull(s + h / 2 * v1) +
                                             pull(s + h * v2));
                s += h / 6 * (v + 2 * v1 + 2 * v2 + v3), v = next;
                const double t = run.now.time;
                if (v <= 0 || pull(s) <= 0) break;
                // with v_e the speed vanishes where it breaks, and every error grows: up to s = d
                if (name != "exponential" || s < d)
                    worst = std::max(worst, std::abs(run.u(0, 0).y() - s) / law.delta_c());
                const double exact = name == "linear"                 ? 1 - std::cosh(t) + v0 * std::sinh(t)
                                     : name == "Dugdale"              ? v0 * t - 0.5 * t * t
                                     : name == "exponential" && s < d ? 2 * d * std::log1p(v0 * t / (2 * d))
                                                                      : s;
                formula = std::max(formula, std::abs(exact - s) / law.delta_c());
            }
            verify_small("largest error of the opening over delta_c, " + name, worst, {1e-3});
            // the cut and the polygon of the exponential take 1 % of its traction up to s = d
            CHECK_MESSAGE(formula < (name == "exponential" ? 0.01 : 1e-9), name, ": ", formula);
        }
    }
}

TEST_CASE("A3 the work of mode II is G_c for every gamma and friction adds mu over gamma of it") {
    describe(
        "A point without pressure slides until it breaks: r_N = 0, so its sides press on each other with beta sigma_c. "
        "Cohesive work G_c, friction work mu/gamma G_c, for linear softening and Petersson's.");
    for (const SchemeOptions& path : both_paths()) {
        on_path(path);
        for (const bool linear : {true, false})
            for (const double gamma : {0.5, 1.0, 2.0})
                for (const double mu : {0.0, 0.6}) {
                    CohesiveLaw law{.sigma_c = 0.5, .G_c = 0.25, .gamma = gamma, .friction = mu};
                    if (!linear) law.softening = make_softening({.shape = SofteningOptions::Shape::petersson});
                    ModelInput input = point_masses(law, true);
                    input.loads = {load(Load::Kind::displacement, "base", 1.0, std::nullopt,
                                        {{0, 1}, {0, 1.2 * law.delta_c() / gamma}})};
                    Run run(input, path);
                    constexpr int n = 2000;
                    double pressure = 0;
                    for (int i = 0; i < n; ++i) {
                        run.step(1.0 / n);
                        REQUIRE(run.last.rejection == Rejection::none);
                        pressure = std::max(pressure, std::abs(run.now.points[0].traction.x()));
                    }
                    CHECK(cohesion(run.model, run.now, 0) == 0);
                    CHECK(pressure < 1e-9 * law.sigma_c);
                    const EnergyRow& end = run.ledger.row();
                    const std::string at =
                        ", gamma = " + digits(gamma) + ", mu = " + digits(mu) + (linear ? ", linear" : ", petersson");
                    verify("dissipated over G_c" + at, end.dissipated / (2 * law.G_c), 1, {1e-12});
                    // steps of delta_c/1667: the traction of a step is that of its start or of its mean
                    verify("cohesive work over G_c" + at, end.cohesive_work / (2 * law.G_c), 1, {4.0 / n, 2.0 / n});
                    if (mu > 0)
                        verify("friction work over mu/gamma G_c" + at, -end.friction_work / (2 * law.G_c) * gamma / mu,
                               1, {4.0 / n, 2.0 / n});
                    CHECK(run.ledger.largest_residual() < 1e-12 * run.ledger.largest_energy());
                }
    }
}

TEST_CASE("E9 Assumption 1 sees the steepest piece of the softening") {
    // h^2 theta^2 S H < m with H = q sigma_c^2/G_c: h < 2 for linear softening (q = 1/2), 1.549 for Petersson's (5/6)
    describe(
        "One mass with sigma_c = 1, G_c = .5, theta = 1/2: Assumption 1 holds up to h = 1/(theta sqrt(q "
        "sigma_c^2/G_c)).");
    on_path(both_implicit);
    SchemeOptions scheme = both_implicit;
    scheme.respect_assumption_1 = true;
    for (const auto& [name, softening] : all_softening_shapes()) {
        const CohesiveLaw law{.sigma_c = 1, .G_c = 0.5, .softening = softening};
        const double limit = 2 / std::sqrt(softening->steepest() / 0.5);
        int n_tried = 0, n_right = 0;
        for (const double factor : {0.98, 1.02})
            for (const double force : {1.2, 3.0}) {  // it softens in the step, or breaks
                ModelInput input = point_masses(law, true);
                input.loads = {load(Load::Kind::body_force, "", 0.0, 3 * force)};
                Run run(input, scheme);
                const bool taken = run.step_if_taken(factor * limit);
                const bool stays_on_plateau = taken && cohesion(run.model, run.now, 0) == 1;
                if (stays_on_plateau) continue;
                ++n_tried;
                n_right += taken == (factor < 1);
                CHECK_MESSAGE(taken == (factor < 1), name, ", factor ", factor, ", force ", force);
            }
        CHECK(n_tried > 0);
        verify("steps of .98 of the limit that are taken and of 1.02 that are rejected, " + name, n_right, n_tried,
               {1e-12});
    }
}

}  // namespace softening_shapes_test
