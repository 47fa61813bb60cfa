// Incubated strength: the utilisation of a fan, and two triangles that are pulled apart by a force that grows.
#include "stepper/explicit/incubation.hpp"
#include "analysis/energy_ledger.hpp"
#include "law/self_stress.hpp"
#include "mesh/triangulate.hpp"
#include "model/make_model.hpp"
#include "stepper/common/bond_check.hpp"
#include "support/bodies.hpp"
#include "support/paths.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

namespace incubation_test {

using namespace knap;
using namespace knap::tests;

namespace {

/// Two triangles without stiffness on both sides of an edge of length 2, with two points of area 1.
ModelInput pair_of_triangles(const CohesiveLaw& law) {
    ModelInput input;
    input.mesh.vertices = {{0, 0}, {2, 0}, {1, 1}, {1, -1}};
    input.mesh.triangles = {{0, 1, 2}, {0, 3, 1}};
    input.mesh.region = {0, 0};
    input.mesh.boundary_names = {"upper", "lower"};
    find_edges(input.mesh);
    for (BoundaryEdge& edge : input.mesh.boundary_edges) edge.boundary = edge.triangle;
    input.materials = {{.density = 3, .E = 0, .nu = 0}};
    input.laws = {law};
    input.law_of_pair = {{0}};
    return input;
}

/// [-] phi - R (1 - exp(-phi/R)) = 1.
double factor_of_ramp(double R) {
    double low = 1, high = 1 + R;
    for (int i = 0; i < 60; ++i) {
        const double phi = 0.5 * (low + high);
        (phi + R * std::expm1(-phi / R) < 1 ? low : high) = phi;
    }
    return low;
}

}  // namespace

TEST_CASE("A6 an incubated strength grows with the rate of the load") {
    describe(
        "Two triangles are pulled apart by a force of R t/tau times the strength of their edge: its points split at "
        "phi, phi - R (1 - exp(-phi/R)) = 1, and cost phi G_c.");
    struct Row {
        double R, phi;
    };
    for (const SchemeOptions& path : {both_explicit, SchemeOptions{.cohesion = CohesionScheme::implicit_beta}}) {
        on_path(path);
        for (const Row& row : {Row{0.1, 1.100}, Row{1, 1.8414}, Row{3, 2.8333}, Row{10, 4.8318}, Row{100, 14.48}}) {
            const double exact = factor_of_ramp(row.R), tau = 0.7, h = tau * exact / row.R / 3001.5;
            CHECK(exact == relative(row.phi, 3e-4));
            const CohesiveLaw law{.sigma_c = 2, .G_c = 0.5, .incubation_time = tau};
            ModelInput input = pair_of_triangles(law);
            // a traction p on a free edge of length sqrt(2) gives half of its force to each of its corners
            const double rate = std::sqrt(2) * law.sigma_c * row.R / tau;
            const TimeFunction ramp{{0, 100 * tau}, {0, 100 * tau}};
            input.loads = {load(Load::Kind::traction, "upper", 0.0, rate, ramp),
                           load(Load::Kind::traction, "lower", 0.0, -rate, ramp)};
            Run run(input, path);
            REQUIRE(run.now.incubation.size() == run.model.fans.size());
            while (run.now.split_fans.empty()) {
                run.step(h);
                REQUIRE(run.now.time < 20 * tau);
                if (run.now.split_fans.empty()) CHECK(run.ledger.row().cohesive_work == 0);
            }
            const Index f = run.now.split_fans[0];
            const double phi = run.now.strength_factor(f);
            verify("phi, R = " + digits(row.R), phi, exact, {1e-3});
            verify_that("it splits in the step in which q reaches 1, R = " + digits(row.R),
                        phi >= exact && phi <= exact + row.R * h / tau);
            CHECK(run.last.largest_strength_factor == phi);
            CHECK(run.now.points[0].traction.x() == relative(-phi * law.sigma_c, 1e-12));
            while (run.now.points[0].cohesion > 0) run.step(h);
            run.step(h);
            verify("G/G_c at break over phi, R = " + digits(row.R), run.ledger.row().dissipated / (2 * law.G_c) / phi,
                   1, {1e-12});
            verify("incubation_dissipation over (phi - 1) G_c, R = " + digits(row.R),
                   incubation_energy(run.model, run.now) / (2 * law.G_c) / (phi - 1), 1, {1e-11});
            CHECK(run.ledger.largest_residual() < 1e-12 * run.ledger.largest_energy());
        }
    }
}

TEST_CASE("an overload that ends before its incubation leaves the bond") {
    const CohesiveLaw law{.sigma_c = 1, .G_c = 1, .incubation_time = 1};
    // a rectangular pulse of U for the time d: q = U (1 - exp(-d)) at its end
    for (const double U : {1.5, 3.0, 10.0})
        for (const double part : {0.97, 1.03}) {
            const double d = -part * std::log1p(-1 / U);
            ModelInput input = pair_of_triangles(law);
            const TimeFunction pulse{{0, 1e-9, d, d + 1e-9}, {1, 1, 1, 0}};
            input.loads = {load(Load::Kind::traction, "upper", 0.0, std::sqrt(2) * U, pulse),
                           load(Load::Kind::traction, "lower", 0.0, -std::sqrt(2) * U, pulse)};
            Run run(input);
            while (run.now.time < d + 2) run.step(1e-3);
            CAPTURE(U);
            CAPTURE(part);
            CHECK(run.now.split_fans.empty() == (part < 1));
        }
}

TEST_CASE("neighbours that open spread the incubated strength of a bar that expands") {
    // every vertex has its own ratio of U to the stress; R and phi follow from it, if nothing opened beside it
    for (const double R : {0.3, 3.0}) {
        const double rate = 2e-3, tau = R / rate;
        ModelInput input;
        input.plane = PlaneModel::stress;
        input.mesh = bar_mesh(20, 4, 20, 4);
        for (std::size_t i = 0; i < input.mesh.vertices.size(); ++i) {
            Vec2& x = input.mesh.vertices[i];
            if (x.x() > 0 && x.x() < 20 && x.y() > 0 && x.y() < 4)
                x += 0.2 * Vec2(std::sin(12.9898 * i), std::sin(78.233 * i));
        }
        input.materials = {{.density = 1, .E = 1, .nu = 0}};
        input.laws = {{.sigma_c = 1, .G_c = 3, .incubation_time = tau}};
        input.law_of_pair = {{0}};
        input.initial_velocities = {{.on = {}, .value = {0, 0}, .strain_rate = {rate, 0, 0}}};
        input.loads = {load(Load::Kind::velocity, "left", -10 * rate, 0.0),
                       load(Load::Kind::velocity, "right", 10 * rate, 0.0)};
        Run run(input);
        const double h = 0.5 * run.stepper.stable_step();
        std::vector<double> slope(run.model.fans.size(), 0);
        double first = 0, largest = 0, smallest = 10, sum = 0, squares = 0;
        int n = 0;
        while (run.now.time * rate < 3 * factor_of_ramp(R)) {
            const std::size_t before = run.now.split_fans.size();
            run.step(h);
            for (std::size_t f = 0; before == 0 && f < slope.size(); ++f)
                if (const Incubation& at = run.now.incubation[f]; at.utilisation > 0)
                    slope[f] = at.utilisation / at.time;
            for (std::size_t s = before; s < run.now.split_fans.size(); ++s) {
                const Index f = run.now.split_fans[s];
                const double phi = run.now.strength_factor(f) / factor_of_ramp(slope[f] * tau);
                if (n == 0) first = phi;
                largest = std::max(largest, phi), smallest = std::min(smallest, phi), sum += phi, squares += phi * phi,
                ++n;
            }
        }
        MESSAGE("R = ", R, ": phi of ", n, " vertices of ", slope.size(), " over that without neighbours: first ",
                first, ", smallest ", smallest, ", mean ", sum / n, ", deviation ",
                std::sqrt(squares / n - sum / n * (sum / n)), ", largest ", largest);
        CHECK(n > 20);
        CHECK(std::abs(sum / n - 1) < 0.15);
        CHECK(first >= 1 - 1e-6);
        CHECK(first < 1 + 2 * h * rate);
        CHECK(run.ledger.largest_residual() < 1e-11 * run.ledger.largest_energy());
    }
}

TEST_CASE("with strengths times the utilisation a fan just holds") {
    ModelInput input;
    Shape shape;
    shape.outer = {.points = {{0, 0}, {1, 0}, {1, 0.7}, {0, 0.7}}, .boundary = {0, 1, 2, 3}};
    shape.boundary_names = {"bottom", "right", "top", "left"};
    input.mesh = triangulate(shape, {.size = 0.1});
    input.materials = {{.density = 1, .E = 1, .nu = 0.2}};
    for (const CohesiveLaw& law : {CohesiveLaw{.sigma_c = 1, .G_c = 1, .gamma = 1},
                                   CohesiveLaw{.sigma_c = 1, .G_c = 1, .gamma = 0.4, .friction = 0.5}}) {
        input.laws = {law};
        input.law_of_pair = {{0}};
        Model model = make_model(input), scaled = model;
        BondCheck check(model), of_scaled(scaled);
        const State now = initial_state(model);
        std::mt19937 random(11);
        std::uniform_real_distribution<double> stress(-1, 1);
        int n = 0, n_right = 0, n_zero = 0;
        for (Index f = 0; f < static_cast<Index>(model.fans.size()); ++f) {
            const Fan& fan = model.fans[f];
            if (fan.n_points == 0) continue;
            for (int trial = 0; trial < 10; ++trial) {
                std::vector<Vec2> required;
                Vec2 total = Vec2::Zero();
                for (Index i = 0; i < fan.n_corners; ++i) {
                    required.push_back(Vec2(stress(random), stress(random)));
                    total += required.back();
                }
                for (Vec2& each : required) each -= total / fan.n_corners;
                const double U = check.utilisation(f, now, required, 1);
                if (U < 1e-6) {
                    ++n_zero;
                    continue;
                }
                ++n;
                scaled.laws[0].sigma_c = U * (1 + 1e-8);
                const bool holds = of_scaled.is_bonded(f, now, required, 1);
                scaled.laws[0].sigma_c = U * (1 - 1e-8);
                n_right += holds && !of_scaled.is_bonded(f, now, required, 1);
            }
        }
        CHECK(n > 500);
        CHECK(n_right == n);
        MESSAGE(n_zero, " held by friction alone");
    }
}

}  // namespace incubation_test
