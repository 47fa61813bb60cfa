// A boulder on an elastic block: it rebounds as the wave solution says; momentum and energy of both balance.
//
// The boulder covers the block from side to side and the block cannot widen, so waves are plane (B. de Saint-Venant
// 1883, a rigid mass on the end of a bar). With Z = rho c A and T = 2 L/c the end of the block moves with v = a + b, a
// the wave that leaves it, b = -a(t - T) what comes back from the rigid support, and the contact force is Z (a - b):
//
//     M v' = -Z (a - b),     a = v - b in contact, else a = b (a free end);     contact from where the gap closes until
//     the force vanishes
#include "support/obstacles.hpp"
#include "support/relative.hpp"
#include "support/springs.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace rockfall_test {

using namespace knap;
using namespace knap::tests;

namespace {

/// The wave solution for a boulder of `ratio` times the mass of the block, that hits with speed 1: time in L/c. By
/// steps of 1e-5.
struct WaveSolution {
    double release = 0;              // first end of the contact
    std::vector<double> rise, time;  // speed of the boulder upwards after each step

    explicit WaveSolution(double ratio) {
        const double dt = 1e-5;
        const int delay = 200000;  // 2 L/c
        std::vector<double> a;     // at the middles of the steps
        double v = 1, gap = 0;     // v: downwards
        for (int i = 0; i * dt < 6; ++i) {
            const double back = i >= delay ? -a[i - delay] : 0;
            const double in_contact = (v * (1 - 0.5 * dt / ratio) + 2 * back * dt / ratio) / (1 + 0.5 * dt / ratio);
            const bool touches = gap <= 0 && 0.5 * (v + in_contact) - 2 * back > 0;
            if (!touches && release == 0 && i > 0) release = i * dt;
            const double next = touches ? in_contact : v;
            a.push_back(touches ? 0.5 * (v + next) - back : back);
            if (!touches) gap = std::max(0.0, gap + dt * (2 * back - v));
            v = next;
            time.push_back((i + 1) * dt);
            rise.push_back(-v);
        }
    }
    double at(double t) const { return rise[static_cast<std::size_t>(t / 1e-5)]; }
};

/// The block, 1 high, and the boulder that comes down on it with speed 1e-3. Density and c of the block are 1.
ModelInput block_and_boulder(int n, int order, double ratio) {
    const double nu = 0.2, width = 0.0625;
    ModelInput input;
    input.mesh = bar_mesh(n / 16, n, width, 1);
    input.mesh.order = order;
    input.materials = {{.density = 1, .E = (1 + nu) * (1 - 2 * nu) / (1 - nu), .nu = nu}};
    input.laws = {CohesiveLaw::unbreakable()};
    input.law_of_pair = {{0}};
    for (const char* side : {"left", "right"})
        input.loads.push_back(load(Load::Kind::displacement, side, 0.0, std::nullopt));
    input.loads.push_back(load(Load::Kind::displacement, "bottom", std::nullopt, 0.0));
    input.obstacles = {polygon({{-0.1, 1}, {width + 0.1, 1}, {width + 0.1, 1.3}, {-0.1, 1.3}}, {.friction = 0.3})};
    set_free(input.obstacles[0], ratio * width / input.obstacles[0].outline.area());
    input.obstacles[0].initial_velocity.y() = -1e-3;
    return input;
}

}  // namespace

TEST_CASE("the wave solution of a mass on a bar has the known contact times") {
    CHECK(WaveSolution(1).release == relative(3.068, 1e-3));  // Saint-Venant: mass of the bar
    CHECK(WaveSolution(2).release == relative(4.708, 1e-3));
}

TEST_CASE(
    "a boulder rebounds from an elastic block as the wave solution says within 2 percent and energy and momentum "
    "balance") {
    for (const double ratio : {1.0, 2.0})
        for (const int order : {1, 2})
            for (const bool implicit_bulk : {false, true}) {
                if (ratio == 2 && implicit_bulk) continue;
                CAPTURE(ratio);
                CAPTURE(order);
                CAPTURE(implicit_bulk);
                Run run(block_and_boulder(order == 1 ? 48 : 16, order, ratio),
                        implicit_bulk ? implicit(0.51) : SchemeOptions{});
                const WaveSolution exact(ratio);
                const double h = implicit_bulk ? 5e-3 : 0.8 * run.stepper.stable_step(), mass = ratio * 0.0625,
                             start = mass * 1e-3;
                const auto momentum = [&] {
                    double sum = mass * run.now.obstacles[0].velocity.y();
                    for (Index c = 0; c < run.model.mesh.n_corners(); ++c)
                        sum += run.model.corner_mass[c] * run.now.velocity[run.now.node_of_corner[c]].y();
                    return sum;
                };
                double release = 0, support = 0, rebound = 0, worst = 0;
                bool pressed = true;
                while (run.now.time < 5.9) {
                    const double kick = implicit_bulk ? h : 0.5 * (run.now.last_step + h);
                    REQUIRE(run.step_if_taken(h));
                    for (const Vec2& reaction : run.now.reaction) support += kick * reaction.y();
                    if (run.now.time < 0.1) continue;
                    const double speed = run.now.obstacles[0].velocity.y() / 1e-3;
                    pressed = pressed && run.now.obstacles[0].reaction.y() > 0;
                    if (pressed) release = run.now.time, rebound = speed;
                    worst = std::max(worst, std::abs(speed - exact.at(run.now.time)));
                }
                CHECK(run.now.obstacles[0].velocity.y() / 1e-3 ==
                      relative(exact.at(5.9), 0.02));  // a second contact follows for ratio 1
                CHECK(worst <= 0.03);
                CHECK(rebound == relative(exact.at(exact.release), 0.02));
                CHECK(release == within(exact.release, 0.07));  // L/c: a wave through an element of order 2 of 1/16
                CHECK(std::abs(momentum() + start - support) <= 1e-10 * start);
                CHECK(run.ledger.largest_residual() <= 1e-10 * run.ledger.largest_energy());
                CHECK(run.ledger.worst().residual <= 1e-10);
            }
}

}  // namespace rockfall_test
