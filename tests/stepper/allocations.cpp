// The step loop lives on the memory it has: counted where malloc can be replaced (glibc, no sanitizer).
#include "base/arena.hpp"
#include "model/make_model.hpp"
#include "stepper/implicit/theta_matrix.hpp"
#include "support/obstacles.hpp"
#include "support/pieces.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <numbers>

namespace allocations_test {

using namespace knap;
using namespace knap::tests;

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__)

namespace {
std::atomic<long> n_allocations{0};
}

extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* malloc(std::size_t size) { return ++n_allocations, __libc_malloc(size); }
void* calloc(std::size_t n, std::size_t size) { return ++n_allocations, __libc_calloc(n, size); }
void* realloc(void* old, std::size_t size) { return ++n_allocations, __libc_realloc(old, size); }
}

namespace {

/// A plate that is pulled apart, its lower half cracked along a line from the start; cells are `coarse` times as long.
ModelInput pulled_plate(double speed, Index order = 1, int coarse = 1) {
    ModelInput input;
    input.mesh = bar_mesh(24 / coarse, 10 / coarse, 2.4, 1);
    input.mesh.order = order;
    for (InteriorEdge& edge : input.mesh.interior_edges) {
        const Vec2 a = input.mesh.corner(edge.triangle[0], edge.side[0]),
                   b = input.mesh.corner(edge.triangle[0], (edge.side[0] + 1) % 3);
        edge.cracked = std::abs(a.x() - 1.2) < 1e-9 && std::abs(b.x() - 1.2) < 1e-9 && std::max(a.y(), b.y()) < 0.51;
    }
    input.materials = {{.density = 1, .E = 1, .nu = 0.2}};
    input.laws = {{.sigma_c = 1e-3, .G_c = 2e-6, .gamma = 1, .friction = 0.3}};
    input.law_of_pair = {{0}};
    input.loads = {load(Load::Kind::velocity, "left", -speed, std::nullopt),
                   load(Load::Kind::velocity, "right", speed, std::nullopt)};
    return input;
}

/// The plate on a platen, and an obstacle above.
ModelInput pressed_plate(const Obstacle& above) {
    ModelInput input = pulled_plate(0);
    input.mesh = bar_mesh(12, 5, 2.4, 1);
    input.laws[0].friction = above.contact.friction;
    input.loads.clear();
    input.obstacles = {platen({0, 0}, {0, 1}, {.friction = above.contact.friction}), above};
    return input;
}

Obstacle driven_platen(double speed, double friction) {
    Obstacle made = platen({0, 1}, {0, -1}, {.friction = friction});
    made.drive[1] = {.kind = Drive::Kind::velocity, .value = -speed};
    return made;
}

/// Free, with its point on the middle of an edge.
Obstacle wedge(double speed) {
    Obstacle made = polygon({{1.25, 1}, {1.45, 1.3}, {1.05, 1.3}}, {.friction = 0.3});
    set_free(made, 20);
    made.initial_velocity.y() = -speed;
    return made;
}

/// A step, and how often it allocated.
struct CountedStep {
    StepReport report;
    long made;
};
CountedStep counted_step(Run& run, double h, State& end) {
    const long before = n_allocations;
    const StepReport report = run.stepper.step(run.now, h, end);
    const long made = n_allocations - before;
    REQUIRE(report.rejection == Rejection::none);
    std::swap(run.now, end);
    return {report, made};
}

/// Steps after the first one, the number of their allocations, and of the fans that split in them.
struct CountedRun {
    long made = 0;
    int n_released = 0, n_fallbacks = 0;
};
CountedRun counted_run(Run& run, double h, int n_steps) {
    CountedRun sum;
    State end;
    counted_step(run, h, end);
    for (int i = 1; i < n_steps; ++i) {
        const auto [report, made] = counted_step(run, h, end);
        sum.made += made;
        sum.n_released += static_cast<int>(report.released);
        sum.n_fallbacks += static_cast<int>(report.fan_fallbacks);
    }
    return sum;
}

}  // namespace

