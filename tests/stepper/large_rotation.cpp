// Large rotations with the explicit bulk: a body that turns far keeps its energy and its angular momentum, its cracks
// do not depend on how it is turned, and small displacements give what they give with small rotations.
#include "model/make_model.hpp"
#include "support/bodies.hpp"
#include "support/relative.hpp"
#include "support/verification.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace large_rotation_test {

using namespace knap;
using namespace knap::tests;

namespace {

constexpr double pi = std::numbers::pi;
const Elastic rock{.density = 2500, .E = 40e9, .nu = 0.2};

ModelInput body(Mesh mesh, const CohesiveLaw& law) { return turning_body(std::move(mesh), rock, law); }

// ---- T1: the free square

struct Turns {
    double identity, momentum, largest_Q, Q_drift, largest_U;  // over the largest energy, momentum, and U
};

/// A square of 8 x 8 cells and 1 m that turns ten times with this rim speed over the wave speed and a wave of stretch.
Turns turn(double rim_speed, double step) {
    Run run(body(bar_mesh(8, 8, 1, 1), CohesiveLaw::unbreakable()));
    const double c = rock.dilatational_speed(PlaneModel::strain), spin = rim_speed * c / 0.5;
    const Vec2 centre(0.5, 0.5);
    const auto arm = [&](Index corner) { return Vec2(run.model.mesh.corner(corner) - centre); };
    for (Index corner = 0; corner < run.model.mesh.n_corners(); ++corner)
        run.now.velocity[run.now.node_of_corner[corner]] =
            spin * turned_left(arm(corner)) + 1e-3 * c * Vec2(std::sin(pi * arm(corner).x()), 0);
    run.ledger = EnergyLedger(run.model, run.now);
    const auto angular_momentum = [&] {  // at the middle of the step: x + h/2 v and x have the same
        double sum = 0;
        for (Index corner = 0; corner < run.model.mesh.n_corners(); ++corner) {
            const Index node = run.now.node_of_corner[corner];
            sum +=
                run.model.corner_mass[corner] * cross(arm(corner) + run.now.displacement[node], run.now.velocity[node]);
        }
        return sum;
    };
    const double start = angular_momentum(), end = 10 * 2 * pi / spin, h = step * run.stepper.stable_step();
    Turns found{};
    double first = 0, last = 0, n_first = 0, n_last = 0;
    while (run.now.time < end) {
        run.step(h);
        const double Q = run.ledger.row().rotation_work;
        found.largest_U = std::max(found.largest_U, run.now.elastic_energy);
        if (run.now.time < 0.1 * end) first += Q, n_first += 1;
        if (run.now.time > 0.9 * end) last += Q, n_last += 1;
        found.momentum = std::max(found.momentum, std::abs(angular_momentum() / start - 1));
    }
    found.identity = run.ledger.largest_residual() / run.ledger.largest_energy();
    found.largest_Q = run.ledger.largest_rotation_work() / found.largest_U;
    found.Q_drift = std::abs(last / n_last - first / n_first) / found.largest_U;
    return found;
}

// ---- a scene and the same scene turned

/// Mesh, initial velocities [m/s] by place, and whatever else acts, turned by this angle; the mesh is not turned, but
/// the body at the start: large rotation must not see it.
struct Scene {
    ModelInput input;
    std::function<Vec2(const Vec2&)> velocity;
    int n_steps;
};

struct Ended {
    std::vector<Vec2> place, velocity;  // per corner, turned back
    std::vector<double> cohesion;       // per point
    std::vector<Vec2> opening, traction;
    double identity;
    std::int64_t softened;
};

Ended run_turned(Scene scene, double angle) {
    for (Load& load : scene.input.loads) {
        if (load.kind == Load::Kind::stress) continue;  // a pressure follows its face
        const Vec2 value = turned(load.vector(), angle);
        load.value = {value.x(), value.y()};
    }
    for (Obstacle& obstacle : scene.input.obstacles) {
        obstacle.start.position = turned(obstacle.start.position, angle);
        obstacle.start.angle += angle;
    }
    std::vector<Obstacle> obstacles = std::move(scene.input.obstacles);
    scene.input.obstacles.clear();
    Model model = make_model(std::move(scene.input));  // obstacles are checked against the body that is not turned
    model.obstacles = std::move(obstacles);
    Run run(std::move(model));
    for (Index c = 0; c < run.model.mesh.n_corners(); ++c) {
        const Index node = run.now.node_of_corner[c];
        const Vec2 x = run.model.mesh.corner(c);
        run.now.displacement[node] = turned(x, angle) - x;
        run.now.velocity[node] = turned(scene.velocity(x), angle);
    }
    run.ledger = EnergyLedger(run.model, run.now);
    const double h = 0.4 * run.stepper.stable_step();
    for (int i = 0; i < scene.n_steps; ++i) REQUIRE(run.step(h).rejection == Rejection::none);
    Ended ended{};
    for (Index c = 0; c < run.model.mesh.n_corners(); ++c) {
        const Index node = run.now.node_of_corner[c];
        ended.place.push_back(turned(run.model.mesh.corner(c) + run.now.displacement[node], -angle));
        ended.velocity.push_back(turned(run.now.velocity[node], -angle));
    }
    for (Index p = 0; p < run.model.n_points(); ++p) {
        ended.cohesion.push_back(cohesion(run.model, run.now, p));
        ended.opening.push_back(opening(run.model, run.now, p));
        ended.traction.push_back(traction(run.model, run.now, p));
    }
    ended.identity = run.ledger.largest_residual() / run.ledger.largest_energy();
    ended.softened = run.ledger.worst().softened;
    return ended;
}

double difference(const std::vector<Vec2>& a, const std::vector<Vec2>& b) {
    double worst = 0;
    for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, (a[i] - b[i]).norm());
    return worst;
}

