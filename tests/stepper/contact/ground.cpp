// Supports as the ground of contact between free faces: what slides, topples over or falls onto them.
#include "model/make_model.hpp"
#include "support/obstacles.hpp"
#include "support/pieces.hpp"
#include "support/relative.hpp"
#include "support/several_bodies.hpp"

#include <doctest/doctest.h>
#include <omp.h>

#include <cmath>

namespace ground_test {

using namespace knap;
using namespace knap::tests;

namespace {

constexpr double g = 10;  // [m/s2]

Selection box(const Vec2& low, const Vec2& high) { return {.boundary = "", .box = Box{low, high}}; }

/// A support under the edges at y = 0 with these ends.
Support floor(double from, double to, double beyond) {
    return {.on = box({from - 1e-6, -1e-6}, {to + 1e-6, 1e-6}), .law = 1, .beyond = beyond};
}

ModelInput on_ground(Bodies& bodies, const ContactLaw& contact, const Support& support) {
    ModelInput input = bodies.input(contact);
    input.laws.push_back({.sigma_c = 0, .friction = contact.friction, .restitution = contact.restitution});
    input.supports = {support};
    input.loads = {{.kind = Load::Kind::acceleration, .value = {0, -g}}};
    return input;
}

Vec2 place(const Run& run, Index corner) { return run.model.mesh.corner(corner) + run.now.displacement_of(corner); }

Vec2 centre(const Run& run, Index body) {
    Vec2 sum = Vec2::Zero();
    double mass = 0;
    for (Index c = 0; c < run.model.mesh.n_corners(); ++c) {
        if (run.model.mesh.region[c / 3] != body) continue;
        sum += run.model.corner_mass[c] * place(run, c), mass += run.model.corner_mass[c];
    }
    return sum / mass;
}

double lowest(const Run& run) {
    double y = 1e9;
    for (Index c = 0; c < run.model.mesh.n_corners(); ++c) y = std::min(y, place(run, c).y());
    return y;
}

double mass_of(const Run& run) {
    double mass = 0;
    for (const double m : run.model.corner_mass) mass += m;
    return mass;
}

void check_laws(const Run& run) {
    CHECK(run.ledger.largest_residual() < 1e-10 * run.ledger.largest_energy());
    CHECK(run.ledger.worst().worst_impact_work < 1e-12 * run.ledger.largest_energy());
    CHECK(run.ledger.worst().worst_friction_work < 1e-12 * run.ledger.largest_energy());
}

/// A block 0.4 wide and 0.8 high on the ground; it turns about its lower right corner with the spin.
Run toppling_block(double spin, double friction, double beyond) {
    Bodies bodies;
    bodies.add(bar_mesh(2, 4, 0.4, 0.8), {0, 0});
    ModelInput input = on_ground(bodies, {.friction = friction, .restitution = 0}, floor(0, 0.4, beyond));
    const Vec2 from_pivot(-0.2, 0.4);
    input.initial_velocities = {{.on = {.boundary = ""}, .value = spin * turned_left(from_pivot), .spin = spin}};
    return Run(std::move(input), {.damping = 4, .damping_of = DampingOf::motion});
}

}  // namespace

TEST_CASE("a block that topples over lies on the ground of its support") {
    Run run = toppling_block(-4, 0.9, 2);
    const double h = 0.5 * run.stepper.stable_step();
    for (int i = 0; run.now.time < 9; ++i) {
        run.step(h);
        REQUIRE(run.last.rejection == Rejection::none);
    }
    const Vec2 at = centre(run, 0);
    MESSAGE("centre " << at.transpose() << " lowest " << lowest(run) << " deepest " << run.ledger.worst().contact_depth
                      << " kinetic " << run.ledger.row().kinetic / run.ledger.largest_energy());
    CHECK(at.y() == relative(0.2, 5e-3));  // its weight compresses it by 1e-3
    CHECK(at.x() == relative(0.4 + 0.4, 0.05));
    CHECK(lowest(run) > -1e-3 * 0.2);
    CHECK(run.ledger.row().kinetic < 1e-12 * run.ledger.largest_energy());
    double weight = 0;
    for (const FaceContactState& contact : run.now.face_contacts) weight += contact.contact / h;
    CHECK(weight == relative(g * mass_of(run), 1e-5));
    check_laws(run);
}

TEST_CASE("a block falls past the end of a support and another one stops it beside its place") {
    for (const double beyond : {0.0, 1.0}) {
        CAPTURE(beyond);
        Bodies bodies;
        bodies.add(bar_mesh(4, 2, 0.4, 0.2), {0, 0});
        bodies.add(bar_mesh(2, 2, 0.2, 0.2), {0.6, 0.05});
        Run run(on_ground(bodies, {}, floor(0, 0.4, beyond)));
        const double h = 0.5 * run.stepper.stable_step();
        for (int i = 0; run.now.time < 0.3; ++i) {
            run.step(h);
            REQUIRE(run.last.rejection == Rejection::none);
        }
        if (beyond == 0) {
            const double t = run.now.time;
            CHECK(centre(run, 1).y() == relative(0.15 - 0.5 * g * t * t, 1e-3));
            CHECK(run.now.face_contacts.empty());
        } else {
            CHECK(lowest(run) > -1e-3 * 0.1);
            CHECK(centre(run, 1).y() == within(0.1, 3e-3));  // it fell 0.05 and still bounces by a twentieth of that
        }
        CHECK(centre(run, 0).y() == relative(0.1, 1e-3));
        check_laws(run);
    }
}

TEST_CASE("a rebound from a support reaches the square of the restitution of the height") {
    // so soft that its corners fall one by one
    for (const double e : {0.5, 1.0}) {
        CAPTURE(e);
        Bodies bodies;
        bodies.add(bar_mesh(1, 1, 1, 1), {0, 0});
        bodies.add(star_mesh({{0, 0}, {1, 0}, {0.5, 1}}), {3, 0.01});
        ModelInput input = on_ground(bodies, {.friction = 0.3, .restitution = e}, floor(0, 1, 5));
        for (Elastic& each : input.materials) each.E = 1e-3;
        Run run(std::move(input));
        const double H = 0.01, h = 2e-6, fall = std::sqrt(2 * H / g);
        double highest = 0;
        while (run.now.time < fall * (1 + 1.2 * e)) {
            run.step(h);
            REQUIRE(run.last.rejection == Rejection::none);
            if (run.now.time > fall + 100 * h) highest = std::max(highest, place(run, 6).y());
        }
        MESSAGE("height over e^2 H " << highest / (e * e * H));
        CHECK(highest == relative(e * e * H, 1e-3));
        check_laws(run);
    }
}

TEST_CASE("a block slides from its place over the support until friction stops it") {
    const double v = 2, mu = 0.4, h_part = 0.5;
    Bodies bodies;
    bodies.add(bar_mesh(4, 2, 0.4, 0.2), {0, 0});
    ModelInput input = on_ground(bodies, {.friction = mu, .restitution = 0}, floor(0, 0.4, 1));
    input.initial_velocities = {{.on = {.boundary = ""}, .value = {v, 0}}};
    Run run(std::move(input));
    const double h = h_part * run.stepper.stable_step(), start = centre(run, 0).x(), m = mass_of(run);
    const auto momentum = [&] { return m * run.mean_velocity([](Index) { return true; }).x(); };
    double at_hand_over = 0, impulse = 0, error = 0;  // [N s] of friction since no point stands on the support
    while (run.now.time < 1.2 * v / (mu * g)) {
        const bool handed_over = std::ranges::count(run.now.retired, Retirement::retired) == 8;
        run.step(h);
        REQUIRE(run.last.rejection == Rejection::none);
        if (!handed_over) {
            at_hand_over = momentum();
            continue;
        }
        for (const FaceContactState& contact : run.now.face_contacts) impulse += contact.tangential;
        error = std::max(error, std::abs(momentum() + impulse - at_hand_over));
    }
    const double path = centre(run, 0).x() - start, exact = v * v / (2 * mu * g);
    MESSAGE("path over exact " << path / exact << " speed at the hand-over " << at_hand_over / m << " deepest "
                               << run.ledger.worst().contact_depth);
    CHECK(std::ranges::count(run.now.retired, Retirement::retired) == 8);
    CHECK(path == relative(exact, 1e-2));
    CHECK(lowest(run) > -1e-3 * 0.1);
    CHECK(error < 1e-12 * m * v);
    CHECK(std::abs(momentum()) < 5e-3 * m * v);  // the block swings on: nothing damps it
    check_laws(run);
}

TEST_CASE("a block slides over the end of a support and falls") {
    Bodies bodies;
    bodies.add(bar_mesh(4, 2, 0.4, 0.2), {0, 0});
    ModelInput input = on_ground(bodies, {}, floor(0, 0.4, 0));
    input.initial_velocities = {{.on = {.boundary = ""}, .value = {1, 0}}};
    Run run(std::move(input));
    const double h = 0.5 * run.stepper.stable_step();
    bool on_end = false;  // the end of the ground is the vertex, and the lower face of the block the edge
    for (int i = 0; run.now.time < 1; ++i) {
        run.step(h);
        REQUIRE(run.last.rejection == Rejection::none);
        for (const FaceContactState& contact : run.now.face_contacts)
            on_end = on_end || run.model.ground_at(contact.vertex) != nullptr;
    }
    MESSAGE("centre " << centre(run, 0).transpose() << " deepest " << run.ledger.worst().contact_depth);
    CHECK(on_end);
    CHECK(centre(run, 0).y() < -1);
    CHECK(run.ledger.worst().contact_depth < 1e-2);
    check_laws(run);
}

TEST_CASE("a block finds the corner between two supports at a distance") {
    Bodies bodies;
    bodies.add(bar_mesh(4, 2, 0.4, 0.2), {0, 0});
    ModelInput input = on_ground(bodies, {.friction = 0, .restitution = 0}, floor(0, 0.4, 0));
    input.supports.push_back({.on = box({0.4 - 1e-6, -1e-6}, {0.4 + 1e-6, 0.2 + 1e-6}), .law = 1, .gap = 0.02});
    input.supports[0].gap = 0.01;
    input.loads.push_back({.kind = Load::Kind::acceleration, .value = {3, 0}});
    Run run(std::move(input), {.damping = 10, .damping_of = DampingOf::motion});
    const double h = 0.5 * run.stepper.stable_step();
    while (run.now.time < 3) {
        run.step(h);
        REQUIRE(run.last.rejection == Rejection::none);
    }
    MESSAGE("centre " << centre(run, 0).transpose() << " contacts " << run.now.face_contacts.size());
    CHECK((centre(run, 0) - Vec2(0.22, 0.09)).norm() < 2e-4);  // its weight compresses it by 1e-4
    CHECK(run.ledger.worst().contact_depth < 1e-3);
    CHECK(run.ledger.row().kinetic < 1e-10 * run.ledger.largest_energy());
    check_laws(run);
}

TEST_CASE("contact with the ground has the same bits with one thread and two and after a checkpoint") {
    const auto run_with = [](int n_threads, bool interrupted) {
        omp_set_num_threads(n_threads);
        Run run = toppling_block(-4, 0.9, 2);
        const double h = 0.5 * run.stepper.stable_step();
        for (int i = 0; i < 2000; ++i) {
            run.step(h);
            if (!interrupted || i != 1200) continue;
            Run again = toppling_block(-4, 0.9, 2);
            again.now = run.now;
            for (; i + 1 < 2000; ++i) again.step(h);
            return again.now;
        }
        return run.now;
    };
    const int before = omp_get_max_threads();
    const State one = run_with(1, false), two = run_with(2, false), resumed = run_with(2, true);
    omp_set_num_threads(before);
    CHECK(!one.face_contacts.empty());
    CHECK(same_bits(one, two));
    CHECK(same_bits(one, resumed));
}

/// A block glued to the ground: a pulse of 0.1 s that accelerates it breaks the bond, and damping stops what comes back.
Run glued_block(const Vec2& size, const Vec2& pulse, const Box& pulled, double beyond) {
    Bodies bodies;
    bodies.add(bar_mesh(4, 4, size.x(), size.y()), {0, 0});
    ModelInput input = on_ground(bodies, {}, floor(0, size.x(), beyond));
    input.laws[1] = {.sigma_c = 8e3, .G_c = 4, .friction = 0.6};
    input.supports[0].glued = true;
    input.loads.push_back({.kind = Load::Kind::acceleration,
                           .on = {.boundary = "", .box = pulled},
                           .value = {pulse.x(), pulse.y()},
                           .history = {.time = {0, 0.1, 0.1 + 1e-9}, .value = {1, 1, 0}}});
    return Run(std::move(input), {.damping = 8, .damping_of = DampingOf::motion});
}

TEST_CASE("a glued block that is torn off comes back to the ground that held it") {
    const Vec2 size(0.4, 0.2);
    struct Pulse {
        std::string name;
        Vec2 pulse;
        Box pulled;
        double beyond, height;  // [m] height at rest
    };
    const Box all{{-1, -1}, {1, 1}}, right{{0.25, -1}, {1, 1}};
    for (const auto& [name, pulse, pulled, beyond, height] : {Pulse{"up and down", {0, 40}, all, 0, 0.2},
                                                              {"up and aside", {15, 40}, all, 1, 0.2},
                                                              {"along", {40, 0}, all, 1, 0.2},
                                                              {"at one side", {0, 80}, right, 2, 0.4}}) {
        CAPTURE(name);
        Run run = glued_block(size, pulse, pulled, beyond);
        const double h = 0.5 * run.stepper.stable_step();
        double highest = 0;
        while (run.now.time < 5) {
            run.step(h);
            REQUIRE(run.last.rejection == Rejection::none);
            highest = std::max(highest, lowest(run));
        }
        double weight = 0, along = 0;
        for (const FaceContactState& contact : run.now.face_contacts) {
            weight += contact.contact / h, along += contact.tangential / h;
            CHECK((run.model.ground_at(contact.edge) != nullptr) != (run.model.ground_at(contact.vertex) != nullptr));
        }
        const Vec2 at = centre(run, 0);
        MESSAGE(name << ": centre " << at.transpose() << " lowest " << lowest(run) << " was " << highest << " deepest "
                     << run.ledger.worst().contact_depth << " kinetic "
                     << run.ledger.row().kinetic / run.ledger.largest_energy() << " weight "
                     << weight / (g * mass_of(run)) << " along " << along / (g * mass_of(run)) << " dissipated "
                     << run.ledger.row().dissipated << " law lag " << run.ledger.row().law_lag);
        CHECK(std::ranges::count(run.now.retired, Retirement::retired) == 8);
        CHECK(run.ledger.row().dissipated == relative(4 * size.x(), 1e-12));  // G_c of every point
        CHECK(lowest(run) > -1e-3 * 0.1);
        CHECK(at.y() / (0.5 * height) == relative(1, 5e-4));  // on another side if it turned over
        CHECK(weight == relative(g * mass_of(run), 1e-5));
        CHECK(run.ledger.row().kinetic < 1e-12 * run.ledger.largest_energy());
        CHECK(run.ledger.worst().contact_depth < 1e-2);
        check_laws(run);
    }
}

TEST_CASE("a support that goes on beyond its end must not run into the body") {
    Bodies bodies;
    bodies.add(bar_mesh(1, 1, 1, 1), {0, 0});
    bodies.add(bar_mesh(1, 1, 1, 1), {2, -0.5});
    CHECK_THROWS_WITH_AS(make_model(on_ground(bodies, {}, floor(0, 1, 1.5))),
                         doctest::Contains("runs into the body at (2, 0) m"), UserError);
    CHECK_NOTHROW(make_model(on_ground(bodies, {}, floor(0, 1, 0.9))));
}

}  // namespace ground_test