TEST_CASE("the count of allocations counts") {
    const long before = n_allocations;
    const std::vector<Vec2> some(7);
    const Eigen::MatrixXd other = Eigen::MatrixXd::Zero(3, 5);
    CHECK(n_allocations - before == 2);
}

TEST_CASE("an explicit step allocates nothing unless a fan splits") {
    for (const CohesionScheme cohesion : {CohesionScheme::explicit_beta, CohesionScheme::implicit_beta}) {
        Run run(pulled_plate(1e-3), {.cohesion = cohesion});
        const double h = 0.8 * run.stepper.stable_step();
        State end;
        int n_quiet = 0, n_released = 0;
        long worst = 0;
        for (int i = 0; i < 600; ++i) {
            const auto [report, made] = counted_step(run, h, end);
            n_released += static_cast<int>(report.released);
            if (i < 200 || report.released > 0) continue;  // 200: fans of all sizes have been solved
            worst = std::max(worst, made);
            ++n_quiet;
        }
        CHECK(n_released > 20);
        CHECK(n_quiet > 200);
        CHECK(worst == 0);
    }
}

TEST_CASE("an implicit step allocates nothing while no bond changes") {
    // The crack opens, closes and slides, and bonded fans are tested.
    for (const double friction : {0.0, 0.3}) {
        ModelInput input = pulled_plate(1e-3);
        input.laws[0] = {.sigma_c = 1, .G_c = 2e-3, .gamma = 1, .friction = friction};
        for (Load& drive : input.loads)
            drive.history = {.time = {0, 2, 4, 6, 8, 10, 12, 14, 16}, .value = {1, 1, -1, -1, 1, 1, -1, -1, 1}};
        input.loads[1].value[1] = 2e-4;
        Run run(std::move(input), {.bulk = BulkScheme::implicit_theta, .cohesion = CohesionScheme::implicit_beta});
        int n_quiet = 0, n_factorisations = 0;
        double opened = 0, rubbed = 0;
        long worst = 0;
        State end;
        for (int i = 0; i < 800; ++i) {
            const auto [report, made] = counted_step(run, 0.02, end);
            for (Index p = 0; p < static_cast<Index>(run.model.fan_point_of.size()); ++p)
                if (run.model.fan_points[run.model.fan_point_of[p]].cracked)
                    opened = std::max(opened, opening(run.model, run.now, p).x());
            rubbed -= report.friction_work;
            if (i < 400 || report.released > 0 || report.softened > 0)
                continue;  // the second time round: all sizes have been met
            ++n_quiet, worst = std::max(worst, made), n_factorisations += static_cast<int>(report.factorisations);
        }
        CAPTURE(friction);
        CHECK(n_quiet > 300);
        CHECK(n_factorisations > 20);
        CHECK(opened > 1e-4);
        CHECK((rubbed > 0) == (friction > 0));
        CHECK(worst == 0);
    }
}

TEST_CASE("an implicit step in which bonds soften allocates nothing") {
    Run run(pulled_plate(1e-3), {.bulk = BulkScheme::implicit_theta, .cohesion = CohesionScheme::implicit_beta});
    State end;
    int n_softening = 0;
    long worst = 0;
    for (int i = 0; i < 300; ++i) {
        const auto [report, made] = counted_step(run, 0.02, end);
        if (i < 100 || report.released > 0) continue;  // all sizes have been met
        worst = std::max(worst, made);
        n_softening += report.softened > 0;
    }
    CHECK(n_softening > 30);
    CHECK(worst == 0);
}

