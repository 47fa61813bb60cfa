// Delayed softening on one point with all pairs of schemes: opened at a constant rate (A1), and Assumption 1 (E9).
// A wave on a bar is in waves.cpp (B6).
#include "support/bodies.hpp"
#include "support/paths.hpp"
#include "support/relative.hpp"
#include "support/softening_shapes.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace delayed_softening_test {

using namespace knap;
using namespace knap::tests;

namespace {

struct Broken {
    double opening, work;  // over delta_c, over G_c
};

/// beta = 1 - x + De (1 - exp(-x/De)), until it is zero.
Broken exact(double De) {
    const auto beta = [&](double x) { return 1 - x - De * std::expm1(-x / De); };
    double low = 1, high = 1 + De;
    for (int i = 0; i < 60; ++i) (beta(0.5 * (low + high)) > 0 ? low : high) = 0.5 * (low + high);
    return {low, 2 * ((1 + De) * low - 0.5 * low * low + De * De * std::expm1(-low / De))};
}

}  // namespace

TEST_CASE("A1 with delayed softening a point that opens at a constant rate costs more the faster it opens") {
    describe(
        "A point with relaxation time tau opens at the rate v until it breaks, De = v tau/delta_c: beta = 1 - x + De "
        "(1 - exp(-x/De)), x = s/delta_c. In steps of h it follows the recursion 1 - x + De (1 - (1 + h/tau)^-n); what "
        "it costs beyond G_c is viscous dissipation.");
    struct Row {
        double De, work, opening;
    };
    for (const SchemeOptions& path : all_paths()) {
        on_path(path);
        // force and cohesion of different times: what the point bears over a step is not what its energies expect
        const bool mixed = path.bulk == BulkScheme::explicit_lumped && path.cohesion == CohesionScheme::implicit_beta;
        for (const Row& row : {Row{0.01, 1.0199, 1.0100}, Row{0.1, 1.1900, 1.1000}, Row{0.3, 1.5124, 1.2960},
                               Row{1, 2.2920, 1.8414}, Row{3, 3.6390, 2.8333}, Row{10, 6.3171, 4.8318}}) {
            const Broken reference = exact(row.De);
            CHECK(reference.work == relative(row.work, 1e-4));
            CHECK(reference.opening == relative(row.opening, 1e-4));
            const CohesiveLaw law{.sigma_c = 0.5, .G_c = 0.25, .relaxation_time = row.De};
            std::array<Broken, 2> found{};
            double worst = 0, viscous = 0;
            for (int refined = 0; refined < 2; ++refined) {
                const double h = reference.opening / (refined ? 4000.5 : 2000.5);
                ModelInput input = point_masses(law, true);
                input.loads = {load(Load::Kind::displacement, "base", 0.0, 1.0, {{0, 10}, {0, 10}})};
                Run run(input, path);
                for (int n = 1; n == 1 || cohesion(run.model, run.now, 0) > 0; ++n) {
                    run.step(h);
                    const double x = n * h, recursion = 1 - x - row.De * std::expm1(-n * std::log1p(h / row.De));
                    worst = std::max(worst, std::abs(cohesion(run.model, run.now, 0) - std::max(0.0, recursion)));
                }
                for (int n = 0; n < 2; ++n) run.step(h);  // the works of the last forces
                const EnergyRow& now = run.ledger.row();
                found[refined] = {run.now.time - 2 * h, now.cohesive_work / (2 * law.G_c)};
                // the first kick of the leapfrog is half of one: its work is half of that of the way
                const double start = path.bulk == BulkScheme::explicit_lumped ? 0.5 * h : 0;
                viscous = (now.cohesive_work - now.viscous_dissipation) / (2 * law.G_c) - 1 + start;
                CHECK(run.ledger.largest_residual() < 1e-12 * run.ledger.largest_energy());
            }
            const std::string at = ", De = " + digits(row.De);
            verify_small("error of beta against the recursion" + at, worst, {1e-12});
            verify("work at break over G_c, two steps extrapolated" + at, 2 * found[1].work - found[0].work,
                   reference.work, {mixed ? 2e-3 : 1e-5});
            verify("opening at break over delta_c" + at, found[1].opening, reference.opening, {3e-3, 1e-3});
            verify_small("work - viscous dissipation - G_c over G_c" + at, viscous, {mixed ? 5e-3 : 1e-12});
        }
    }
}

