// The four pairs of a bulk and a cohesion scheme on the same exact problems: speed of convergence on B1, events of B3.
#include "support/relative.hpp"
#include "support/springs.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdio>
#include <string>

using namespace knap;
using namespace knap::tests;

namespace {

struct Pair {
    std::string name;
    SchemeOptions options;
    double order;  // of convergence: 2 where the cohesion is taken at the moment at which the bulk takes its forces, else 1
};

const std::vector<Pair> pairs = {
    {"explicit bulk, explicit beta", {}, 2},
    {"explicit bulk, implicit beta", {.cohesion = CohesionScheme::implicit_beta}, 1},  // central differences want the force of the begin
    {"implicit bulk, explicit beta", implicit(0.5, CohesionScheme::explicit_beta), 1},
    {"implicit bulk, implicit beta", implicit(), 2},
};

/// u(1.5) of B1: one mass under a constant force, cosh(1.5) - 1 over 2 in the limit.
double opening_of_b1(const SchemeOptions& options, double h) {
    ModelInput input = point_masses({.sigma_c = 1, .G_c = 0.5}, true);
    input.loads = {load(Load::Kind::body_force, "", 0.0, 3 * 1.5)};
    Run run(input, options);
    while (run.now.time < 1.5 - 0.5 * h) {
        run.step(h);
        REQUIRE(run.last.refusal == Refusal::none);
    }
    CHECK(run.ledger.largest_residual() <= 1e-12 * run.ledger.largest_energy());
    return run.u(0, 0).y();
}

/// u(6) of B3: two openings, two impacts, and on the way up the third time; .5845 or so.
double opening_of_b3(const SchemeOptions& options, double h) {
    const SpringBody body{.law = {.sigma_c = 1, .G_c = 0.5, .gamma = 1}, .mass = 2.5, .stiffness = 10};
    ModelInput input = spring_body(body);
    push(input, body.motion, sampled([](double t) { return 1.5 * std::exp(t / 4) * std::sin(M_PI * t); }, h, static_cast<int>(6.5 / h)));
    Run run(input, options);
    while (run.now.time < 6 - 0.5 * h) {
        run.step(h);
        REQUIRE(run.last.refusal == Refusal::none);
    }
    CHECK(run.ledger.largest_residual() <= 1e-12 * run.ledger.largest_energy());
    CHECK(run.ledger.worst().worst_impact_work <= 1e-14 * run.ledger.largest_energy());
    return run.u(0, 0).y();
}

}  // namespace

TEST_CASE("B1 the four pairs of schemes converge with their order") {
    const double exact = 0.5 * (std::cosh(1.5) - 1);
    for (const Pair& pair : pairs) {
        std::string line;
        double previous = 0;
        for (const double h : {0.1, 0.05, 0.025, 0.0125, 0.00625}) {
            const double error = opening_of_b1(pair.options, h) / exact - 1, order = previous != 0 ? std::log2(std::abs(previous / error)) : 0;
            char text[80];
            std::snprintf(text, sizeof text, "  %9.2e (%4.2f)", error, order);
            line += text;
            if (h < 0.02) CHECK(std::abs(order - pair.order) <= 0.05);
            previous = error;
        }
        MESSAGE("B1 error of u(1.5) (order) at h = .1, .05, ..., ", pair.name, ":", line);
    }
}

TEST_CASE("B3 the four pairs of schemes find the same motion") {
    // the reference is the implicit pair at a small step: its events are checked elsewhere against exact ones
    const double reference = opening_of_b3(implicit(), 1.25e-4);
    CHECK(reference == doctest::Approx(0.585).epsilon(0.01));
    for (const Pair& pair : pairs) {
        std::string line;
        for (const double h : {8e-3, 4e-3, 2e-3, 1e-3}) {
            const double error = opening_of_b3(pair.options, h) / reference - 1;
            char text[40];
            std::snprintf(text, sizeof text, "  %9.2e", error);
            line += text;
            CHECK(std::abs(error) <= 5 * h);  // events fall between steps
        }
        MESSAGE("B3 error of u(6) at h = 8e-3, 4e-3, 2e-3, 1e-3, ", pair.name, ":", line);
    }
}
