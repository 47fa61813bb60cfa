// time.mass_scaling: what moves, what is kept, and the step that it allows.
#include "model/mass_scaling.hpp"
#include "element/triangle_matrices.hpp"

#include "properties/wild_body.hpp"
#include "support/bodies.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

namespace mass_scaling_test {

using namespace knap;
using namespace knap::tests;

namespace {

const Elastic rock{.density = 2500, .E = 40e9, .nu = 0.2};

/// 1 x 0.5 m in cells of 50 mm, two of whose triangles are slivers: a vertex lies at a quarter of its height.
Mesh plate_with_slivers(Index order = 1) {
    Mesh mesh = bar_mesh(20, 10, 1, 0.5);
    mesh.vertices[5 * 21 + 10] += Vec2(0, -0.0375);
    mesh.order = order;
    return mesh;
}

ModelInput plate(double most, Index order = 1, const CohesiveLaw& law = CohesiveLaw::unbreakable()) {
    ModelInput input = body_with(plate_with_slivers(order), rock, law);
    input.mass_scaling = most;
    return input;
}

/// [kg] Of the triangles of one side of x = 0.5 m.
double mass_of_half(const Model& model, bool right) {
    double sum = 0;
    for (Index t = 0; t < model.mesh.n_triangles(); ++t)
        if ((model.mesh.centroid(t).x() > 0.5) == right) sum += model.triangle_mass(t);
    return sum;
}

double smallest(const std::vector<double>& steps) { return *std::ranges::min_element(steps); }

}  // namespace

TEST_CASE(
    "mass scaling: a triangle that limits the step gets the mass that the step needs and the body keeps its own") {
    for (const Index order : {1, 2}) {
        const Model model = make_model(plate(0.01, order));
        const std::vector<double> before = stable_steps(model.mesh, model.materials, model.plane),
                                  after = stable_steps(model);
        const double step = smallest(after);
        const auto moved = moved_mass(model);
        REQUIRE(moved);
        MESSAGE("order ", order, ": gain ", moved->gain, ", moved ", moved->moved, ", heavier ", moved->n_heavier,
                ", lighter ", moved->n_lighter);
        CHECK(moved->gain == relative(step / smallest(before), 1e-12));
        CHECK(moved->gain > 1.5);
        CHECK(moved->moved <= 0.01);
        double sum = 0, given = 0;
        for (Index t = 0; t < model.mesh.n_triangles(); ++t) {
            const double factor = model.mass_factor[t];
            CHECK(factor >= 0.75 - 1e-12);
            if (before[t] < step * (1 - 1e-12)) CHECK(factor == relative(std::pow(step / before[t], 2), 1e-9));
            else CHECK(factor <= 1);
            sum += model.triangle_mass(t), given += std::max(0., factor - 1) * model.material_mass(t);
        }
        CHECK(sum == relative(0.5 * 2500, 1e-13));
        CHECK(moved->moved == relative(given / sum, 1e-12));
        double of_corners = 0;
        for (const double mass : model.corner_mass) of_corners += mass;
        CHECK(of_corners == relative(sum, 1e-13));
    }
    CHECK(make_model(plate(0)).mass_factor.empty());
    CHECK(make_model(plate(1e-9)).mass_factor.empty());  // no longer step for so little
    CHECK_FALSE(moved_mass(make_model(plate(0))));
    ModelInput viscous = plate(0.01);
    viscous.materials[0].bulk_viscosity = {0.06, 1.2};
    const Model model = make_model(std::move(viscous));  // a step that viscosity shortens grows more than its root
    CHECK(smallest(stable_steps(model)) > 1.5 * smallest(stable_steps(model.mesh, model.materials, model.plane)));
}

TEST_CASE("mass scaling: nothing moves through a crack of the start or into another material") {
    for (const bool materials : {false, true}) {
        ModelInput input = plate(0.01);
        if (materials) {
            input.materials.push_back({.density = 5000, .E = 40e9, .nu = 0.2});
            input.law_of_pair = {{0, 0}, {0, 0}};
        }
        for (Index t = 0; t < input.mesh.n_triangles() && materials; ++t)
            input.mesh.region[t] = input.mesh.centroid(t).x() > 0.5;
        for (InteriorEdge& edge : input.mesh.interior_edges)
            edge.cracked = !materials && (input.mesh.centroid(edge.triangle[0]).x() > 0.5) !=
                                             (input.mesh.centroid(edge.triangle[1]).x() > 0.5);
        const Model model = make_model(std::move(input));
        REQUIRE(!model.mass_factor.empty());
        for (const bool right : {false, true}) {
            double of_material = 0;
            for (Index t = 0; t < model.mesh.n_triangles(); ++t)
                if ((model.mesh.centroid(t).x() > 0.5) == right) of_material += model.material_mass(t);
            CHECK(mass_of_half(model, right) == relative(of_material, 1e-13));
        }
    }
}

TEST_CASE("mass scaling: a body falls with g and stands with its weight") {
    constexpr double g = 9.81;
    for (const bool turns : {false, true}) {
        ModelInput input = plate(0.01);
        input.large_rotation = turns;
        input.loads = {{.kind = Load::Kind::acceleration, .value = {0., -g}}};
        Run run(std::move(input));
        Vec2 weight = Vec2::Zero();
        for (const CornerLoad& load : run.model.corner_loads) weight += load.force;
        CHECK(weight.y() == relative(-0.5 * 2500 * g, 1e-13));
        const double h = run.stepper.stable_step();
        for (int i = 0; i < 400; ++i) run.step(h);
        const double v = run.now.velocity[0].y();
        double spread = 0;
        for (const Vec2& velocity : run.now.velocity) spread = std::max(spread, (velocity - Vec2(0, v)).norm());
        CHECK(v == relative(-g * (run.now.time - 0.5 * h), 1e-12));
        CHECK(spread < 1e-10 * std::abs(v));
        CHECK(run.ledger.row().strain < 1e-12 * run.ledger.row().kinetic);
    }
}

TEST_CASE("mass scaling: random bodies that break keep their momentum and close their balance at the longer step") {
    int n = 0, n_free = 0, n_broken = 0;
    double worst = 0, largest_gain = 1;
    for (std::uint64_t seed = 0; seed < 150; ++seed) {
        WildBody wild = WildBodies(seed).body();
        if (wild.body.scheme.bulk != BulkScheme::explicit_lumped) continue;
        wild.body.input.mass_scaling = 0.05;
        Run run(wild.body.input, wild.body.scheme);
        const auto moved = moved_mass(run.model);
        if (!moved) continue;
        largest_gain = std::max(largest_gain, moved->gain);
        // finite strains shorten the step of wild bodies that turn, with and without it
        const double h = (run.model.large_rotation ? 0.7 : 1) * wild.safety * run.stepper.stable_step();
        INFO("seed " << seed);
        const auto energy = [&] { return run.ledger.row().kinetic + run.ledger.row().strain; };
        const auto momentum = [&] { return run.mean_velocity([](Index) { return true; }); };
        const bool is_free =
            run.model.corner_loads.empty() && run.model.prescribed.empty() && run.model.obstacles.empty() &&
            run.model.crack_fluids.empty() && wild.body.scheme.absorbing.empty() && wild.body.scheme.damping == 0 &&
            std::ranges::none_of(run.model.interfaces,
                                 [](const Interface& interface) { return interface.triangle[0] == rigid_support; });
        const Vec2 start = momentum();
        double size = std::abs(energy()), speed = 0, error = 0;
        for (int i = 0; i < wild.n_steps && run.step_if_taken(h); ++i) {
            for (const Vec2& v : run.now.velocity) speed = std::max(speed, v.norm());
            size = std::max(size, run.ledger.largest_energy());
            error = std::max(error, run.ledger.largest_residual());
        }
        CHECK(error <= 1e-12 * size);
        if (is_free) {
            CHECK((momentum() - start).norm() <= 1e-12 * speed);
            ++n_free;
        }
        worst = std::max(worst, error / size), ++n;
        for (const PointState& point : run.now.points) n_broken += point.cohesion == 0;
    }
    MESSAGE(n, " bodies, ", n_free, " of them free, ", n_broken, " broken points; error of the balance ", worst,
            ", largest gain ", largest_gain);
    CHECK(n > 20);
    CHECK(n_broken > 50);
}

TEST_CASE("mass scaling: a wave of many edges is what it is without") {
    const auto end_of = [](double most) {
        Run run(plate(most));
        for (Index c = 0; c < run.model.mesh.n_corners(); ++c)
            run.now.velocity[run.now.node_of_corner[c]] =
                Vec2(std::cos(3.14159265358979 * run.model.mesh.corner(c).x()), 0);
        run.ledger = EnergyLedger(run.model, run.now);
        const double h = 200e-6 / 400;  // four fifths of half a period
        for (int i = 0; i < 400; ++i) run.step(h);
        return run.mean_velocity([&](Index t) { return run.model.mesh.centroid(t).x() < 0.5; }).x();
    };
    CHECK(end_of(0.01) == relative(end_of(0), 5e-3));  // a hundredth of the mass stands elsewhere
}

}  // namespace mass_scaling_test
