// Points whose opening is a norm (coupling = "norm"), through the whole stepper: one point along straight and curved
// ways, closed forms of inclined facets, bodies that break with every softening and unloading.
#include "support/bodies.hpp"
#include "support/paths.hpp"
#include "support/relative.hpp"
#include "support/softening_shapes.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace norm_law_runs_test {

using namespace knap;
using namespace knap::tests;

namespace {

CohesiveLaw norm_of(double gamma, double friction = 0) {
    return {.sigma_c = 0.5, .G_c = 0.25, .gamma = gamma, .friction = friction, .coupling = Coupling::norm};
}

/// Both schemes of the cohesion with the explicit bulk, and the implicit scheme.
std::vector<SchemeOptions> norm_paths() {
    return {both_explicit, {.cohesion = CohesionScheme::implicit_beta}, both_implicit};
}

}  // namespace

TEST_CASE("with the norm a facet at an angle bears beta sigma_c along the way and costs G_c") {
    // With gamma = 1 the traction is beta sigma_c along the way: a band of facets at the angle t bears
    // beta sigma_c/cos t a length across the way, and costs G_c/cos t. It breaks at w = delta_c/sqrt(cos2 t + gamma2 sin2 t).
    for (const SchemeOptions& path : norm_paths()) {
        CAPTURE(name_of(path));
        double worst_force = 0, worst_beta = 0, worst_energy = 0, worst_lag = 0, least_loss = 0;
        for (const double gamma : {0.5, 1.0, 2.0})
            for (const double degrees : {0.0, 25.0, 40.0, 75.0, 90.0}) {
                const double t = degrees * M_PI / 180, reach = std::hypot(std::cos(t), gamma * std::sin(t));
                const CohesiveLaw law = norm_of(gamma);
                ModelInput input = point_masses(law, true);
                const double breaks = law.delta_c() / reach;
                input.loads = {
                    load(Load::Kind::displacement, "base", std::sin(t), std::cos(t), {{0, 1}, {0, 2 * breaks}})};
                Run run(input, path);
                const int n = 512;
                for (int k = 0; k < n / 4; ++k) run.step(1.0 / n);
                const double before = cohesion(run.model, run.now, 0);
                run.step(1.0 / n);
                const double beta = cohesion(run.model, run.now, 0);
                worst_beta = std::max(worst_beta, std::abs(beta - (1 - 2.0 * (n / 4 + 1) / n)));
                const Vec2 traction = run.now.points[0].traction;
                const double by = path.cohesion == CohesionScheme::explicit_beta ? before : 0.5 * (beta + before),
                             expected = by * law.sigma_c / reach;
                // explicit: the implicit beta belongs to the end of the step with theta = 1/2 of both
                const Vec2 direction(-std::cos(t), (traction.y() > 0 ? 1 : -1) * gamma * gamma * std::sin(t));
                worst_force = std::max(worst_force, (traction - expected * direction).norm() / expected);
                for (int k = n / 4 + 1; k < n / 2 + 2; ++k) {
                    run.step(1.0 / n);
                    least_loss = std::min(least_loss, run.last.crossing_loss);
                }
                CHECK(cohesion(run.model, run.now, 0) == 0);
                worst_energy = std::max(worst_energy, std::abs(run.ledger.row().dissipated / (2 * law.G_c) - 1));
                worst_lag = std::max(worst_lag, std::abs(run.ledger.row().law_lag) / (2 * law.G_c) * n);
                CHECK(run.ledger.largest_residual() < 1e-12 * run.ledger.largest_energy());
            }
        CHECK(worst_force < 1e-11);
        CHECK(worst_beta < 1e-12);
        CHECK(worst_energy < 1e-12);
        CHECK(worst_lag <= 4);
        CHECK(-least_loss <= 1e-15);
    }
}

TEST_CASE("with the norm a point led along an ellipse dissipates in every step and keeps the balance") {
    for (const SchemeOptions& path : norm_paths())
        for (const double gamma : {0.7, 1.0, 2.0})
            for (const auto& [name, shape] : all_softening_shapes()) {
                CAPTURE(name);
                CohesiveLaw law = norm_of(gamma, 0.3);
                law.softening = shape;
                if (law.softening->slope(law.softening->n_pieces() - 1) > 1e6) continue;
                ModelInput input = point_masses(law, true);
                TimeFunction x, y;
                const double a = 0.4 * law.delta_c();
                for (int i = 0; i <= 64; ++i) {
                    const double time = i / 32.0, angle = 2 * M_PI * time;
                    x.time.push_back(time), y.time.push_back(time);
                    x.value.push_back(0.5 * a * std::sin(angle)), y.value.push_back(a * (1 - std::cos(angle)));
                }
                input.loads = {load(Load::Kind::displacement, "base", 1.0, std::nullopt, x),
                               load(Load::Kind::displacement, "base", std::nullopt, 1.0, y)};
                Run run(input, path);
                double dissipated = 0;
                for (int i = 0; i < 290; ++i) {
                    run.step(1.0 / 300);
                    CHECK(run.ledger.row().dissipated >= dissipated - 1e-14);
                    dissipated = run.ledger.row().dissipated;
                }
                CHECK(dissipated > 0.1 * law.G_c);
                CHECK(run.ledger.row().crossing_loss >= 0);
                CHECK(run.last.crossing_loss >= -1e-15);
                CHECK(run.ledger.largest_residual() < 1e-12 * run.ledger.largest_energy());
                CHECK(std::abs(run.ledger.row().law_lag) < 0.06 * law.G_c);
            }
}

TEST_CASE("with the norm a closed point slides under gamma beta sigma_c and friction on its pressure alone") {
    const CohesiveLaw law = norm_of(1.5, 0.4);
    for (const SchemeOptions& path : {both_explicit, both_implicit}) {
        CAPTURE(name_of(path));
        ModelInput input = point_masses(law, true);
        const double pressure = 0.3, v = 0.2;
        input.loads = {load(Load::Kind::displacement, "base", 1.0, std::nullopt, {{0, 1}, {0, v}}),
                       load(Load::Kind::body_force, "", 0.0, -3 * pressure)};
        Run run(input, path);
        for (int i = 0; i < 300; ++i) run.step(1.0 / 1024);
        const double beta = cohesion(run.model, run.now, 0);
        CHECK(beta < 1);
        CHECK(run.now.points[0].traction.x() == relative(pressure, 1e-9));
        CHECK(std::abs(run.now.points[0].traction.y()) == relative(1.5 * 0.5 * beta + 0.4 * pressure, 0.002));
        CHECK(run.ledger.row().cohesive_friction_work == 0);
        CHECK(run.ledger.worst().worst_friction_work <= 0);
        CHECK(std::abs(run.ledger.row().residual) < 1e-12 * run.ledger.largest_energy());
    }
}

}  // namespace norm_law_runs_test
