// Starts in equilibrium of bodies that contact, friction and glue hold: stacks, walls, blocks on slopes, just above
// their limit and just below it.
#include "support/obstacles.hpp"
#include "support/paths.hpp"
#include "support/resting.hpp"

#include <cmath>

namespace resting_bodies_test {

using namespace knap;
using namespace knap::tests;

namespace {

/// Blocks of 1 x 0.5 m on a held plane, each `shift(i)` to the right of the one below.
template <class Shift>
ModelInput stack(int n_blocks, double friction, const Shift& shift) {
    Bodies bodies;
    bodies.add(bar_mesh(8, 1, 2, 0.25), {-0.5, -0.25 - below});
    double x = 0;
    for (int i = 0; i < n_blocks; ++i) bodies.add(bar_mesh(2 + i % 2, 2, 1, 0.5), {x += shift(i), 0.5 * i});
    ModelInput input = hard(bodies, friction);
    input.loads = {everywhere(0, -10), held()};
    return input;
}

/// A block of 1 x 0.2 m on the plane y = 0, under 10 m/s2 that point `slope` times as far to the right as down.
ModelInput block_on_slope(double slope, const CohesiveLaw& law = {}) {
    ModelInput input;
    input.mesh = bar_mesh(8, 2, 1, 0.2);
    input.materials = {{.density = 2000, .E = 1e10, .nu = 0.2}};
    input.laws = {CohesiveLaw::unbreakable(), law};
    input.law_of_pair = {{0}};
    input.loads = {everywhere(10 * slope, -10)};
    return input;
}

}  // namespace

TEST_CASE("stacks of blocks start at rest and the ground bears their weight") {
    for (const int n : {1, 3, 6}) {
        CAPTURE(n);
        const Rest rest = rest_of(stack(n, 0.5, [](int) { return 0.02; }));
        check_rests(rest);
        CHECK(rest.reaction.y() == relative(10 * 2000 * (0.5 * n + 0.5), 1e-9));  // with the plane of 2 x 0.25 m
    }
}

TEST_CASE("an overhanging stack stands to 1/2 + 1/4 + 1/6 of a block and falls beyond") {
    // from the top: the centre of what lies above is over the edge below
    for (const double part : {0.99, 1.01}) {
        CAPTURE(part);
        const Rest rest = rest_of(stack(4, 0.8, [&](int i) { return i == 0 ? 0 : part * 0.5 / (4 - i); }));
        if (part < 1) check_rests(rest);
        else check_refused(rest, "contact and friction do not hold the body");
    }
}

TEST_CASE("a block on a slope rests where friction exceeds the slope by a hundredth and is refused below") {
    const double slope = 0.6;
    const auto on_body = [&](double friction) {
        ModelInput input = stack(1, friction, [](int) { return 0; });
        input.loads[0] = everywhere(10 * slope, -10);
        return input;
    };
    const auto on_support = [&](double friction) {
        ModelInput input = block_on_slope(slope, {.sigma_c = 0, .G_c = 0, .gamma = 1, .friction = friction});
        input.supports = {{.on = {.boundary = "bottom", .box = {}}, .law = 1, .glued = false}};
        return input;
    };
    const auto on_obstacle = [&](double friction) {
        ModelInput input = block_on_slope(slope);
        input.obstacles = {polygon({{-1, -1}, {2, -1}, {2, 0}, {-1, 0}}, {.friction = friction})};
        return input;
    };
    for (const double part : {1.01, 0.99})
        for (int holder = 0; holder < 3; ++holder) {
            CAPTURE(part);
            CAPTURE(holder);
            const double friction = part * slope;
            const Rest rest = rest_of(holder == 0   ? on_body(friction)
                                      : holder == 1 ? on_support(friction)
                                                    : on_obstacle(friction));
            if (part > 1) check_rests(rest);
            else check_refused(rest, "contact and friction do not hold the body, it would move away with 0.06 m/s2");
        }
}

TEST_CASE("a glued block on a slope rests at the safety 1.12 and 1.001 of limit equilibrium and is refused below 1") {
    // (gamma + mu) sigma_c L + mu W = safety W slope; elastic stress at the ends of the joint is more than its strength
    const double slope = 0.8, friction = 0.4, weight = 2000 * 0.2 * 10;
    const auto rest_at = [&](double safety, double delta_c) {
        const double sigma_c = weight * (safety * slope - friction) / (1 + friction);
        ModelInput input = block_on_slope(
            slope, {.sigma_c = sigma_c, .G_c = 0.5 * sigma_c * delta_c, .gamma = 1, .friction = friction});
        input.supports = {{.on = {.boundary = "bottom", .box = {}}, .law = 1, .glued = true}};
        return rest_of(input);
    };
    check_rests(rest_at(1.12, 1e-3));
    check_rests(rest_at(1.001, 20e-3));
    // friction stays: 10 (slope - friction)
    check_refused(rest_at(0.999, 20e-3),
                  "the preload is more than the interfaces hold, what breaks loose would move away with 4 m/s2, at (");
}

TEST_CASE("a wall of blocks in running bond and an arch start at rest and the ground bears their weight") {
    Bodies wall;
    wall.add(bar_mesh(6, 2, 3, 0.5), {0, -0.5 - below});
    for (int row = 0; row < 4; ++row)
        for (int i = 0; i < 3 - row % 2; ++i) wall.add(bar_mesh(2, 1, 1, 0.5), {i + 0.5 * (row % 2), 0.5 * row});
    ModelInput input = hard(wall, 0.6);
    input.loads = {everywhere(1, -10), held()};
    const Rest standing = rest_of(input);
    check_rests(standing);
    CHECK(standing.reaction.y() == relative(10 * 2000 * (0.5 * 3 + 0.5 * 10), 1e-9));

    Bodies arch;
    for (const double x : {-1.5, 0.9}) arch.add(bar_mesh(2, 1, 0.6, 0.3), {x, -0.3 - below});
    constexpr int n = 7;
    for (int i = 0; i < n; ++i) {
        Mesh stone = bar_mesh(2, 2, 1, 1);
        for (Vec2& x : stone.vertices) {
            const double angle = M_PI * (i + 1 - x.x()) / n, r = 1 + 0.4 * x.y();
            x = {r * std::cos(angle), r * std::sin(angle)};
        }
        arch.add(stone, {0, 0});
    }
    input = hard(arch, 0.7);
    input.loads = {everywhere(0, -10), held()};
    const Rest vaulted = rest_of(input);
    check_rests(vaulted);
    const double stones = n * 0.5 * 2 * std::sin(M_PI / n / 2) * (1.4 * 1.4 - 1);
    CHECK(vaulted.reaction.y() == relative(10 * 2000 * (stones + 0.36), 1e-9));
}

}  // namespace resting_bodies_test
