// A triangle between a support and a driven triangle: with much friction it is wedged, and no motion obeys the laws.
#include "support/bodies.hpp"

#include <doctest/doctest.h>

namespace driven_wedge_test {

using namespace knap;
using namespace knap::tests;

namespace {

/// The flat lower triangle lies on a support; the upper one comes down along its left edge, whose lower end is on the
/// tip of the lower one.
ModelInput wedge(double friction) {
    ModelInput input;
    input.mesh = bar_mesh(1, 1, 1, 0.05);
    for (InteriorEdge& edge : input.mesh.interior_edges) edge.cracked = true;
    input.materials = {{.density = 1, .E = 1, .nu = 0}};
    input.laws = {{.sigma_c = 0, .G_c = 0, .friction = friction}};
    input.law_of_pair = {{0}};
    input.supports = {{.on = {.boundary = "bottom", .box = {}}, .law = 0}};
    input.loads = {load(Load::Kind::velocity, "left", std::nullopt, -1e-3)};
    return input;
}

const std::array schemes{
    SchemeOptions{.bulk = BulkScheme::implicit_theta, .cohesion = CohesionScheme::explicit_beta, .theta = 0.5},
    SchemeOptions{.bulk = BulkScheme::implicit_theta, .cohesion = CohesionScheme::implicit_beta, .theta = 1},
    SchemeOptions{.bulk = BulkScheme::explicit_lumped, .cohesion = CohesionScheme::implicit_beta}};

}  // namespace

TEST_CASE("a wedge that is driven in is said to jam and at any size of the step within few systems") {
    for (const SchemeOptions& scheme : schemes)
        for (const double h : {1e-2, 1e-4, 1e-6}) {
            CAPTURE(static_cast<int>(scheme.bulk));
            CAPTURE(h);
            Run run(wedge(0.5), scheme);
            CHECK(!run.step_if_taken(h));
            CHECK(run.last.rejection == Rejection::jammed);
            CHECK(run.last.where == Vec2(0, 0));
            CHECK(run.last.linear_solves <= 400);  // thousands, where every attempt goes to its end
        }
}

TEST_CASE("a wedge without friction slides out") {
    for (const SchemeOptions& scheme : schemes) {
        CAPTURE(static_cast<int>(scheme.bulk));
        Run run(wedge(0), scheme);
        for (int i = 0; i < 3; ++i) {
            REQUIRE(run.step_if_taken(1e-3));
            CHECK(run.last.residual < 1e-10);
            CHECK(run.v(0, 0).x() > 0.01);  // at least 20 times as fast as it is pressed
        }
    }
}

}  // namespace driven_wedge_test
