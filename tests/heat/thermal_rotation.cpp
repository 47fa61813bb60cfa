// Thermal strains of bodies that turn: S = D (E - e I), its energy balance, and heat that crosses faces which press on
// each other.
#include "heat/conduction.hpp"
#include "heat_bodies.hpp"
#include "model/make_model.hpp"
#include "stepper/common/elastic_energy.hpp"
#include "support/relative.hpp"
#include "support/several_bodies.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <utility>

namespace thermal_rotation_test {

using namespace knap;
using namespace knap::tests;

namespace {

Model warm(bool large_rotation, double factor) {
    ModelInput input = heated(bar_mesh(4, 2, 2, 1), field("(120*sin(2*x) + 40*y)*" + std::to_string(factor), {a}), unit,
                              CohesiveLaw::unbreakable(), PlaneModel::strain);
    input.large_rotation = large_rotation;
    return make_model(std::move(input));
}

/// Displacements up to `size` of a body that is then turned by R.
State displaced(const Model& model, double size, const Eigen::Matrix2d& R) {
    State state = initial_state(model);
    for (Index c = 0; c < model.mesh.n_corners(); ++c) {
        const Vec2 x = model.mesh.corner(c), u = size * Vec2(std::sin(3 * x.y() + x.x()), std::cos(2 * x.x()));
        state.displacement[state.node_of_corner[c]] = R * (x + u) - x;
    }
    return state;
}

}  // namespace

TEST_CASE("a warm body that turns has the turned forces and stresses") {
    const Model model = warm(true, 1);
    const Eigen::Matrix2d I = Eigen::Matrix2d::Identity();
    Eigen::Matrix2d R;
    R << std::cos(2), -std::sin(2), std::sin(2), std::cos(2);
    const State before = displaced(model, 2e-3, I), turned = displaced(model, 2e-3, R);
    std::vector<Vec2> force, force_turned;
    const double energy = elastic_energy(model, before, force), after = elastic_energy(model, turned, force_turned);
    CHECK(after == relative(energy, 1e-11));
    double largest = 0, worst = 0;
    for (std::size_t c = 0; c < force.size(); ++c) {
        largest = std::max(largest, force[c].norm());
        worst = std::max(worst, (force_turned[c] - R * force[c]).norm());
    }
    CHECK(worst < 1e-12 * largest);
    for (Index t = 0; t < model.mesh.n_triangles(); ++t) {
        const Eigen::Vector3d s = stress(model, before, t), found = stress(model, turned, t);
        Eigen::Matrix2d S;
        S << s[0], s[2], s[2], s[1];
        const Eigen::Matrix2d expected = R * S * R.transpose();
        CHECK((found - Eigen::Vector3d(expected(0, 0), expected(1, 1), expected(0, 1))).norm() < 1e-11 * s.norm());
    }
    // the forces are -dU/du
    State moved = turned;
    const Index node = moved.node_of_corner[7];
    std::vector<Vec2> unused;
    for (int k = 0; k < 2; ++k) {
        const double h = 1e-5;
        moved.displacement[node][k] += h;
        const double above = elastic_energy(model, moved, unused);
        moved.displacement[node][k] -= 2 * h;
        const double below = elastic_energy(model, moved, unused);
        moved.displacement[node][k] += h;
        double expected = 0;
        for (Index c = 0; c < model.mesh.n_corners(); ++c)
            if (moved.node_of_corner[c] == node) expected -= force_turned[c][k];
        CHECK((above - below) / (2 * h) == within(expected, 1e-6 * largest));
    }
}

TEST_CASE("small strains of warm bodies are those of small rotations to second order") {
    const auto difference = [](double size) {
        std::array<std::vector<Vec2>, 2> force;
        for (const bool large : {false, true}) {
            const Model model = warm(large, size);
            elastic_energy(model, displaced(model, 1e-3 * size, Eigen::Matrix2d::Identity()), force[large]);
        }
        double sum = 0;
        for (std::size_t c = 0; c < force[0].size(); ++c) sum += (force[1][c] - force[0][c]).norm();
        return sum;
    };
    CHECK(difference(1) / difference(0.5) == relative(4, 0.01));
}

TEST_CASE("the energy balance of a body that turns while its temperature changes and it tears closes to rounding") {
    Heat heat = field("120*sin(3*t + 2*x)*cos(y - 5*t) + 40*x*y", {a});
    heat.every = 3;
    ModelInput input = heated(bar_mesh(4, 2, 2, 1), heat, unit, weak, PlaneModel::strain);
    input.large_rotation = true;
    Run run(std::move(input));
    for (Index c = 0; c < run.model.mesh.n_corners(); ++c)
        run.now.velocity[run.now.node_of_corner[c]] = 0.02 * turned_left(run.model.mesh.corner(c) - Vec2(1, 0.5));
    run.ledger = EnergyLedger(run.model, run.now);
    int taken = 0;
    for (int i = 0; i < 400; ++i) taken += run.step_if_taken(run.stepper.stable_step() * (0.6 + 0.2 * std::sin(i)));
    CHECK(taken > 200);
    CHECK(!run.now.split_fans.empty());
    CHECK(std::abs(run.ledger.row().thermal_work) > 1e-3 * run.ledger.largest_energy());
    CHECK(run.ledger.largest_residual() < 1e-13 * run.ledger.largest_energy());
}

// Two blocks of different meshes, the upper one narrower and shifted, press on each other along 1 m; k is so large that
// each has one temperature. A step of backward Euler over tau leaves of the difference the part
//     1/(1 + tau h_0 L t (1/C_1 + 1/C_2)).
TEST_CASE("heat crosses free faces where they press on each other") {
    Bodies scene;
    scene.add(bar_mesh(3, 2, 1.5, 0.5), {0, 0});
    scene.add(bar_mesh(4, 3, 1, 1), {0.21, 0.5});
    ModelInput input = scene.input({.friction = 0.5});
    constexpr double h_0 = 50, tau = 40, rho_c = 2000 * 1.5;
    Heat heat;
    heat.field = {Expression("0")};
    heat.conduction = true;
    heat.closed_conductance = h_0;
    heat.materials.assign(2, {.conductivity = 1e7, .heat_capacity = rho_c / rock.density});
    input.heat = std::make_shared<Heat>(heat);
    Load held{.kind = Load::Kind::displacement, .on = {.box = Box{{-1, -0.01}, {2, 0.01}}}, .value = {0, 0}};
    Load weight{.kind = Load::Kind::acceleration, .on = {}, .value = {0, -0.01}};
    input.loads = {held, weight};
    Still start(std::move(input), {});
    const Mesh& mesh = start.model.mesh;
    REQUIRE(!start.now.face_contacts.empty());
    std::vector<double> T(mesh.n_corners());
    for (Index c = 0; c < mesh.n_corners(); ++c) T[c] = mesh.region[c / 3] == 1 ? 100 : 0;
    start.now.temperature = start.now.temperature_before = make_temperatures(start.model, 0, T);
    Conduction conduction(start.model);  // the same one while faces meet and part
    const auto difference_after = [&] {
        const SharedTemperatures end = conduction.implicit_step(start.now, tau);
        CHECK(std::abs(end->heat) < 1e-12 * (end->heat_scale + end->heat_moved));
        return end->of_corner.back() - end->of_corner.front();
    };
    const double C_1 = rho_c * 0.75, C_2 = rho_c * 1;
    const std::vector<FaceContactState> contacts = std::exchange(start.now.face_contacts, {});
    for (int i = 0; i < 2; ++i) {
        start.now.face_contacts.clear();
        CHECK(difference_after() == relative(100, 1e-9));
        start.now.face_contacts = contacts;
        CHECK(difference_after() == relative(100 / (1 + tau * h_0 * (1 / C_1 + 1 / C_2)), 1e-5));
    }
}

}  // namespace thermal_rotation_test
