#pragma once
// A bar whose interfaces reach their strength all at once.
#include "support/bodies.hpp"

namespace knap::tests {

inline ModelInput tied_bar() {
    ModelInput input = body_with(bar_mesh(20, 4, 1, 0.2), {.density = 1, .E = 1, .nu = 0},
                                 {.sigma_c = 1e-3, .G_c = 2e-5, .gamma = 1, .friction = 0.3});
    input.plane = PlaneModel::stress;
    input.loads = {load(Load::Kind::velocity, "left", -1e-3, std::nullopt),
                   load(Load::Kind::velocity, "right", 1e-3, std::nullopt)};
    return input;
}

/// A homogeneous rate of strain, from a stress a little below the strength.
inline void strain_evenly(Run& run) {
    for (Index c = 0; c < run.model.mesh.n_corners(); ++c) {
        const double x = run.model.mesh.corner(c / 3, c % 3).x();
        run.now.displacement[run.now.node_of_corner[c]].x() = 0.999e-3 * (x - 0.5);
        run.now.velocity[run.now.node_of_corner[c]].x() = 2e-3 * (x - 0.5);
    }
}

}  // namespace knap::tests