double largest(const std::vector<Vec2>& a) {
    double found = 0;
    for (const Vec2& x : a) found = std::max(found, x.norm());
    return found;
}

/// Breaking and impacts amplify rounding, hence the tolerance.
void check_turns(const Scene& scene, double tolerance = 1e-8) {
    const Ended straight = run_turned(scene, 0);
    CHECK(straight.identity <= 1e-13);
    std::int64_t damaged = 0, broken = 0;
    for (const double beta : straight.cohesion) damaged += beta > 0 && beta < 1, broken += beta == 0;
    MESSAGE(damaged, " damaged points, ", broken, " broken ones");
    CHECK(damaged > 0);
    CHECK(broken > 0);
    for (const double angle : {0.5 * pi, 1.0, -2.7}) {
        CAPTURE(angle);
        const Ended found = run_turned(scene, angle);
        CHECK(found.identity <= 1e-13);
        CHECK(difference(found.place, straight.place) <= tolerance * largest(straight.place));
        CHECK(difference(found.velocity, straight.velocity) <= tolerance * largest(straight.velocity));
        CHECK(difference(found.opening, straight.opening) <= tolerance * largest(straight.opening));
        CHECK(difference(found.traction, straight.traction) <= 10 * tolerance * largest(straight.traction));
        double beta = 0;
        for (std::size_t i = 0; i < found.cohesion.size(); ++i)
            beta = std::max(beta, std::abs(found.cohesion[i] - straight.cohesion[i]));
        CHECK(beta <= 1e-3 * tolerance / 1e-9);
    }
}

const CohesiveLaw glue{.sigma_c = 5e6, .G_c = 20, .gamma = 1, .friction = 0.5};

}  // namespace

TEST_CASE("E21 a free square turns ten times") {
    describe(
        "A free square of 8 x 8 cells with Green's strain turns ten times with a wave of stretch in it (velocity 1e-3, "
        "rim "
        "speed 0.02 of the dilatational wave speed). Q: cumulated defect of the elastic energy in the leapfrog energy "
        "(rotation work), U: largest elastic energy. Reference: conservation laws, and order 2 of central "
        "differences. Q is below 1e-3 of U only below 0.37 of the stable step.");
    on_path("explicit, explicit");
    const Turns coarse = turn(0.02, 0.8), middle = turn(0.02, 0.4), fine = turn(0.02, 0.2);
    double aim = 2e-2;
    for (const auto& [name, found] : {std::pair{"0.8", coarse}, {"0.4", middle}, {"0.2", fine}}) {
        aim /= 4;  // order 2
        const std::string at = std::string(", ") + name + " of the stable step";
        verify_small("identity over the largest energy" + at, found.identity, {1e-14, 1e-14});
        verify_small("change of the angular momentum over it" + at, found.momentum, {1e-13});
        verify_small("largest Q over U" + at, found.largest_Q, {aim, aim});
        verify_small("change of mean Q from the first to the tenth turn, over U" + at, found.Q_drift, {1e-5, 1e-5});
    }
    verify_near("order of Q in h, 0.8 to 0.4", std::log2(coarse.largest_Q / middle.largest_Q), 2, {0.1});
    verify_near("order of Q in h, 0.4 to 0.2", std::log2(middle.largest_Q / fine.largest_Q), 2, {0.1});
}

TEST_CASE("cracks of a free body do not depend on how it is turned") {
    // pulled apart along x and sheared by its initial motion, with some spin
    check_turns({body(bar_mesh(12, 4, 0.3, 0.1), glue),
                 [](const Vec2& x) { return Vec2(40 * (x.x() - 0.1), 25 * x.x() - 30 * x.y()); }, 100});
}

TEST_CASE("a pressure follows the face of a turned body") {
    Scene scene{body(bar_mesh(10, 4, 0.25, 0.1), glue), [](const Vec2& x) { return Vec2(60 * (x.x() - 0.1), 0); }, 250};
    Load pressure{.kind = Load::Kind::stress, .on = {.boundary = "top", .box = {}}};
    pressure.stress = {-2e6, -2e6, 0};
    pressure.history = {.time = {0, 1e-5}, .value = {0, 1}};
    scene.input.loads = {pressure, load(Load::Kind::traction, "right", 3e6, 1e6),
                         load(Load::Kind::acceleration, "", 0, -1e4)};
    check_turns(scene);
}

