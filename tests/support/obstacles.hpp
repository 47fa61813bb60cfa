#pragma once
// Small bodies that rigid obstacles meet.
#include "support/bodies.hpp"
#include "support/obstacle_shapes.hpp"

#include <doctest/doctest.h>

#include <numbers>

namespace knap::tests {

/// A free block of 1 x 1 m to meet them, rho = 1, E = 100, of 4 x 4 squares.
inline ModelInput free_block(int order, const CohesiveLaw& law) {
    ModelInput input = body_with(bar_mesh(4, 4, 1, 1), {.density = 1, .E = 100, .nu = 0.2}, law);
    input.mesh.order = order;
    return input;
}

/// A rigid mass that runs with v [m/s] into the end of a bar of n cells, 1 x 0.01 m, rho = E = 1, nu = 0.
inline ModelInput boulder_at_bar(int n, double v) {
    ModelInput input =
        body_with(symmetric_bar_mesh(n, 1, 0.01), {.density = 1, .E = 1, .nu = 0}, CohesiveLaw::unbreakable());
    input.plane = PlaneModel::stress;
    input.obstacles = {polygon({{-0.1, -0.05}, {0, -0.05}, {0, 0.06}, {-0.1, 0.06}})};
    set_free(input.obstacles[0], 0.2);
    input.obstacles[0].initial_velocity.x() = v;
    return input;
}

/// The balance of energy and the signs of the works of impacts and friction, as parts of the largest energy, and the laws of the interfaces.
inline void check_energy_balance(const Run& run, double energy, double work) {
    const double scale = run.ledger.largest_energy();
    CHECK(run.ledger.largest_residual() <= energy * scale);
    CHECK(run.ledger.worst().worst_friction_work <= work * scale);
    CHECK(run.ledger.worst().worst_impact_work <= work * scale);
    CHECK(run.ledger.worst().residual <= 1e-10);
}

}  // namespace knap::tests
