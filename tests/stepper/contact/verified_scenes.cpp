// Reference cases of fragments that meet: rubble comes to rest, a disc breaks, the faces of a zigzag joint slide.
#include "analysis/fragments.hpp"
#include "base/random.hpp"
#include "support/obstacle_shapes.hpp"
#include "support/overlap.hpp"
#include "support/pieces.hpp"
#include "support/several_bodies.hpp"
#include "support/verification.hpp"

#include <doctest/doctest.h>

#include <numbers>

namespace verified_scenes_test {

using namespace knap;
using namespace knap::tests;

namespace {

constexpr double pi = std::numbers::pi;

struct Rubble {
    double kinetic;             // [-] at the end, over the largest energy
    double identity;            // [-] likewise
    double deepest_in_impacts;  // [-] of an edge, by the contacts
    double deepest_at_rest;     // [-] of an edge, of two triangles, by their places
    double moved;               // [-] of an edge, in the last tenth of the steps
    double injected;            // [-] positive works of contacts over what was dissipated
    double outside;             // [m] beyond the box
};

/// Irregular polygons of 5 to 7 triangles fall from random places of a lattice into a box of half planes.
Rubble pour(int columns, int rows, double E, int n_steps) {
    const double radius = 0.05, cell = 2.1 * radius, damping = 5;
    Random random(7, "rubble");
    Bodies bodies;
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i) {
            const int n = 5 + static_cast<int>(random.uniform(0, 3));
            std::vector<Vec2> outline;
            for (int k = 0; k < n; ++k) {
                const double angle = 2 * pi * (k + random.uniform(-0.2, 0.2)) / n;
                outline.push_back(turned({radius * random.uniform(0.7, 1), 0}, angle));
            }
            bodies.add(star_mesh(outline), cell * Vec2(i + 0.5, j + 0.5), random.uniform(0, 2 * pi));
        }
    const double width = cell * columns;
    ModelInput input = bodies.input({.friction = 0.5, .restitution = 0});
    for (Elastic& each : input.materials) each.E = E;
    input.loads = {{.kind = Load::Kind::acceleration, .value = {0, -10}}};
    const ContactLaw touch{.friction = 0.5};
    input.obstacles = {platen({0, 0}, {0, 1}, touch), platen({0, 0}, {1, 0}, touch),
                       platen({width, 0}, {-1, 0}, touch)};
    Run run(std::move(input), {.damping = damping, .damping_of = DampingOf::motion});
    const double h = 0.8 * run.stepper.stable_step();
    std::vector<Vec2> before;
    for (int i = 0; i < n_steps; ++i) {
        if (i == n_steps - n_steps / 10) before = run.now.displacement;
        for (double part = h; !run.step_if_taken(part); part /= 2) REQUIRE(part > 1e-3 * h);
    }
    Rubble found{};
    const EnergyRow& row = run.ledger.row();
    found.kinetic = row.kinetic / run.ledger.largest_energy();
    found.identity = run.ledger.largest_residual() / run.ledger.largest_energy();
    found.deepest_in_impacts = run.ledger.worst().contact_depth;
    found.deepest_at_rest = largest_overlap(run.model, run.now).of_shortest;
    found.injected = -run.ledger.worst().contact_injection / (row.impact_work + row.friction_work);
    for (std::size_t n = 0; n < before.size(); ++n)
        found.moved = std::max(found.moved, (run.now.displacement[n] - before[n]).norm() / radius);
    for (Index c = 0; c < run.model.mesh.n_corners(); ++c) {
        const Vec2 x = place(run.model, run.now, c);
        found.outside = std::max({found.outside, -x.x(), x.x() - width, -x.y()});
    }
    return found;
}

void verify_rubble(const Rubble& found) {
    on_path("explicit, explicit");
    verify_small("identity over the largest energy", found.identity, {1e-12, 1e-13});
    verify_small("kinetic energy at the end over the largest energy", found.kinetic, {1e-6, 1e-12});
    verify_small("deepest in impacts, of an edge", found.deepest_in_impacts, {2e-2, 1e-2});
    verify_small("deepest at the end, of an edge, of any two triangles", found.deepest_at_rest, {1e-3, 2e-4});
    verify_small("largest path in the last tenth of the steps, of an edge", found.moved, {1e-2, 1e-4});
    verify_small("positive works of contacts over what was dissipated", found.injected, {1e-6, 1e-9});
    verify_small("beyond the box, m", found.outside, {5e-5, 5e-6});
}

/// 6 n^2 triangles round a centre.
Mesh disc_mesh(int n, double radius) {
    Mesh mesh;
    mesh.vertices.push_back({0, 0});
    const auto at = [](int ring, int k) { return ring == 0 ? 0 : 1 + 3 * ring * (ring - 1) + k % (6 * ring); };
    for (int ring = 1; ring <= n; ++ring)
        for (int k = 0; k < 6 * ring; ++k)
            mesh.vertices.push_back(turned({radius * ring / n, 0}, 2 * pi * k / (6 * ring)));
    for (int ring = 1; ring <= n; ++ring)
        for (int sector = 0; sector < 6; ++sector)
            for (int k = 0; k < ring; ++k) {
                const Index a = at(ring, sector * ring + k), b = at(ring, sector * ring + k + 1),
                            c = at(ring - 1, sector * (ring - 1) + k);
                mesh.triangles.push_back({a, b, c});
                if (k > 0) mesh.triangles.push_back({a, c, Index(at(ring - 1, sector * (ring - 1) + k - 1))});
            }
    mesh.region.assign(mesh.triangles.size(), 0);
    return mesh;
}

}  // namespace

