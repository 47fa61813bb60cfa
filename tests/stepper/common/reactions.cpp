// The force that drives a body: it is what the works of the ledger say, and what statics says.
#include "analysis/reactions.hpp"
#include "support/bodies.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

namespace reactions_test {

using namespace knap;
using namespace knap::tests;

TEST_CASE("reactions of a bar that is pulled do the external work and are its stress at rest") {
    const double E = 2, strain = 1e-3, length = 4, height = 1;
    ModelInput input =
        body_with(bar_mesh(8, 2, length, height), {.density = 1, .E = E, .nu = 0}, CohesiveLaw::unbreakable());
    input.plane = PlaneModel::stress;
    // left is held, the right end glides to its place and stays; a load that later ones replace everywhere drives
    // nothing
    input.loads = {load(Load::Kind::velocity, "right", 7.0, std::nullopt),
                   load(Load::Kind::velocity, "left", 0.0, std::nullopt),
                   load(Load::Kind::displacement, "right", strain * length, std::nullopt, {{0, 40, 80}, {0, 0.5, 1}})};
    Run run(input);
    const Reactions reactions(run.model);
    REQUIRE(reactions.loads() == std::vector<Index>{1, 2});
    CHECK(reactions.columns().size() == 9);
    const double h = 0.5 * run.stepper.stable_step();
    double work = 0, mean = 0;
    int n = 0;
    while (run.now.time < 400) {
        const double u = reactions.at(run.now)[1].displacement.x(), v = run.v(14, 1).x(),
                     kick = 0.5 * (run.now.last_step + h);
        run.step(h);
        const std::vector<Reaction> at = reactions.at(run.now);
        work += kick * at[1].force.x() * 0.5 * (v + run.v(14, 1).x());
        CHECK(at[0].displacement.x() == 0);
        CHECK(at[1].displacement.x() >= u);
        if (run.now.time > 200) mean += at[1].force.x(), ++n;
    }
    CHECK(work == relative(run.ledger.row().external_work, 1e-10));
    CHECK(mean / n == relative(E * strain * height, 0.01));  // it rings about its state of rest
    CHECK(reactions.at(run.now)[1].displacement.x() == relative(strain * length, 1e-12));
}

TEST_CASE("reactions of a support do not reach what stands on it unless it is driven") {
    // a driven corner on a support: the driver gives what load and support do not
    ModelInput input = point_masses({.sigma_c = 0, .friction = 0.5}, false);
    input.loads = {load(Load::Kind::body_force, "", 0.0, -3.0), load(Load::Kind::velocity, "base", 1.0, std::nullopt)};
    Run run(input);
    const Reactions reactions(run.model);
    run.step(0.1);
    run.step(0.1);
    // two points under a pressure of 1 each slide at constant speed: the driver holds mu N = 0.5 each
    CHECK(reactions.at(run.now)[0].force.x() == relative(1, 1e-12));
    CHECK(reactions.at(run.now)[0].force.y() == 0);
}

}  // namespace reactions_test
