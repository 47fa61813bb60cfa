// time.mass_scaling: what moves, what is kept, and the step that it allows.
#include "model/mass_scaling.hpp"
#include "base/union_find.hpp"
#include "element/triangle_matrices.hpp"

#include "properties/wild_body.hpp"
#include "support/bodies.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

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

/// Largest relative difference between the mass of a piece and that of its material. Pieces hang together by edges of
/// one material that bear tension and have both triangles in the region, or neither.
double error_of_pieces(
    const Model& model, const std::function<bool(Vec2)>& region = [](Vec2) { return false; }) {
    const Mesh& mesh = model.mesh;
    UnionFind pieces(mesh.n_triangles());
    for (const Interface& interface : model.interfaces) {
        const auto [a, b] = interface.triangle;
        if (a != rigid_support && mesh.region[a] == mesh.region[b] && !interface.cracked &&
            model.laws[interface.law].sigma_c > 0 && region(mesh.centroid(a)) == region(mesh.centroid(b)))
            pieces.join(a, b);
    }
    std::map<Index, std::array<double, 2>> mass;
    for (Index t = 0; t < mesh.n_triangles(); ++t)
        mass[pieces.find(t)][0] += model.triangle_mass(t), mass[pieces.find(t)][1] += model.material_mass(t);
    double error = 0;
    for (const auto& [root, of] : mass) error = std::max(error, std::abs(of[0] / of[1] - 1));
    return error;
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

TEST_CASE("mass scaling: each piece has its mass between cracks and open joints and materials and cuts") {
    enum Border { none, whole_joint, crack, cracked_joint, open_joint, material, cut };
    const auto is_above = [](Vec2 x) { return x.y() > 0.2; };  // the slivers lie on this line
    for (const Border border : {none, whole_joint, crack, cracked_joint, open_joint, material, cut}) {
        ModelInput input = plate(0.01);
        Mesh& mesh = input.mesh;
        input.laws.push_back({.sigma_c = border == open_joint ? 0 : 1e6, .G_c = 10, .friction = 0.5});
        input.law_of_joint = {1};
        if (border == material) {
            input.materials.push_back({.density = 5000, .E = 40e9, .nu = 0.2});
            input.law_of_pair = {{0, 0}, {0, 0}};
            for (Index t = 0; t < mesh.n_triangles(); ++t) mesh.region[t] = is_above(mesh.centroid(t));
        }
        if (border == cut) input.cuts = {{{-1, 0.2}, {2, 0.2}, {2, 1}, {-1, 1}}};
        for (InteriorEdge& edge : mesh.interior_edges) {
            if (is_above(mesh.centroid(edge.triangle[0])) == is_above(mesh.centroid(edge.triangle[1]))) continue;
            if (border == whole_joint || border == cracked_joint || border == open_joint) edge.joint = 0;
            edge.cracked = border == crack || border == cracked_joint;
        }
        const Model model = make_model(std::move(input));
        INFO("border ", int(border));
        REQUIRE(!model.mass_factor.empty());
        if (border == none || border == whole_joint) CHECK(error_of_pieces(model, is_above) > 1e-4);
        else CHECK(error_of_pieces(model, is_above) < 1e-14);
    }
}

TEST_CASE("mass scaling: a body that flies and spins keeps its momenta") {
    ModelInput input = plate(0.01);
    input.large_rotation = true;
    Run run(std::move(input));
    REQUIRE(!run.model.mass_factor.empty());
    for (Index c = 0; c < run.model.mesh.n_corners(); ++c)
        run.now.velocity[run.now.node_of_corner[c]] =
            Vec2(30, -20) + 100 * turned_left(run.model.mesh.corner(c) - Vec2(0.5, 0.25));
    const auto momenta = [&] {  // the angular one at the middle of the step: x + h/2 v and x have the same
        Vec3 sum = Vec3::Zero();
        for (Index c = 0; c < run.model.mesh.n_corners(); ++c) {
            const Index node = run.now.node_of_corner[c];
            const Vec2 v = run.now.velocity[node], x = run.model.mesh.corner(c) + run.now.displacement[node];
            sum += run.model.corner_mass[c] * Vec3(v.x(), v.y(), cross(x, v));
        }
        return sum;
    };
    const Vec3 start = momenta();
    const double h = 0.8 * run.stepper.stable_step();
    for (int i = 0; i < 400; ++i) run.step(h);
    for (int k = 0; k < 3; ++k) CHECK(momenta()[k] == relative(start[k], 1e-14));
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
        CHECK(error_of_pieces(run.model) < 1e-14);
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