TEST_CASE("A1 with delayed softening every shape costs G_c and its viscous dissipation") {
    describe(
        "Points with relaxation time .3 delta_c over the rate, opened by half, held, closed and opened until they "
        "break, with constant and secant unloading: they have dissipated G_c and the viscous part.");
    for (const SchemeOptions& path : {both_explicit, both_implicit}) {
        on_path(path);
        for (const Unloading unloading : {Unloading::constant, Unloading::secant}) {
            double largest = 0, lag = 0, least = 1;
            for (const auto& [name, softening] : all_softening_shapes()) {
                const CohesiveLaw law{.sigma_c = 0.5,
                                      .G_c = 0.25,
                                      .softening = softening,
                                      .unloading = unloading,
                                      .relaxation_time = 0.3};
                const double far = 3 * law.delta_c();
                // opened by half, held, closed, opened until it breaks
                ModelInput input = point_masses(law, true);
                input.loads = {load(Load::Kind::displacement, "base", 0.0, 1.0,
                                    {{0, 1, 2, 3, 9}, {0, 0.5 * law.delta_c(), 0.5 * law.delta_c(), 0, far}})};
                Run run(input, path);
                double before = 0, growth = 0;
                for (int n = 0; n < 9000; ++n) {
                    run.step(1e-3);
                    REQUIRE(run.last.rejection == Rejection::none);
                    growth = std::min(growth, run.ledger.row().viscous_dissipation - before);
                    before = run.ledger.row().viscous_dissipation;
                }
                CAPTURE(name);
                CHECK(cohesion(run.model, run.now, 0) == 0);
                CHECK(growth == 0);
                least = std::min(least, before / law.G_c);
                largest = std::max(largest, std::abs(run.ledger.row().dissipated / (2 * law.G_c) - 1));
                lag = std::max(lag, std::abs(run.ledger.row().law_lag) / law.G_c);
                CHECK(run.ledger.largest_residual() < 1e-12 * run.ledger.largest_energy());
            }
            const std::string at = unloading == Unloading::secant ? ", secant" : ", constant";
            verify_small("error of G/G_c at break, worst shape" + at, largest, {1e-12});
            verify_small("law lag over G_c, worst shape" + at, lag, {5e-3});
            verify_at_least("least viscous dissipation of a shape over G_c" + at, least, 0.05);
        }
    }
}

TEST_CASE("E9 delayed softening takes its part of Assumption 1") {
    // h^2 theta^2 S H h/(h + tau) < m with H = 1
    describe(
        "One mass with sigma_c = 1, G_c = .5, theta = 1/2 and a relaxation time: Assumption 1 holds while h^3/(4 (h + "
        "tau)) < 1.");
    on_path(both_implicit);
    for (const double tau : {0.1, 2.0, 50.0}) {
        double low = 2, high = 100;
        for (int i = 0; i < 60; ++i) {
            const double h = 0.5 * (low + high);
            (h * h * h < 4 * (h + tau) ? low : high) = h;
        }
        int n_right = 0;
        for (const double factor : {0.98, 1.02}) {
            ModelInput input = point_masses({.sigma_c = 1, .G_c = 0.5, .relaxation_time = tau}, true);
            input.loads = {load(Load::Kind::body_force, "", 0.0, 3 * 1.02)};
            Run run(input, both_implicit);
            n_right += run.step_if_taken(factor * low) == (factor < 1);
        }
        verify("steps of .98 of the limit that are taken and of 1.02 that are rejected, tau = " + digits(tau), n_right,
               2, {1e-12});
    }
}

}  // namespace delayed_softening_test