TEST_CASE("a run in which a body breaks allocates as often as its lists double") {
    // the copies of the state at the first fans that come apart; lists of a fan, of contacts, of GMRES; pieces of the
    // arena of the fronts; edges of open faces. Struck: rows of the contact problem, and what every fan that the boulder
    // touches keeps of its own, also as candidates at obstacles
    const SchemeOptions explicit_beta, implicit_beta{.cohesion = CohesionScheme::implicit_beta},
        implicit{.bulk = BulkScheme::implicit_theta, .cohesion = CohesionScheme::implicit_beta};
    struct Case {
        std::string name;
        ModelInput input;
        SchemeOptions scheme;
        long most;
    };
    const Case cases[] = {
        {"pulled", pulled_plate(1e-3), explicit_beta, 50},
        {"pulled, implicit cohesion", pulled_plate(1e-3), implicit_beta, 50},
        {"pulled, second order", pulled_plate(1e-3, 2), explicit_beta, 50},
        {"pulled, implicit", pulled_plate(1e-3, 1, 2), implicit, 40},
        {"pressed", pressed_plate(driven_platen(2e-2, 0.3)), explicit_beta, 140},
        {"pressed, implicit", pressed_plate(driven_platen(5e-3, 0)), implicit, 90},
        {"struck", pressed_plate(boulder({1.2, 1.3}, 0.3, {0, -2e-2}, {.friction = 0.3})), explicit_beta, 700},
        {"struck, implicit", pressed_plate(boulder({1.2, 1.3}, 0.3, {0, -5e-3})), implicit, 65},
        {"struck by a corner", pressed_plate(wedge(2e-2)), explicit_beta, 175},
    };
    for (const Case& one : cases) {
        Run run(one.input, one.scheme);
        const CountedRun counted = counted_run(run, 0.02, 200);
        CAPTURE(one.name);
        CAPTURE(counted.n_fallbacks);
        CHECK(counted.n_released > 20);
        CHECK(counted.made <= one.most);
    }
}

TEST_CASE("lists that grow in turn share an arena of few pieces and keep what is theirs") {
    constexpr std::size_t n_lists = 200, most = 5000;
    Arena arena;
    std::vector<ArenaList<double>> lists(n_lists);
    const long before = n_allocations;
    std::size_t in_use = 0;
    for (std::size_t n = 1; n <= most; n += n / 3 + 1)
        for (std::size_t i = 0; i < n_lists; ++i) {
            lists[i].resize(arena, n);
            std::ranges::fill(lists[i].entries(), static_cast<double>(i));
            in_use = n;
        }
    for (std::size_t i = 0; i < n_lists; ++i) {
        CHECK(lists[i].size() == in_use);
        CHECK(std::ranges::all_of(lists[i].entries(), [&](double x) { return x == static_cast<double>(i); }));
    }
    CHECK(n_allocations - before <= 30);  // and n_lists * 20 if every list had its own memory
    const long made = n_allocations;
    for (ArenaList<double>& list : lists) list.resize(arena, 1), list.resize(arena, in_use);  // room is not given back
    CHECK(n_allocations == made);
}

TEST_CASE("solving with a factor allocates nothing") {
    const Model model = make_model(pulled_plate(0));
    ThetaMatrix matrix(model, MassMatrix::lumped);
    CornerPartition partition;
    partition_corners(model, std::vector<std::uint8_t>(model.fans.size(), 0), partition);
    matrix.set(partition, 1);
    REQUIRE(matrix.factorise({}));
    const std::vector<Vec2> b(partition.n_nodes(), Vec2(1, 2));
    std::vector<Vec2> x;
    matrix.solve(b, x);
    const long before = n_allocations;
    matrix.solve(b, x);
    CHECK(n_allocations == before);
}

TEST_CASE("the detection of contacts lives on the memory of its first searches") {
    // two rows of blocks that move to and fro past each other, with searches for nearby edges on the way
    std::vector<Mesh> bodies;
    for (int i = 0; i < 10; ++i) {
        bodies.push_back(bar_mesh(4, 4, 1, 1));
        for (Vec2& x : bodies.back().vertices) x += Vec2(i / 2 * 1.001, i % 2);
    }
    Pieces scene(bodies);
    FaceContacts contacts(scene.model);
    const auto period = [&] {
        for (int i = 0; i < 200; ++i) {
            for (Index b = 1; b < 10; b += 2) scene.put(b, {0.3 * std::sin(i * std::numbers::pi / 100), 0});
            contacts.find(scene.state, 1e-3);
            CHECK(contacts.all().size() > 10);
        }
    };
    period();
    const long before = n_allocations;
    period();
    CHECK(n_allocations == before);
}

#endif

}  // namespace allocations_test
