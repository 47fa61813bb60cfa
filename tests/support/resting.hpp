#pragma once
// Bodies that start in equilibrium: whether they do, and whether they stay at rest.
#include "base/error.hpp"
#include "support/relative.hpp"
#include "support/several_bodies.hpp"

#include <doctest/doctest.h>

#include <string>

namespace knap::tests {

inline constexpr double below = 1e-6;  // [m] of held planes under what lies on them

inline Load everywhere(double x, double y) { return {.kind = Load::Kind::acceleration, .value = {x, y}}; }
/// Holds what lies under y = -below/2.
inline Load held() {
    return {.kind = Load::Kind::displacement,
            .on = {.boundary = "", .box = Box{{-100, -100}, {100, -0.5 * below}}},
            .value = {0, 0}};
}

/// Of hard rock: its edges sink in by 1e-6 of their length.
inline ModelInput hard(Bodies& bodies, double friction) {
    ModelInput input = bodies.input({friction, 0});
    for (Elastic& material : input.materials) material.E = 1e10;
    return input;
}

struct Rest {
    std::string refused;           // why, or nothing
    double kinetic;                // over the strain energy, the largest in the explicit steps
    Vec2 reaction = Vec2::Zero();  // [N] of what is held and of obstacles, after them
    State now;
};

inline Rest rest_of(ModelInput input, int n_steps = 300) {
    Run run(std::move(input));
    Rest rest{};
    try {
        run.stepper.start_in_equilibrium(run.now);
    } catch (const SimulationError& error) {
        rest.refused = error.what();
        return rest;
    }
    run.ledger = EnergyLedger(run.model, run.now);
    const double h = 0.8 * run.stepper.stable_step(), strain = run.ledger.row().strain;
    for (int i = 0; i < n_steps; ++i) {
        run.step(h);
        rest.kinetic = std::max(rest.kinetic, run.ledger.row().kinetic / strain);
    }
    for (const Vec2& reaction : run.now.reaction) rest.reaction += reaction;
    for (const ObstacleState& obstacle : run.now.obstacles) rest.reaction -= obstacle.reaction.head<2>();
    rest.now = run.now;
    CHECK(run.ledger.largest_residual() <= 1e-11 * strain);
    return rest;
}

inline void check_rests(const Rest& rest) {
    CHECK_MESSAGE(rest.refused.empty(), rest.refused);
    CHECK(rest.kinetic <= 1e-15);
}

inline void check_refused(const Rest& rest, const std::string& why) {
    CHECK_MESSAGE(rest.refused.find(why) != std::string::npos, rest.refused);
}

}  // namespace knap::tests
