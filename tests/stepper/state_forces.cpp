// Loads that depend on the state (Model::state_forces): an elastic bedding and drag move a body as the recurrence of
// each scheme says, and their works close the energy balance.
#include "model/make_model.hpp"
#include "support/bodies.hpp"
#include "support/obstacles.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace state_forces_test {

using namespace knap;
using namespace knap::tests;

namespace {

constexpr double stiffness = 4;  // [1/s2] per mass: so the block moves without strain

/// A block whose corners feel -m (stiffness u + drag v), drag in 1/s.
Model block_on_bedding(double drag) {
    ModelInput input = free_block(1, CohesiveLaw::unbreakable());
    input.initial_velocities = {{.on = {}, .value = {3, -1}}};
    Model model = make_model(std::move(input));
    model.histories.push_back({.time = {0}, .value = {1}});
    for (Index c = 0; c < model.mesh.n_corners(); ++c) {
        model.corner_loads.push_back({.corner = c,
                                      .history = static_cast<Index>(model.histories.size()) - 1,
                                      .force = Vec2::Zero(),
                                      .state_force = static_cast<Index>(model.state_forces.size())});
        model.state_forces.emplace_back([c, drag, m = model.corner_mass[c]](const State& state, double) -> Vec2 {
            return -m * (stiffness * state.displacement_of(c) + drag * state.velocity[state.node_of_corner[c]]);
        });
    }
    return model;
}

}  // namespace

TEST_CASE("state forces: bedding and drag move a block as the recurrence of each scheme says") {
    const double drag = 0.6;
    for (const bool implicit : {false, true}) {
        Run run(block_on_bedding(drag),
                {.bulk = implicit ? BulkScheme::implicit_theta : BulkScheme::explicit_lumped, .theta = 0.5});
        const double h = implicit ? 0.05 : 0.4 * run.stepper.stable_step();
        Vec2 u = Vec2::Zero(), v(3, -1);
        for (int i = 0; i < 200; ++i) {
            const double kick = implicit ? h : i == 0 ? 0.5 * h : h;
            const Vec2 before = v;
            const Vec2 at = implicit ? Vec2(u + 0.5 * h * v) : u;
            v -= kick * (stiffness * at + drag * v);
            u += h * (implicit ? Vec2(0.5 * (before + v)) : v);
            run.step(h);
        }
        CHECK((run.u(0, 0) - u).norm() < 1e-12);
        CHECK((run.v(1, 2) - v).norm() < 1e-12);
        CHECK(std::abs(run.ledger.row().external_work) > 0.1);
        CHECK(run.ledger.row().residual < 1e-12);
    }
}

TEST_CASE("state forces: without drag a bedding neither feeds an oscillation nor damps it") {
    for (const bool implicit : {false, true}) {
        Run run(block_on_bedding(0),
                {.bulk = implicit ? BulkScheme::implicit_theta : BulkScheme::explicit_lumped, .theta = 0.5});
        const double h = implicit ? 0.3 : 0.4 * run.stepper.stable_step();
        double largest = 0;
        for (int i = 0; i < 4000; ++i) {
            run.step(h);
            if (i >= 3900) largest = std::max(largest, run.u(0, 0).norm());
        }
        const double amplitude = std::sqrt(10.) / std::sqrt(stiffness);  // [m] v/omega
        CHECK(largest == relative(amplitude, 0.1));
    }
}

}  // namespace state_forces_test