TEST_CASE("E22 rubble of 20 pieces comes to rest in a box") {
    describe(
        "20 irregular polygons of 5 to 7 triangles (radius 35 to 50 mm, E = 25 MPa, friction 0.5, restitution 0) "
        "fall into a box of rigid planes, with a damping of 5 /s. Reference: conservation laws; nothing may lie in "
        "anything. Edges are about as long as the radius.");
    verify_rubble(pour(4, 5, 2.5e7, 30000));
}

TEST_CASE("E23 rubble of 100 pieces comes to rest in a box" * doctest::test_suite("slow")) {
    describe("As E22, with 100 polygons and E = 100 MPa.");
    verify_rubble(pour(10, 10, 1e8, 80000));
}

TEST_CASE("E24 a disc breaks on a wall") {
    describe(
        "A disc of 600 triangles (radius 0.5 m, E = 1 GPa, rod wave speed 707 m/s, strength 5 MPa, 100 J/m2) hits a "
        "rigid wall without friction with 20 m/s. Reference: conservation laws; nothing may lie in anything.");
    on_path("explicit, explicit");
    ModelInput input;
    input.mesh = disc_mesh(10, 0.5);
    find_edges(input.mesh);
    input.mesh.boundary_names = {"free"};
    input.materials = {{.density = 2000, .E = 1e9, .nu = 0.2}};
    input.laws = {{.sigma_c = 5e6, .G_c = 100, .gamma = 1, .friction = 0.5}};
    input.law_of_pair = {{0}};
    input.contact_of_pair = {{ContactLaw{.friction = 0.5}}};
    input.large_rotation = true;
    input.obstacles = {platen({0, -0.5 - 1e-4}, {0, 1})};
    input.initial_velocities = {{.value = {3, -20}}};
    Run run(std::move(input));
    const double h = 0.4 * run.stepper.stable_step();
    double mass = 0;
    for (const double m : run.model.corner_mass) mass += m;
    while (run.now.time < 0.012)
        for (double part = h; !run.step_if_taken(part); part /= 2) REQUIRE(part > 1e-3 * h);
    Vec2 momentum = Vec2::Zero();
    for (Index c = 0; c < run.model.mesh.n_corners(); ++c)
        momentum += run.model.corner_mass[c] * run.now.velocity[run.now.node_of_corner[c]];
    const EnergyRow& row = run.ledger.row();
    verify_at_least("fragments", double(find_fragments(run.model, run.now).pieces.size()), 20);
    verify_small("identity over the largest energy", run.ledger.largest_residual() / run.ledger.largest_energy(),
                 {1e-12, 1e-13});
    verify_small("change of the momentum along the wall over it", momentum.x() / (3 * mass) - 1, {1e-12, 1e-13});
    verify_small("deepest at the end, of an edge, of any two triangles",
                 largest_overlap(run.model, run.now).of_shortest, {2e-2, 1e-3});
    verify_small("deepest of all contacts, of an edge", run.ledger.worst().contact_depth, {2e-2});
    verify_small("positive works of contacts over what was dissipated",
                 -run.ledger.worst().contact_injection / (row.impact_work + row.friction_work), {1e-3, 1e-6});
}

