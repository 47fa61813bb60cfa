// Friction over pressure on points with all pairs of schemes: direct shear on and between the bends of its polygon, and a
// joint across a specimen under confinement.
#include "base/formatted.hpp"
#include "support/bodies.hpp"
#include "support/paths.hpp"
#include "support/verification.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace friction_over_pressure_test {

using namespace knap;
using namespace knap::tests;

namespace {

/// Bends at 2 and 5 Pa, where it bears 3 and 5.1 Pa.
CohesiveLaw bent_friction(double sigma_c, Coupling coupling = Coupling::sum) {
    CohesiveLaw law{.sigma_c = sigma_c, .G_c = sigma_c, .gamma = 0.6, .coupling = coupling};
    law.over_pressure = std::make_shared<FrictionOverPressure>(std::vector<Vec2>{{0, 0}, {2, 3}, {5, 5.1}, {9, 6.3}});
    law.friction = law.over_pressure->chord(sigma_c);
    return law;
}

/// f by hand.
double threshold(double p) { return p <= 2 ? 1.5 * p : p <= 5 ? 3 + 0.7 * (p - 2) : 5.1 + 0.3 * (p - 5); }

/// Two points of mass 1 and area 1 under the pressure p and the shear t from rest.
Run pressed_points(const CohesiveLaw& law, double p, double t, const SchemeOptions& scheme) {
    ModelInput input = point_masses(law, law.sigma_c > 0);
    input.loads = {load(Load::Kind::acceleration, "", t, -p)};
    return Run(input, scheme);
}

void check_energy_balance(const Run& run) {
    CHECK(run.ledger.largest_residual() <= 1e-12 * run.ledger.largest_energy());
    CHECK(run.ledger.worst().worst_friction_work <= 1e-14 * run.ledger.largest_energy());
    CHECK(run.ledger.worst().residual <= 1e-10);
}

/// A rectangle of two triangles whose diagonal, at this angle to the y axis, is the interface, under sigma_1 along y and
/// sigma_3 along x (compression positive).
ModelInput inclined_joint(const CohesiveLaw& law, double angle, double sigma_1, double sigma_3) {
    Mesh mesh;
    const double h = 1 / std::tan(angle);
    mesh.vertices = {{0, 0}, {1, 0}, {1, h}, {0, h}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.region = {0, 0};
    mesh.boundary_names = {"side"};
    find_edges(mesh);
    for (BoundaryEdge& edge : mesh.boundary_edges) edge.boundary = 0;
    ModelInput input = body_with(mesh, {.density = 1, .E = 1000, .nu = 0.2}, law);
    const auto constant = [](double value) { return PlaceField::Formula{Expression(formatted("%.17g", value)), 1}; };
    const PlaceField stress{.path = "initial[0].stress",
                            .formulas = {constant(-sigma_3), constant(-sigma_1), constant(0)}};
    input.initial_stresses = {{.on = {}, .field = stress}};
    input.loads = {{.kind = Load::Kind::stress,
                    .on = {.boundary = "side", .box = {}},
                    .field = std::make_shared<PlaceField>(stress)}};
    return input;
}

/// sigma_1 at which the joint slides: the lowest of its lines.
double strength_of_joint(const CohesiveLaw& law, double angle, double sigma_3) {
    const double s = std::sin(angle), c = std::cos(angle), C = law.sigma_c,
                 extra = law.coupling == Coupling::sum ? C : 0;
    double lowest = INFINITY;
    for (const FrictionLine& line : law.over_pressure->lines())
        if (const double holds = s * (c - line.slope * s); holds > 0)
            lowest = std::min(lowest, sigma_3 + (law.gamma * C + line.offset + line.slope * (sigma_3 + extra)) / holds);
    return lowest;
}

}  // namespace

TEST_CASE("direct shear: friction over pressure bears its polygon on and between its bends") {
    for (const SchemeOptions& path : all_paths())
        for (const double p : {0.5, 2.0, 3.3, 5.0, 7.0, 20.0}) {
            on_path(path);
            CAPTURE(p);
            const double f = threshold(p), h = 1e-3;
            Run holds = pressed_points(bent_friction(0), p, f * (1 - 1e-9), path);
            for (int i = 0; i < 20; ++i) holds.step(h);
            CHECK(holds.u(0, 0) == Vec2(0, 0));
            Run slides = pressed_points(bent_friction(0), p, f + 1, path);
            for (int i = 0; i < 200; ++i) REQUIRE(slides.step(h).rejection == Rejection::none);
            const double time = slides.now.time - (path.bulk == BulkScheme::explicit_lumped ? 0.5 * h : 0);
            CHECK(std::abs(slides.v(0, 0).x() - time) <= 1e-12 * time);
            CHECK(std::abs(slides.v(0, 0).y()) <= 1e-30);  // its weight less what the support bears
            check_energy_balance(slides);
        }
}

TEST_CASE("direct shear: what cohesion holds adds its part and friction over pressure stays when it is gone") {
    for (const SchemeOptions& path : all_paths())
        for (const Coupling coupling : {Coupling::sum, Coupling::norm})
            for (const double p : {0.5, 1.0, 2.0, 4.0, 9.0}) {
                on_path(path);
                CAPTURE(p);
                const CohesiveLaw law = bent_friction(1, coupling);
                const double at_rest = law.gamma + threshold(coupling == Coupling::sum ? p + 1 : p), h = 1e-3;
                Run holds = pressed_points(law, p, at_rest * (1 - 1e-9), path);
                holds.step(h);
                CHECK(holds.u(0, 0) == Vec2(0, 0));
                Run slides = pressed_points(law, p, at_rest * (1 + 1e-6), path);
                slides.step(h);
                CHECK(slides.u(0, 0).x() > 0);
                // far beyond its slip at failure it has f(p) alone
                Run broken = pressed_points(law, p, at_rest + 1, path);
                double last = 0;
                for (int i = 0; i < 4000; ++i) {
                    last = broken.v(0, 0).x();
                    REQUIRE(broken.step(h).rejection == Rejection::none);
                }
                const PointState* point = state_of(broken.model, broken.now, 0);
                REQUIRE(point != nullptr);
                REQUIRE(point->cohesion == 0);
                CHECK(std::abs((broken.v(0, 0).x() - last) / h - (at_rest + 1 - threshold(p))) <= 1e-9);
                check_energy_balance(broken);
            }
}

TEST_CASE("E37 a joint across a specimen bears the closed form of friction over pressure under any confinement") {
    describe(
        "Two triangles that meet at a joint at the angle a to sigma_3, with a polygon f of friction over pressure: the "
        "joint slides under the lowest sigma_1 that one of its lines mu_i p + c_i gives, sin a (cos a - mu_i sin a) "
        "(sigma_1 - sigma_3) = gamma sigma_c + c_i + mu_i (sigma_3 + sigma_c); with the norm without the last "
        "sigma_c. Found: between the largest stress that it bears and the smallest under which it slides.");
    for (const SchemeOptions& path : both_paths())
        for (const Coupling coupling : {Coupling::sum, Coupling::norm})
            for (const double sigma_c : {0.0, 1.0})
                for (const double angle : {20.0, 33.0, 50.0, 65.0})
                    for (const double sigma_3 : {0.0, 0.7, 3.0, 12.0}) {
                        if (sigma_c == 0 && (coupling == Coupling::norm || sigma_3 == 0)) continue;  // no strength
                        on_path(path);
                        CAPTURE(angle);
                        CAPTURE(sigma_3);
                        CAPTURE(sigma_c);
                        const CohesiveLaw law = bent_friction(sigma_c, coupling);
                        const double a = angle * degree, strength = strength_of_joint(law, a, sigma_3);
                        if (std::isinf(strength)) continue;  // locked by its friction
                        double borne = 0, sliding = INFINITY;
                        for (const double part : {1 - 1e-6, 1 + 1e-6}) {
                            const double sigma_1 = sigma_3 + (strength - sigma_3) * part;
                            Run run(inclined_joint(law, a, sigma_1, sigma_3), path);
                            REQUIRE(run.step(1e-4).rejection == Rejection::none);
                            const double slip = (run.u(0, 0) - run.u(1, 0)).norm();
                            if (slip <= 1e-18) borne = sigma_1;
                            else if (slip > 1e-16) sliding = std::min(sliding, sigma_1);
                        }
                        verify("sigma_1 [Pa] at which the joint slides, a = " + digits(angle) +
                                   " deg, sigma_3 = " + digits(sigma_3) + ", sigma_c = " + digits(sigma_c) +
                                   (coupling == Coupling::sum ? "" : ", norm"),
                               0.5 * (borne + sliding), strength, {1e-6});
                    }
}

}  // namespace friction_over_pressure_test
