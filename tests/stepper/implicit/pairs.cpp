// The four pairs of a bulk and a cohesion scheme on the same exact problems: speed of convergence on B1, events of B3.
#include "figures/chart.hpp"
#include "support/paths.hpp"
#include "support/relative.hpp"
#include "support/springs.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <string>

namespace implicit_pairs_test {

using namespace knap;
using namespace knap::tests;

namespace {

struct Pair {
    SchemeOptions options;
    double order;  // of convergence: 2 where the cohesion is taken at the moment at which the bulk takes its forces,
                   // else 1
};

const std::vector<Pair> pairs = {
    {{}, 2},
    {{.cohesion = CohesionScheme::implicit_beta}, 1},  // central differences want the force of the begin
    {implicit(0.5, CohesionScheme::explicit_beta), 1},
    {implicit(), 2},
};

/// u(1.5) of B1: one mass under a constant force, cosh(1.5) - 1 over 2 in the limit.
double opening_of_b1(const SchemeOptions& options, double h) {
    ModelInput input = point_masses({.sigma_c = 1, .G_c = 0.5}, true);
    input.loads = {load(Load::Kind::body_force, "", 0.0, 3 * 1.5)};
    Run run(input, options);
    while (run.now.time < 1.5 - 0.5 * h) {
        run.step(h);
        REQUIRE(run.last.rejection == Rejection::none);
    }
    CHECK(run.ledger.largest_residual() <= 1e-12 * run.ledger.largest_energy());
    return run.u(0, 0).y();
}

/// u(6) of B3: two openings, two impacts, and on the way up the third time; .5845 or so.
double opening_of_b3(const SchemeOptions& options, double h) {
    const SpringBody body{.law = {.sigma_c = 1, .G_c = 0.5, .gamma = 1}, .mass = 2.5, .stiffness = 10};
    ModelInput input = spring_body(body);
    push(input, body.motion,
         sampled([](double t) { return 1.5 * std::exp(t / 4) * std::sin(M_PI * t); }, h, static_cast<int>(6.5 / h)));
    Run run(input, options);
    while (run.now.time < 6 - 0.5 * h) {
        run.step(h);
        REQUIRE(run.last.rejection == Rejection::none);
    }
    CHECK(run.ledger.largest_residual() <= 1e-12 * run.ledger.largest_energy());
    CHECK(run.ledger.worst().worst_impact_work <= 1e-14 * run.ledger.largest_energy());
    return run.u(0, 0).y();
}

}  // namespace

TEST_CASE("B1 the four pairs of schemes converge with their order") {
    describe(
        "u(1.5) at h = .1, .05, ... .00625. The order is 2 where the cohesion is taken at the moment at which the bulk "
        "takes its forces, else 1.");
    const double exact = 0.5 * (std::cosh(1.5) - 1);
    Chart chart{.title = "B1: error of u(1.5)",
                .x_quantity = "step",
                .x_unit = "s",
                .y_quantity = "relative error",
                .y_unit = "",
                .curves = {},
                .levels = {},
                .x_logarithmic = true,
                .y_logarithmic = true};
    for (const Pair& pair : pairs) {
        on_path(pair.options);
        double previous = 0;
        Curve curve{.label = name_of(pair.options),
                    .x = {},
                    .y = {},
                    .colour = curve_colour(chart.curves.size()),
                    .marker = Marker::circle};
        for (const double h : {0.1, 0.05, 0.025, 0.0125, 0.00625}) {
            const double error = opening_of_b1(pair.options, h) / exact - 1,
                         order = previous != 0 ? std::log2(std::abs(previous / error)) : 0;
            curve.x.push_back(h), curve.y.push_back(std::abs(error));
            if (h < 0.02) verify_near("order of u(1.5), h = " + digits(h), order, pair.order, {0.05});
            previous = error;
        }
        verify_small("relative error of u(1.5), h = .00625", previous, {pair.order == 2 ? 2e-4 : 4e-3});
        chart.curves.push_back(curve);
    }
    if (const auto file = picture("B1.png")) draw_chart(chart, *file, 640);
}

TEST_CASE("B3 the four pairs of schemes find the same motion") {
    // the reference is the implicit pair at a small step: its events are checked elsewhere against exact ones
    const double reference = opening_of_b3(implicit(), 1.25e-4);
    CHECK(reference == relative(0.57573, 2e-4));  // by steps of 1e-5 from event to event of the two masses
    for (const Pair& pair : pairs) {
        on_path(pair.options);
        for (const double h : {8e-3, 4e-3, 2e-3, 1e-3})  // events fall between steps
            verify("u_1(6) against both implicit at h = 1.25e-4, h = " + digits(h), opening_of_b3(pair.options, h),
                   reference, {5 * h, h});
    }
}

}  // namespace implicit_pairs_test
