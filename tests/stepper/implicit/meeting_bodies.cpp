// Contact between free faces in implicit steps: what meets keeps the books and the momenta, and what stands, stands.
#include "support/obstacles.hpp"
#include "support/relative.hpp"
#include "support/several_bodies.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

namespace meeting_bodies_test {

using namespace knap;
using namespace knap::tests;

namespace {

SchemeOptions implicit(double theta) { return {.bulk = BulkScheme::implicit_theta, .theta = theta}; }

/// Bodies of rock under a steady acceleration.
ModelInput meeting(Bodies& bodies, double friction, const Vec2& gravity) {
    ModelInput input = bodies.input({.friction = friction});
    for (Elastic& material : input.materials) material = {.density = 2500, .E = 10e9, .nu = 0.2};
    input.loads = {{.kind = Load::Kind::acceleration, .value = {gravity.x(), gravity.y()}}};
    return input;
}

void run_until(Run& run, double time, double h) {
    while (run.now.time < time - 0.5 * h) {
        const bool taken = run.step_if_taken(h);
        REQUIRE_MESSAGE(taken, "rejected at the step after ", run.now.n_steps, ": ",
                        static_cast<int>(run.last.rejection), ", residual ", run.last.residual);
    }
}

double creep(const Run& run, const State& before) {
    double largest = 0;
    for (Index c = 0; c < run.model.mesh.n_corners(); ++c)
        largest = std::max(largest, (run.now.displacement_of(c) - before.displacement_of(c)).norm());
    return largest;
}

}  // namespace

TEST_CASE("a stack of ten blocks at rest does not see how it is turned in implicit steps") {
    const double thickness = 1, mass = 2500 * 0.4 * 0.2 * thickness;
    const auto rest = [&](double angle) {
        Bodies bodies;
        const Vec2 e(std::cos(angle), std::sin(angle));
        for (int i = 0; i < 10; ++i) bodies.add(bar_mesh(2, 1, 0.4, 0.2), 0.2 * i * turned_left(e), angle);
        const Vec2 weight = e - 9.81 * turned_left(e);  // a tenth of it is along the faces: half of what tips the stack
        ModelInput input = meeting(bodies, 0.5, weight);
        input.obstacles = {platen({0, 0}, turned_left(e), {.friction = 0.5})};
        Run run(std::move(input), implicit(1));
        const double h = 0.05;  // a thousand passages of a wave through a triangle
        run_until(run, 8 * h, h);
        const State before = run.now;
        run_until(run, 28 * h, h);
        CHECK(creep(run, before) < 1e-12);
        CHECK(run.ledger.largest_residual() <= 1e-12 * run.ledger.largest_energy());
        std::array<Vec2, 9> carried;  // [N] by the face above block i
        for (Vec2& force : carried) force.setZero();
        for (const FaceContactState& at : run.now.face_contacts) {
            const auto block = [&](Index corner) { return run.model.mesh.region[run.model.mesh.triangle_of(corner)]; };
            const Index next = at.edge - at.edge % 3 + (at.edge + 1) % 3;
            const Vec2 t = (place_of(run.model, run.now, next) - place_of(run.model, run.now, at.edge)).normalized();
            const Vec2 on_vertex = (-at.contact * turned_left(t) + at.tangential * t) / h;
            carried[std::min(block(at.vertex), block(at.edge))] +=
                block(at.vertex) > block(at.edge) ? on_vertex : Vec2(-on_vertex);
        }
        for (int i = 0; i < 9; ++i) CHECK((carried[i] + (9 - i) * mass * weight).norm() < 1e-9 * mass * weight.norm());
        return run.ledger.row().strain;
    };
    const double upright = rest(0);
    CHECK(rest(120 * degree) == relative(upright, 1e-7));
}

TEST_CASE("a block on an incline slides in implicit steps as Coulomb says") {
    const double g = 9.81;
    const auto slide = [&](double incline, double mu, double h) {
        Bodies bodies;
        bodies.add(bar_mesh(8, 1, 1.6, 0.2), {0, 0});
        bodies.add(bar_mesh(2, 1, 0.4, 0.2), {1.1, 0.2});
        ModelInput input = meeting(bodies, mu, {-g * std::sin(incline), -g * std::cos(incline)});
        input.loads.push_back(
            {.kind = Load::Kind::displacement, .on = {.box = Box{{-1, -1}, {2, 1e-6}}}, .value = {0, 0}});
        Run run(std::move(input), implicit(1));
        run_until(run, 0.2, h);
        CHECK(run.ledger.largest_residual() <= 1e-12 * run.ledger.largest_energy());
        CHECK(run.ledger.worst().worst_friction_work <= 1e-12 * run.ledger.largest_energy());
        double way = 0;
        for (Index c = 0; c < run.model.mesh.n_corners(); ++c) way = std::max(way, -run.now.displacement_of(c).x());
        return way;
    };
    for (const double h : {1e-3, 5e-3}) {
        const double incline = 30 * degree, a = g * (std::sin(incline) - 0.3 * std::cos(incline));
        CHECK(slide(incline, 0.3, h) == relative(0.5 * a * 0.2 * (0.2 + h), 1e-5));
    }
    const double incline = std::atan(0.364), a = g * (std::sin(incline) - 0.360 * std::cos(incline));
    CHECK(slide(incline, 0.360, 5e-3) == relative(0.5 * a * 0.2 * 0.205, 1e-3));
    CHECK(slide(incline, 0.368, 5e-3) < 1e-6);  // shear and the strain of its weight
}

TEST_CASE("blocks that meet in flight keep their momenta in implicit steps") {
    for (const double friction : {0.0, 0.4}) {
        Bodies bodies;
        bodies.add(bar_mesh(2, 2, 0.4, 0.4), {0, 0});
        bodies.add(bar_mesh(2, 2, 0.4, 0.4), {0.42, 0.1}, -12 * degree);
        ModelInput input = meeting(bodies, friction, {0, 0});
        input.initial_velocities = {{.on = {.box = Box{{-1, -1}, {0.4001, 0.4001}}}, .value = {3, 0.5}}};
        Run run(std::move(input), implicit(0.5));
        const auto momenta = [&] {
            Vec3 sum = Vec3::Zero();
            for (Index c = 0; c < run.model.mesh.n_corners(); ++c) {
                const Index node = run.now.node_of_corner[c];
                const Vec2 p = run.model.corner_mass[c] * run.now.velocity[node];
                sum += Vec3(p.x(), p.y(), cross(run.model.mesh.corner(c) + run.now.displacement[node], p));
            }
            return sum;
        };
        const Vec3 before = momenta();
        run_until(run, 0.04, 1e-3);
        const Vec3 after = momenta();
        CHECK((after - before).head<2>().norm() < 1e-12 * before.norm());
        CHECK(std::abs(after.z() - before.z()) < 1e-11 * before.norm());
        CHECK(run.ledger.row().impact_work < -100);
        CHECK(run.ledger.worst().worst_friction_work <= 1e-12 * run.ledger.largest_energy());
        CHECK(run.ledger.largest_residual() <= 1e-12 * run.ledger.largest_energy());
    }
}

TEST_CASE("a jointed wall stands in implicit steps and slides beyond the angle of its friction") {
    for (const double incline : {15.0, 32.0}) {
        CAPTURE(incline);
        Bodies bodies;
        for (int row = 0; row < 4; ++row)
            for (int k = 0; k < 3 + row % 2; ++k) {
                const bool half = row % 2 == 1 && (k == 0 || k == 3);
                const double x = row % 2 == 0 ? 0.6 * k : k == 0 ? 0 : 0.6 * k - 0.3;
                bodies.add(bar_mesh(half ? 1 : 2, 1, half ? 0.3 : 0.6, 0.3), {x, 0.3 * row});
            }
        const double g = 9.81, angle = incline * degree;
        ModelInput input = meeting(bodies, 0.5, {g * std::sin(angle), -g * std::cos(angle)});
        input.obstacles = {platen({0, 0}, {0, 1}, {.friction = 0.5})};
        Run run(std::move(input), implicit(1));
        run_until(run, 0.08, 5e-3);
        const State before = run.now;
        int systems = 0;
        for (int i = 0; i < 8; ++i) run_until(run, run.now.time + 5e-3, 5e-3), systems += run.last.linear_solves;
        if (incline < 26) CHECK(creep(run, before) < 1e-12), CHECK(systems <= 8 * 6);
        else CHECK(creep(run, before) > 1e-3);
        CHECK(run.ledger.largest_residual() <= 1e-12 * run.ledger.largest_energy());
    }
}

TEST_CASE("what broke and slid away stays dissipated in implicit steps when its points have retired") {
    constexpr double G_c = 0.5, height = 0.4;
    ModelInput input = turning_body(bar_mesh(4, 4, 0.4, height, [](int i) { return i < 2 ? 0 : 1; }), {}, {});
    input.materials.assign(2, {.density = 2500, .E = 10e9, .nu = 0.2});
    input.laws = {CohesiveLaw::unbreakable(), {.sigma_c = 500, .G_c = G_c, .gamma = 1, .friction = 0.3}};
    input.law_of_pair = {{0, 1}, {1, 0}};
    input.contact_of_pair.assign(2, std::vector<ContactLaw>(2, {.friction = 0.3}));
    input.loads = {{.kind = Load::Kind::acceleration, .value = {-5, -9.81}},
                   load(Load::Kind::displacement, "left", 0.0, 0.0)};
    Run run(std::move(input), implicit(1));
    for (double h = 1e-3; run.now.time < 0.06;)
        if (!run.step_if_taken(h)) h *= 0.5, REQUIRE(h > 1e-6);
    CHECK(std::ranges::count(run.now.retired, Retirement::retired) == 8);
    CHECK(!run.now.face_contacts.empty());
    CHECK(run.ledger.row().dissipated == relative(G_c * height, 1e-9));
    CHECK(run.ledger.largest_residual() <= 1e-12 * run.ledger.largest_energy());
}

}  // namespace meeting_bodies_test