TEST_CASE("E25 the teeth of a zigzag joint slide over each other") {
    describe(
        "Two bars with a broken zigzag joint of slope s = 0.3 between them (teeth of 1 m, edges of 0.52 m): 4 teeth "
        "under "
        "the weight W = M g of the upper one, which is driven at v = 20 mm/s, with a damping alpha of 5 /s that takes "
        "its ringing (with 0.5 /s the friction is 4 % low, since contacts stick for moments). Points of the joint "
        "retire "
        "at a slip of 0.01 of an edge; then free faces meet. Reference: F = (W + M w s) tan(atan(s) + atan(mu)) + M w "
        "with w = alpha v + dv/dt on the rising flank, with -s on the falling one; means over a slip of 0.2 m. Lift: "
        "slope times slip.");
    on_path("explicit, explicit");
    const double slope = 0.3, v = 0.02, alpha = 5, g = 1;
    for (const double mu : {0.0, 0.3}) {
        const int first = 4, last = 12, n = 20;  // cells of the upper bar, and of the lower one
        ModelInput input;
        Mesh& mesh = input.mesh;
        const Mesh full = bar_mesh(n, 4, 0.5 * n, 2);
        std::vector<Index> number(full.vertices.size(), -1);
        for (std::size_t t = 0; t < full.triangles.size(); ++t) {
            const int cell = static_cast<int>(t / 2), row = cell / n, column = cell % n;
            if (row >= 2 && (column < first || column >= last)) continue;
            std::array<Index, 3> corners{};
            for (int k = 0; k < 3; ++k) {
                const Index old = full.triangles[t][k];
                if (number[old] < 0) {
                    number[old] = mesh.n_vertices();
                    Vec2 x = full.vertices[old];
                    if (old / (n + 1) == 2) x.y() += (old % (n + 1) % 2 == 0 ? -0.25 : 0.25) * slope;
                    mesh.vertices.push_back(x);
                }
                corners[k] = number[old];
            }
            mesh.triangles.push_back(corners);
            mesh.region.push_back(row / 2);
        }
        find_edges(mesh);
        mesh.boundary_names = {"free"};
        for (InteriorEdge& edge : mesh.interior_edges)
            edge.cracked = mesh.region[edge.triangle[0]] != mesh.region[edge.triangle[1]];
        input.materials.assign(2, {.density = 2000, .E = 1e7, .nu = 0.2});
        input.laws = {CohesiveLaw::unbreakable(), {.sigma_c = 1, .G_c = 1, .gamma = 1, .friction = mu}};
        input.law_of_pair = {{0, 1}, {1, 0}};
        input.contact_of_pair.assign(2, std::vector<ContactLaw>(2, {.friction = mu}));
        input.large_rotation = true;
        const double settle = 4, ramp = 2;
        input.loads = {{.kind = Load::Kind::acceleration, .value = {0, -g}, .history = {{0, 2}, {0, 1}}},
                       {.kind = Load::Kind::displacement, .on = {.box = Box{{-1, -1}, {20, 0.01}}}, .value = {0, 0}},
                       {.kind = Load::Kind::velocity,
                        .on = {.box = Box{{-1, 1.99}, {20, 3}}},
                        .value = {v, std::nullopt},
                        .history = {{settle, settle + ramp}, {0, 1}}}};
        Run run(std::move(input), {.damping = alpha, .damping_of = DampingOf::motion});
        const double h = 0.8 * run.stepper.stable_step();
        double M = 0, rest = 0;
        for (Index c = 0; c < run.model.mesh.n_corners(); ++c)
            if (run.model.mesh.region[c / 3] == 1) M += run.model.corner_mass[c];
        const double W = M * g;
        const auto lift = [&] {
            double sum = 0;
            for (Index c = 0; c < run.model.mesh.n_corners(); ++c)
                if (run.model.mesh.region[c / 3] == 1)
                    sum += run.model.corner_mass[c] / M * run.now.displacement_of(c).y();
            return sum;
        };
        struct Mean {
            double from, to, sum = 0;
            int n = 0;
            double value() const { return sum / n; }
        };
        Mean rising{0.15, 0.35}, falling{0.65, 0.85}, second{1.15, 1.35}, live{0.002, 0.0045}, free{0.006, 0.012};
        const auto expected = [&](double s, double w) {  // [-] over the weight
            return (1 + w / g * s) * std::tan(std::atan(s) + std::atan(mu)) + w / g;
        };
        double off_lift = 0, slip = 0;
        long retired = 0;
        const double last_slip = mu > 0 ? 1.4 : 0.45;  // without friction the first flank only
        while (slip < last_slip) {
            REQUIRE(run.step(h).rejection == Rejection::none);
            if (run.now.time < settle) {
                rest = lift();
                continue;
            }
            const double t = run.now.time - settle;
            slip = t < ramp ? 0.5 * v * t * t / ramp : v * (t - 0.5 * ramp);
            const double w = alpha * v * std::min(t / ramp, 1.0) + (t < ramp ? v / ramp : 0);
            double force = 0;
            for (std::size_t i = 0; i < run.model.prescribed.size(); ++i)
                if (!run.model.prescribed[i].is_displacement[0]) force += run.now.reaction[i].x();
            for (Mean* mean : {&rising, &falling, &second, &live, &free})
                if (slip > mean->from && slip < mean->to) {
                    mean->sum += force / W - expected(mean == &falling ? -slope : slope, w);
                    ++mean->n;
                }
            if (slip < 0.45) off_lift = std::max(off_lift, std::abs(lift() - rest - slope * slip));
            retired = std::ranges::count(run.now.retired, Retirement::retired);
        }
        const std::string at = ", mu = " + digits(mu);
        const double w = alpha * v, up = expected(slope, w), down = expected(-slope, w);
        verify_near("force over weight, rising flank" + at, up + rising.value(), up, {0.02, 0.005});
        if (mu > 0) {
            verify_near("force over weight, next rising flank" + at, up + second.value(), up, {0.02, 0.005});
            verify_near("force over weight, falling flank" + at, down + falling.value(), down, {0.02, 0.005});
        }
        verify_small("jump of the force over weight at the hand-over" + at, free.value() - live.value(), {0.02, 0.005});
        verify_small("deviation of the lift on the first flank, m" + at, off_lift, {2e-3, 5e-4});
        verify_at_least("points retired" + at, double(retired), 16);
        verify_small("deepest of all contacts, of an edge" + at, run.ledger.worst().contact_depth, {2e-2, 2e-3});
        verify_small("identity over the largest energy" + at,
                     run.ledger.largest_residual() / run.ledger.largest_energy(), {1e-12, 1e-13});
        verify_small(
            "positive works of contacts over what was dissipated" + at,
            -run.ledger.worst().contact_injection / (run.ledger.row().impact_work + run.ledger.row().friction_work),
            {1e-6, 1e-9});
    }
}

}  // namespace verified_scenes_test
