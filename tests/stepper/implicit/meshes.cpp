// Bodies with all their edges cohesive and implicit: ties (E3), friction of any size (E11), slivers (E12).
#include "mesh/triangulate.hpp"
#include "model/make_model.hpp"
#include "support/bodies.hpp"
#include "support/paths.hpp"
#include "support/relative.hpp"
#include "support/springs.hpp"
#include "support/tied_bar.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>

namespace implicit_meshes_test {

using namespace knap;
using namespace knap::tests;

namespace {

const Elastic glass{.density = 2450, .E = 32e9, .nu = 0.2};

int n_broken(const Run& run) {
    int n = 0;
    for (Index p = 0; p < run.model.n_points(); ++p) n += cohesion(run.model, run.now, p) == 0;
    return n;
}

/// To a time; a rejected step is taken with half the size, and the size grows again. Number of rejections.
int go(Run& run, double until, double h) {
    int rejections = 0;
    double now = h;
    State end;
    while (run.now.time < until * (1 - 1e-9)) {
        const StepReport report = run.stepper.step(run.now, std::min(now, until - run.now.time), end);
        if (report.rejection != Rejection::none) {
            ++rejections;
            now /= 2;
            REQUIRE_MESSAGE(now > 1e-6 * h, "stuck at t = ", run.now.time, " after ", run.now.n_steps, " steps, ",
                            rejections, " rejections, the last ", static_cast<int>(report.rejection));
            continue;
        }
        std::swap(run.now, end);
        run.ledger.add(run.now, report);
        now = std::min(h, 1.5 * now);
    }
    return rejections;
}

void check_energy_balance(const Run& run, double residual = 0) {
    const StepReport& worst = run.ledger.worst();
    const double scale = run.ledger.largest_energy();
    CHECK(std::abs(run.ledger.row().residual - residual) <= 1e-10 * scale);
    CHECK(worst.worst_friction_work <= 1e-14 * scale);
    CHECK(worst.worst_impact_work <= 1e-14 * scale);
    CHECK(worst.largest_beta_growth == 0);
    CHECK(worst.residual <= 1e-10);
    CHECK(run.ledger.row().surface() <= energy_of_all_interfaces(run.model) * (1 + 1e-12));
}

}  // namespace

TEST_CASE("E3 all interfaces of a homogeneous bar reach their strength in one implicit step") {
    Run run(tied_bar(), implicit()), again(tied_bar(), implicit());
    for (Run* one : {&run, &again}) {
        strain_evenly(*one);
        one->ledger = EnergyLedger(one->model, one->now);
    }
    const double h = 0.02;  // a wave crosses .4 of a cell
    const int rejections = go(run, 2, h);
    CHECK(go(again, 2, h) == rejections);
    on_path(both_implicit);
    verify_at_most("rejected steps", rejections, 0);
    verify_that("a second run has the same bits",
                same_bits(run.now.displacement, again.now.displacement) && run.now.split_fans == again.now.split_fans);
    verify_at_least("vertices that come apart (95 inside)", static_cast<double>(run.now.split_fans.size()),
                    0.8 * 19 * 5);
    verify_small("residual of the interface laws", run.ledger.worst().residual, {1e-10});
    check_energy_balance(run);
}

namespace {

/// A plate of glass of 40 x 20 mm with a crack of 15 mm from its left side, pulled apart at its top and bottom.
ModelInput pulled_plate(double speed) {
    Shape shape;
    shape.outer = {.points = {{0, 0}, {0.04, 0}, {0.04, 0.02}, {0, 0.02}}, .boundary = {0, 1, 2, 3}};
    shape.cracks = {{.points = {{0, 0.01}, {0.015, 0.01}}}};
    shape.boundary_names = {"bottom", "right", "top", "left"};
    ModelInput input = body_with(triangulate(shape, {.size = 4e-3}), glass, {.sigma_c = 4e6, .G_c = 3, .gamma = 1});
    input.thickness = 1e-3;
    input.loads = {load(Load::Kind::velocity, "top", std::nullopt, speed),
                   load(Load::Kind::velocity, "bottom", std::nullopt, -speed)};
    return input;
}

}  // namespace

TEST_CASE("what cohesion holds is not thrown back by implicit steps: restitution makes no law lag") {
    const auto law_lag = [](double restitution) {
        ModelInput input = pulled_plate(1);
        input.laws[0].restitution = restitution;
        Run run(input, implicit(0.5)), twin(input);
        go(run, 20e-6, 5 * twin.stepper.stable_step());
        CHECK(n_broken(run) > 5);
        check_energy_balance(run);
        return run.ledger.law_lag();
    };
    const double plastic = law_lag(0);
    for (const double restitution : {0.3, 1.0}) {
        CAPTURE(restitution);
        CHECK(std::abs(law_lag(restitution) - plastic) < 0.02);
    }
}

TEST_CASE("an implicit step can be given up and taken again with the same bits") {
    const ModelInput input = pulled_plate(1);
    Run run(input, implicit(0.5)), whole(input, implicit(0.5)), twin(input);
    const double h = twin.stepper.stable_step();
    go(run, 10 * h, h);
    go(whole, 10 * h, h);
    const std::vector<Vec2> before = run.now.displacement;
    State end;
    run.stepper.give_up_when([] { return true; });
    CHECK_THROWS_AS(run.stepper.step(run.now, h, end), StepGivenUp);
    CHECK(same_bits(run.now.displacement, before));
    run.stepper.give_up_when(nullptr);
    go(run, 12 * h, h);
    go(whole, 12 * h, h);
    CHECK(same_bits(run.now.displacement, whole.now.displacement));
}

TEST_CASE("E11 friction of 1 and 1000 with all edges implicit") {
    Shape shape;
    shape.outer = {.points = {{0, 0}, {0.04, 0}, {0.04, 0.02}, {0, 0.02}}, .boundary = {0, 1, 2, 3}};
    shape.cracks = {{.points = {{0, 0.01}, {0.015, 0.01}}}};
    shape.boundary_names = {"bottom", "right", "top", "left"};
    for (const double friction : {1.0, 1000.0}) {
        CAPTURE(friction);
        ModelInput input = body_with(triangulate(shape, {.size = 4e-3}), glass,
                                     {.sigma_c = 4e6, .G_c = 3, .gamma = 1, .friction = friction});
        input.thickness = 1e-3;
        input.loads = {load(Load::Kind::velocity, "left", 8.0, 0.0), load(Load::Kind::velocity, "right", -8.0, 0.0)};
        Run run(input, implicit(0.5)), twin(input);
        const double h = twin.stepper.stable_step();
        const int rejections = go(run, 25e-6, h);
        go(twin, 25e-6, 0.5 * h);
        on_path(both_implicit);
        const std::string at = ", mu = " + digits(friction);
        const double scale = run.ledger.largest_energy();
        // with mu = 1000 every closed point sticks, and the sign of the sum of roundings has no meaning
        verify_at_most("friction work over the energy" + at, run.ledger.row().friction_work / scale, 1e-16);
        verify_at_most("largest friction work of a point in a step, over the energy" + at,
                       run.ledger.worst().worst_friction_work / scale, 1e-14);
        verify_small("residual of the interface laws" + at, run.ledger.worst().residual, {1e-10});
        verify_at_most("steps rejected of " + std::to_string(run.now.n_steps) + at, rejections,
                       static_cast<double>(run.now.n_steps) / 2);
        CHECK(n_broken(run) > 0.5 * n_broken(twin));
        CHECK(n_broken(run) < 1.5 * n_broken(twin) + 20);
        if (friction == 1) CHECK(run.ledger.row().friction_work < 0);
        check_energy_balance(run);
    }
}

TEST_CASE("E12 slivers of half a degree do not disturb what is bound") {
    describe(
        "A plate of 6 x 6 cells with a triangle of half a degree, masses 1 to 250 apart; 40 steps without interfaces, "
        "with all edges cohesive, and with every vertex split.");
    // one vertex so near to an edge that a triangle of half a degree remains; all vertices solved with their points
    // (split from the start)
    Mesh mesh = bar_mesh(6, 6, 1, 1);
    const Index vertex = 3 * 7 + 3;
    mesh.vertices[vertex] -= Vec2(0.4, 1 - 4e-3) / 6;
    name_sides(mesh, 1, 1);
    ModelInput whole = body_with(mesh, glass, CohesiveLaw::unbreakable());
    whole.loads = {load(Load::Kind::traction, "left", 1e6, 3e5), load(Load::Kind::velocity, "right", 0.0, 0.0)};
    ModelInput cohesive = whole;
    cohesive.laws = {{.sigma_c = 5e7, .G_c = 1e4, .gamma = 1, .friction = 0.5}};
    Model split = make_model(cohesive);
    for (Fan& fan : split.fans) fan.split_at_start = true;
    for (const double crossing : {0.1, 10.0}) {  // of a cell by a wave, in a step
        const double h = crossing / 6 / glass.dilatational_speed(PlaneModel::strain);
        Run reference(whole, implicit()), bound(cohesive, implicit()), open(split, implicit());
        CHECK(go(reference, 40 * h, h) == 0);
        CHECK(go(bound, 40 * h, h) == 0);
        CHECK(go(open, 40 * h, h) == 0);
        CHECK(bound.now.split_fans.empty());
        double worst = 0, worst_bound = 0, largest = 0;
        for (Index c = 0; c < mesh.n_corners(); ++c) {
            const Vec2 u = reference.u(c / 3, c % 3);
            worst = std::max(worst, (open.u(c / 3, c % 3) - u).norm());
            worst_bound = std::max(worst_bound, (bound.u(c / 3, c % 3) - u).norm());
            largest = std::max(largest, u.norm());
        }
        on_path(both_implicit);
        const std::string at = ", a wave crosses " + digits(crossing) + " cells in a step";
        verify_small("difference of the displacements, split" + at, worst / largest, {1e-8});
        verify_small("difference of the displacements, bound" + at, worst_bound / largest, {1e-12});
        check_energy_balance(open);
    }
}

TEST_CASE("a support that cannot break holds the body in implicit steps") {
    // column of height 1 under its own weight: u(top) = -rho g/(2 E), and the base stays
    ModelInput input = body_with(bar_mesh(4, 4, 1, 1), {.density = 1, .E = 1000, .nu = 0}, CohesiveLaw::unbreakable());
    input.plane = PlaneModel::stress;
    input.supports = {{.on = {.boundary = "bottom", .box = {}}, .law = 0, .glued = true}};
    input.loads = {load(Load::Kind::acceleration, "", 0.0, -10.0)};
    Run run(input, implicit(1));
    for (int i = 0; i < 20; ++i) {
        run.step(1);
        REQUIRE(run.last.rejection == Rejection::none);
    }
    double top = 0;
    for (const Fan& fan : run.model.fans) {
        const double x = run.model.mesh.vertices[fan.vertex].x(), y = run.model.mesh.vertices[fan.vertex].y();
        const Vec2 u = run.now.displacement[run.now.node_of_corner[run.model.fan_corners[fan.first_corner]]];
        if (y == 0) CHECK(u == Vec2::Zero());
        if (y == 1) top += u.y() * (x == 0 || x == 1 ? 0.125 : 0.25);
    }
    CHECK(top == relative(-5e-3, 1e-9));  // mean along the row; the vertices differ with their shares of the mass
    check_energy_balance(run);
}

}  // namespace implicit_meshes_test
