// The mean stress that a probe watches.
#include "analysis/probes.hpp"

#include "support/bodies.hpp"

#include <doctest/doctest.h>

namespace probes_test {

using namespace knap;
using namespace knap::tests;

TEST_CASE("a probe of a box has the mean stress of its triangles") {
    ModelInput input;
    input.mesh = bar_mesh(8, 2, 4, 1);
    input.plane = PlaneModel::stress;
    input.materials = {{.density = 1, .E = 10, .nu = 0.25}};
    input.laws = {{.sigma_c = 1e9, .G_c = 1, .gamma = 1}};
    input.law_of_pair = {{0}};
    const Model model = make_model(input);
    State state = initial_state(model);
    // u_x = a x^2/2: the strain a x is linear, and so its mean in a box of whole cells is that at the middle
    const double a = 1e-3;
    for (Index c = 0; c < model.mesh.n_corners(); ++c) {
        const double x = model.mesh.corner(c).x();
        state.displacement[state.node_of_corner[c]] = {0.5 * a * x * x, 0};
    }
    using Watch = ProbeOptions::Watch;
    const Probes probes(model, {{.name = "all", .watch = Watch::stress},
                                {.name = "right", .watch = Watch::stress, .box = Box{{2, -1}, {4, 2}}},
                                {.name = "end", .at = {4, 0}}});
    const auto names = probes.columns();
    REQUIRE(names.size() == 1 + 3 + 3 + 4);
    CHECK(names[4] == "right_stress_xx");
    const std::vector<double> line = probes.line(state);
    const double D = 10 / (1 - 0.25 * 0.25);
    CHECK(line[1] == doctest::Approx(D * a * 2).epsilon(1e-12));
    CHECK(line[2] == doctest::Approx(0.25 * D * a * 2).epsilon(1e-12));
    CHECK(line[4] == doctest::Approx(D * a * 3).epsilon(1e-12));
    CHECK(line[7] == doctest::Approx(8 * a).epsilon(1e-12));
    CHECK_THROWS_AS(Probes(model, {{.name = "none", .watch = Watch::stress, .box = Box{{5, 5}, {6, 6}}}}),
                    SimulationError);
}

}  // namespace probes_test
