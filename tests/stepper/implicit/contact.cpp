// Contact of thousands of sides at once, implicitly.
#include "base/random.hpp"
#include "mesh/triangulate.hpp"
#include "support/bodies.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace implicit_contact_test {

using namespace knap;
using namespace knap::tests;

namespace {

/// A square of separate triangles of size 1 (E = rho = 1) that cohesion presses onto each other.
ModelInput heap(double width, double pressure) {
    Shape shape;
    shape.outer = {.points = {{0, 0}, {width, 0}, {width, width}, {0, width}}, .boundary = {0, 1, 2, 3}};
    shape.boundary_names = {"bottom", "right", "top", "left"};
    ModelInput input = body_with(triangulate(shape, {.size = 1}), {.density = 1, .E = 1, .nu = 0.2},
                                 {.sigma_c = 0.1, .G_c = 1, .gamma = 1});
    input.loads = {
        load(Load::Kind::traction, "top", 0.0, -pressure), load(Load::Kind::traction, "bottom", 0.0, pressure),
        load(Load::Kind::traction, "left", pressure, 0.0), load(Load::Kind::traction, "right", -pressure, 0.0)};
    return input;
}

/// Every corner in some motion of its own: the bounds of the contacts round a vertex contradict each other.
void stir(Run& run) {
    for (Index f = 0; f < static_cast<Index>(run.model.fans.size()); ++f) split(run.model, f, run.now);
    Random random(1, "heap");
    for (Vec2& v : run.now.velocity) v = 1e-2 * Vec2(random.normal(), random.normal());
    run.ledger = EnergyLedger(run.model, run.now);
}

}  // namespace

TEST_CASE("contacts that contradict each other round hundreds of vertices are all let go in one implicit step") {
    for (const auto& [width, pressure] : {std::pair{10.0, 1e-2}, std::pair{14.0, 0.0}}) {
        CAPTURE(width);
        Run run(heap(width, pressure), {.bulk = BulkScheme::implicit_theta, .cohesion = CohesionScheme::implicit_beta});
        stir(run);
        for (int n = 0; n < 3; ++n) {
            run.step(2);
            REQUIRE(run.last.rejection == Rejection::none);
            CHECK(run.last.residual <= 1e-10);
            CHECK(run.last.impact_work < 0);
            CHECK(run.last.worst_impact_work <= 1e-14 * run.ledger.largest_energy());
            CHECK(run.last.linear_solves <= 300);  // the more vertices, hardly the more of them
        }
        CHECK(std::abs(run.ledger.row().residual) <= 1e-13 * run.ledger.largest_energy());
    }
}

}  // namespace implicit_contact_test
