// Loads and motions that change between the ends of steps: momentum and way are exact, and the energy closes.
#include "support/bodies.hpp"
#include "support/obstacle_shapes.hpp"
#include "support/paths.hpp"
#include "support/relative.hpp"
#include "support/springs.hpp"

#include <doctest/doctest.h>

namespace loads_between_steps_test {

using namespace knap;
using namespace knap::tests;

namespace {

constexpr Elastic unit{.density = 1, .E = 1, .nu = 0.25};
constexpr double h = 0.05;
const TimeFunction pulse{{0, 0.212, 0.213, 0.217, 0.218}, {0, 0, 1, 1, 0}},      // within a step
    jumps{{0.33, 0.33, 0.764, 0.764, 0.8, 0.81, 0.82}, {0, 2, 2, 0, 0, -3, 0}};  // and a pulse
constexpr double of_pulse = 0.005, of_jumps = 0.838;                             // integrals

ModelInput bar(Load load) {
    ModelInput input = body_with(bar_mesh(4, 2, 2, 1), unit, CohesiveLaw::unbreakable());
    input.plane = PlaneModel::stress;
    input.loads = {std::move(load)};
    return input;
}

double momentum(const Run& run) {
    double sum = 0;
    for (Index c = 0; c < run.model.mesh.n_corners(); ++c)
        sum += run.model.corner_mass[c] * run.now.velocity[run.now.node_of_corner[c]].x();
    return sum;
}

void check_energy(const Run& run) {
    CHECK(run.ledger.largest_residual() <= 1e-14 * run.ledger.largest_energy());
    CHECK(run.ledger.largest_energy() > 0);
}

}  // namespace

TEST_CASE("loads between steps: a free bar gets the impulse of a traction or a force or a weight") {
    for (const auto& [table, integral] : {std::pair{&pulse, of_pulse}, {&jumps, of_jumps}})
        for (const Load::Kind kind : {Load::Kind::traction, Load::Kind::force, Load::Kind::body_force})
            for (const double theta : {0., 0.5}) {  // 0: explicit
                on_path(theta == 0 ? "explicit" : "implicit");
                Load pulled = load(kind, kind == Load::Kind::body_force ? "" : "right", 3, std::nullopt, *table);
                Run run(bar(pulled), theta == 0 ? SchemeOptions{} : implicit(theta));
                for (int i = 0; i < 20; ++i) run.step(h);
                const double size = kind == Load::Kind::body_force ? 2 : 1;  // volume or area
                CHECK(momentum(run) == relative(3 * size * integral, 1e-12));
                check_energy(run);
            }
}

TEST_CASE("loads between steps: a pulse within one step of theta = 1 has its impulse") {
    Run run(bar(load(Load::Kind::traction, "right", 3, std::nullopt, pulse)), implicit(1));
    for (int i = 0; i < 20; ++i) run.step(h);
    CHECK(momentum(run) == relative(3 * of_pulse, 1e-12));
    check_energy(run);
}

TEST_CASE("loads between steps: a face goes the way of its velocity") {
    for (const double theta : {0., 0.5}) {
        Run run(bar(load(Load::Kind::velocity, "right", 3, std::nullopt, pulse)),
                theta == 0 ? SchemeOptions{} : implicit(theta));
        for (int i = 0; i < 20; ++i) run.step(h);
        double way = 0;
        for (Index c = 0; c < run.model.mesh.n_corners(); ++c)
            if (run.model.motion_of(c) != nullptr) way = run.now.displacement[run.now.node_of_corner[c]].x();
        CHECK(way == relative(3 * of_pulse, 1e-12));
        check_energy(run);
    }
}

TEST_CASE("loads between steps: a free obstacle gets the impulse of its force and a driven one goes its way") {
    for (const double theta : {0., 0.5}) {
        ModelInput input = bar(load(Load::Kind::traction, "right", 0, std::nullopt));
        Obstacle free = boulder({10, 10}, 1, {0, 0}), driven_one = boulder({20, 10}, 1, {0, 0});
        free.forces = {{Vec3(3, 0, 0), jumps}};
        driven_one.drive[0] = driven(5, pulse);
        input.obstacles = {free, driven_one};
        Run run(input, theta == 0 ? SchemeOptions{} : implicit(theta));
        for (int i = 0; i < 20; ++i) run.step(h);
        CHECK(run.model.obstacles[0].mass * run.now.obstacles[0].velocity.x() == relative(3 * of_jumps, 1e-12));
        CHECK(run.now.obstacles[1].moved.x() == relative(5 * of_pulse, 1e-12));
        check_energy(run);
    }
}

}  // namespace loads_between_steps_test