TEST_CASE("an obstacle meets a turned body") {
    Scene scene{body(bar_mesh(8, 8, 0.2, 0.2), glue),
                [](const Vec2& x) { return Vec2(3 - 20 * x.y(), -25 + 20 * x.x()); }, 150};
    Obstacle floor{.name = "floor", .outline = {.kind = Outline::Kind::half_plane}};
    floor.start.position = {0, -1e-4};
    floor.contact.friction = 0.4;
    scene.input.obstacles = {floor};
    Obstacle stone{
        .name = "stone", .outline = {.kind = Outline::Kind::disc, .radius = 0.05}, .mass = 5, .inertia = 0.01};
    stone.start.position = {0.1, 0.2501};
    for (Drive& drive : stone.drive) drive.kind = Drive::Kind::free;
    scene.input.obstacles.push_back(stone);
    check_turns(scene);
}

TEST_CASE("where displacements are small both switches give the same crack") {
    // a bar with a weak middle is pulled at both ends; the strain at the strength is 1e-4
    const auto pulled = [](bool large_rotation) {
        ModelInput input = body(bar_mesh(16, 4, 0.4, 0.1), glue);
        input.large_rotation = large_rotation;
        input.loads = {load(Load::Kind::velocity, "left", -0.4, 0.0), load(Load::Kind::velocity, "right", 0.4, 0.1)};
        Run run(std::move(input));
        const double h = 0.5 * run.stepper.stable_step();
        while (run.now.time < 1.2e-4) run.step(h);
        CHECK(run.ledger.largest_residual() <= 1e-13 * run.ledger.largest_energy());
        CHECK((run.ledger.row().rotation_work != 0) == large_rotation);
        return std::pair{run.ledger.row(), run.now};
    };
    const auto [small, small_end] = pulled(false);
    const auto [large, large_end] = pulled(true);
    CHECK(small.dissipated > 0);
    CHECK(large.dissipated == relative(small.dissipated, 5e-3));
    CHECK(large.external_work == relative(small.external_work, 5e-3));
    REQUIRE(large_end.displacement.size() == small_end.displacement.size());
    CHECK(large_end.split_fans == small_end.split_fans);
    CHECK(difference(large_end.displacement, small_end.displacement) <= 5e-3 * largest(small_end.displacement));
}

TEST_CASE("a partly open joint that turns rigidly keeps its opening and its traction") {
    // a square cut by one interface, which first opens by part of its critical opening; then the state is turned
    ModelInput input = body(bar_mesh(2, 1, 0.02, 0.01), glue);
    Model model = make_model(std::move(input));
    Run run(std::move(model));
    for (Index c = 0; c < run.model.mesh.n_corners(); ++c)
        run.now.velocity[run.now.node_of_corner[c]].x() = 4 * (run.model.mesh.corner(c).x() - 0.01) / 0.01;
    const double h = 0.2 * run.stepper.stable_step();
    const double a_third = 0.3 * energy_of_all_interfaces(run.model);
    while (run.ledger.row().surface() < a_third && run.now.n_steps < 1000) run.step(h);
    State turned_state = run.now;
    const double angle = 0.5 * pi;
    for (Index c = 0; c < run.model.mesh.n_corners(); ++c) {
        const Index node = run.now.node_of_corner[c];
        const Vec2 x = run.model.mesh.corner(c);
        turned_state.displacement[node] = turned(x + run.now.displacement[node], angle) - x;
        turned_state.velocity[node] = turned(run.now.velocity[node], angle);
    }
    Index n_partly = 0;
    for (Index p = 0; p < run.model.n_points(); ++p) {
        const double beta = cohesion(run.model, run.now, p);
        n_partly += beta > 0 && beta < 1;
        CHECK((opening(run.model, turned_state, p) - opening(run.model, run.now, p)).norm() <= 1e-16);
    }
    CHECK(n_partly > 0);
    State end, turned_end;
    const StepReport report = run.stepper.step(run.now, h, end),
                     of_turned = run.stepper.step(turned_state, h, turned_end);
    CHECK(report.cohesive_work > 0);
    CHECK(of_turned.cohesive_work == relative(report.cohesive_work, 1e-9));
    for (std::size_t i = 0; i < end.points.size(); ++i) {
        CHECK(std::abs(turned_end.points[i].cohesion - end.points[i].cohesion) <= 1e-10);
        CHECK((turned_end.points[i].traction - end.points[i].traction).norm() <= 1e-9 * glue.sigma_c);
    }
    for (std::size_t node = 0; node < end.velocity.size(); ++node)
        CHECK((turned_end.velocity[node] - turned(end.velocity[node], angle)).norm() <= 1e-11);
}

}  // namespace large_rotation_test
