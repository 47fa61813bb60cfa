// A fluid in cracks: where it acts, what it does, and the stress intensity of a crack under pressure.
#include "mesh/triangulate.hpp"
#include "model/make_model.hpp"
#include "stepper/common/crack_forces.hpp"
#include "support/plates.hpp"
#include "support/relative.hpp"
#include "support/verification.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

namespace crack_pressure_test {

using namespace knap;
using namespace knap::tests;

namespace {

constexpr double pressure = 2e6, thickness = thickness_of_block;  // [Pa], [m]

CrackPressure from_the_left() {
    return {.pressure = pressure, .from = Selection{.boundary = "left", .box = {}, .body = ""}};
}

/// [N] Sum of the magnitudes of the forces, on both faces.
double total(const std::vector<CornerLoad>& forces) {
    double sum = 0;
    for (const CornerLoad& at : forces) sum += at.force.norm();
    return sum;
}

Vec2 momentum(const Run& run) {
    Vec2 sum = Vec2::Zero();
    for (Index c = 0; c < run.model.mesh.n_corners(); ++c)
        sum += run.model.corner_mass[c] * run.now.velocity[run.now.node_of_corner[c]];
    return sum;
}

/// Breaks the interfaces whose middle is in a box.
void break_within(const Box& box, const Model& model, State& state) {
    const Index n = model.points_per_interface();
    for (Index i = 0; i < static_cast<Index>(model.interfaces.size()); ++i) {
        const auto& [a, b] = model.interfaces[i].vertex;
        if (!box.contains(0.5 * (model.mesh.vertices[a] + model.mesh.vertices[b]))) continue;
        for (Index p = n * i; p < n * (i + 1); ++p) {
            const Index in_fans = model.fan_point_of[p], f = model.fan_of_corner[model.fan_points[in_fans].corner()];
            if (state.split_rank[f] < 0) split(model, f, state);
            const Index first = state.first_point[state.split_rank[f]];
            state.points[first + in_fans - model.fans[f].first_point].cohesion = 0;
        }
    }
}

}  // namespace

TEST_CASE("a fluid enters the cracks that begin at its source and follows them where they break") {
    for (const Index order : {1, 2}) {
        // two cracks in line with 0.2 m between them; a third one elsewhere
        const Model model = make_model(pressed_block({{.points = {{0, 0.5}, {0.4, 0.5}}},
                                                      {.points = {{0.6, 0.5}, {0.8, 0.5}}},
                                                      {.points = {{0.3, 0.8}, {0.7, 0.8}}}},
                                                     from_the_left(), 0.1, order));
        State state = initial_state(model);
        CrackForces forces(model);
        const double of_1_m = 2 * pressure * thickness;
        CHECK(total(forces.find(state)) == relative(0.4 * of_1_m, 1e-12));
        // between the cracks the interfaces need not lie on the line: break all of them
        double length = 0;
        const Box between{{0.401, 0.42}, {0.599, 0.58}};
        for (const Interface& interface : model.interfaces) {
            const Vec2 middle =
                0.5 * (model.mesh.vertices[interface.vertex[0]] + model.mesh.vertices[interface.vertex[1]]);
            if (between.contains(middle)) length += interface.length;
        }
        REQUIRE(length > 0.2);
        break_within(between, model, state);
        CHECK(total(forces.find(state)) == relative((0.6 + length) * of_1_m, 1e-12));
        // the same from the state alone, in the same order
        CrackForces resumed(model);
        const auto& again = resumed.find(state);
        REQUIRE(again.size() == forces.found().size());
        for (std::size_t i = 0; i < again.size(); ++i) CHECK(again[i].corner == forces.found()[i].corner);
        Vec2 sum = Vec2::Zero();
        for (const CornerLoad& at : again) sum += at.force;
        CHECK(sum.norm() == 0);
    }
}

TEST_CASE("a fluid without a source is in every crack and the one of a joint set also where the joint holds") {
    const std::vector<Crack> cracks{{.points = {{0.2, 0.5}, {0.6, 0.5}}},
                                    {.points = {{0.3, 0.8}, {0.6, 0.8}}, .joint = 0}};
    ModelInput everywhere = pressed_block(cracks, {.pressure = pressure}), in_joints = everywhere;
    everywhere.law_of_joint = in_joints.law_of_joint = {0};
    in_joints.crack_pressures = {{.pressure = pressure, .joint_law = 0}};
    const double of_1_m = 2 * pressure * thickness;
    const Model all = make_model(everywhere), joints = make_model(in_joints);
    CHECK(total(CrackForces(all).find(initial_state(all))) == relative(0.4 * of_1_m, 1e-12));
    CHECK(total(CrackForces(joints).find(initial_state(joints))) == relative(0.3 * of_1_m, 1e-12));
}

TEST_CASE("a free block whose crack a fluid drives through keeps its momentum and its energy balance") {
    for (const bool large_rotation : {false, true}) {
        ModelInput input = pressed_block({{.points = {{0, 0.5}, {0.3, 0.45}}}}, from_the_left(), 0.06);
        input.laws = {{.sigma_c = 3e6, .G_c = 20, .gamma = 1}};
        input.large_rotation = large_rotation;
        input.crack_pressures[0].history = {{0, 1e-4}, {0, 1}};
        Run run(std::move(input));
        const double h = 0.8 * run.stepper.stable_step();
        Index n_wet = 0;
        CrackForces forces(run.model);
        const auto n_first = forces.find(run.now).size();
        while (run.now.time < 6e-4) REQUIRE(run.step(h).rejection == Rejection::none);
        n_wet = static_cast<Index>(forces.find(run.now).size());
        CHECK(n_wet > static_cast<Index>(2 * n_first));  // the fluid followed the crack
        const EnergyLedger& ledger = run.ledger;
        CHECK(ledger.largest_residual() < 1e-12 * ledger.largest_energy());
        double kinetic_scale = 0;  // [N s]
        for (Index c = 0; c < run.model.mesh.n_corners(); ++c)
            kinetic_scale += run.model.corner_mass[c] * run.now.velocity[run.now.node_of_corner[c]].norm();
        CHECK(kinetic_scale > 0);
        CHECK(momentum(run).norm() < 1e-12 * kinetic_scale);
    }
}

TEST_CASE("the pressure in a crack follows its faces where the pieces have turned and opened") {
    for (const double turn : {0.0, 0.7, 2.5}) {  // [rad]
        ModelInput input = pressed_block({{.points = {{0, 0.5}, {1, 0.5}}}}, from_the_left());
        input.large_rotation = true;
        input.materials[0].E = 1e-3;  // nothing but the fluid acts
        Run run(std::move(input));
        const Eigen::Rotation2Dd R(turn);
        const Vec2 apart = R * Vec2(1e-3, 2e-2);
        const auto is_upper = [&](Index c) {
            const Mesh& mesh = run.model.mesh;
            return mesh.centroid(mesh.triangle_of(c)).y() > 0.5;
        };
        for (Index c = 0; c < run.model.mesh.n_corners(); ++c) {
            const Vec2& x = run.model.mesh.corner(c);
            const Index node = run.now.node_of_corner[c];
            run.now.displacement[node] = R * x - x;
            if (is_upper(c)) run.now.displacement[node] += apart;
        }
        const double h = 1e-7;
        run.step(h);
        Vec2 upper = Vec2::Zero();
        double moment = 0, arms = 0;  // about the middle of the upper face, where it is now
        const Vec2 middle = R * Vec2(0.5, 0.5) + apart;
        for (Index c = 0; c < run.model.mesh.n_corners(); ++c) {
            if (!is_upper(c)) continue;
            const Vec2 p = run.model.corner_mass[c] * run.now.velocity[run.now.node_of_corner[c]];
            upper += p;
            const double part = cross(run.model.mesh.corner(c) + run.now.displacement_of(c) - middle, p);
            moment += part, arms += std::abs(part);
        }
        CAPTURE(turn);
        const Vec2 expected = 0.5 * h * pressure * thickness * (R * Vec2(0, 1));  // the first kick is that of h/2
        CHECK((upper - expected).norm() < 1e-11 * expected.norm());
        CHECK(std::abs(moment) < 1e-11 * arms);
        CHECK(momentum(run).norm() < 1e-12 * expected.norm());
        CHECK(run.last.external_work > 0);
    }
}

TEST_CASE("a fluid that drives a crack gives the same bits after a resume and with several threads") {
    const auto input = [] {
        ModelInput made = pressed_block({{.points = {{0, 0.5}, {0.3, 0.45}}}}, from_the_left(), 0.02);
        made.laws = {{.sigma_c = 3e6, .G_c = 20, .gamma = 1}};
        return made;
    };
    Run whole(input());
    const double h = 0.8 * whole.stepper.stable_step();
    for (int i = 0; i < 100; ++i) whole.step(h);
    MoreauJean resumed(whole.model, {});
    State now = whole.now, next = now;
    for (int i = 0; i < 100; ++i) whole.step(h), resumed.step(now, h, next), std::swap(now, next);
    REQUIRE(whole.now.split_fans.size() > 20);
    CHECK(same_bits(whole.now, now));
    omp_set_num_threads(2);
    Run parallel(input());
    for (int i = 0; i < 200; ++i) parallel.step(h);
    omp_set_num_threads(1);
    CHECK(same_bits(whole.now, parallel.now));
}

TEST_CASE("E26 a crack under pressure has the stress intensity p sqrt(pi a)") {
    describe(
        "A fluid presses in a crack of length 2 a = 0.1 m in the middle of a block of 1 m x 1 m (E = 30 GPa, plane "
        "strain), at rest; triangles "
        "of second order, a/5 at the crack. Reference: the elastic energy pi p^2 a^2/E' of a crack in an infinite body "
        "(Griffith "
        "1921, Sneddon 1946), so "
        "that K = sqrt(E' U/a) = p sqrt(pi a).");
    on_path("equilibrium, implicit");
    constexpr double a = 0.05;
    ModelInput input = pressed_block({{.points = {{0.5 - a, 0.5}, {0.5 + a, 0.5}}}}, {.pressure = pressure}, 0.05, 2,
                                     {{{{0.4, 0.4}, {0.6, 0.6}}, 0.01}});
    const auto held_at = [](const Box& box, std::optional<double> x) {
        return Load{.kind = Load::Kind::displacement, .on = {.boundary = "", .box = box, .body = ""}, .value = {x, 0}};
    };
    input.loads.push_back(held_at({{-1, -1}, {1e-6, 1e-6}}, 0));
    input.loads.push_back(held_at({{1 - 1e-6, -1}, {2, 1e-6}}, {}));
    const Model model = make_model(input);
    SchemeOptions scheme;
    scheme.bulk = BulkScheme::implicit_theta;
    State state = initial_state(model);
    MoreauJean(model, scheme).start_in_equilibrium(state);
    double work = 0;  // [J] 1/2 of forces times displacements is the elastic energy
    CrackForces forces(model);
    for (const CornerLoad& at : forces.find(state)) work += 0.5 * at.force.dot(state.displacement_of(at.corner));
    const double E = 30e9 / (1 - 0.2 * 0.2), K = std::sqrt(E * work / thickness / a),
                 exact = pressure * std::sqrt(std::numbers::pi * a);
    verify("K over p sqrt(pi a)", K / exact, 1, {0.01, 0.002});
}

}  // namespace crack_pressure_test
