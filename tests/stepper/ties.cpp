// Fracture runs that must not depend on what is no physics: ties (E3), threads, units (E20); fragments that come to no
// energy of their own (E19); friction of any size (E11).
#include "base/random.hpp"
#include "mesh/triangulate.hpp"
#include "support/bodies.hpp"
#include "support/paths.hpp"
#include "support/relative.hpp"
#include "support/tied_bar.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <set>

namespace ties_test {

using namespace knap;
using namespace knap::tests;

namespace {

/// Units of length, mass and time, in those of the SI.
struct Units {
    double length = 1, mass = 1, time = 1;
    double stress() const { return mass / (length * time * time); }
    double velocity() const { return length / time; }
    double energy() const { return mass * velocity() * velocity(); }
};

const Elastic glass{.density = 2450, .E = 32e9, .nu = 0.2};

/// A random mesh of 40 x 20 mm, with a crack of 15 mm from the left.
Mesh cracked_block(double size) {
    Shape shape;
    shape.outer = {.points = {{0, 0}, {0.04, 0}, {0.04, 0.02}, {0, 0.02}}, .boundary = {0, 1, 2, 3}};
    shape.cracks = {{.points = {{0, 0.01}, {0.015, 0.01}}}};
    shape.boundary_names = {"bottom", "right", "top", "left"};
    return triangulate(shape, {.size = size});
}

/// The block pulled apart by a step of traction above and below.
ModelInput pulled_block(const Mesh& mesh, const Units& units = {}) {
    ModelInput input;
    input.mesh = mesh;
    for (Vec2& x : input.mesh.vertices) x /= units.length;
    input.thickness = 1e-3 / units.length;
    input.materials = {{.density = glass.density / (units.mass / std::pow(units.length, 3)),
                        .E = glass.E / units.stress(),
                        .nu = glass.nu}};
    input.laws = {
        {.sigma_c = 8e6 / units.stress(), .G_c = 3 / (units.stress() * units.length), .gamma = 1, .friction = 0.5}};
    input.law_of_pair = {{0}};
    const double pull = 4e6 / units.stress();
    input.loads = {load(Load::Kind::traction, "top", 0.0, pull), load(Load::Kind::traction, "bottom", 0.0, -pull)};
    return input;
}

/// Two ends pushed towards each other, the block shears and breaks.
ModelInput crushed_block(const Mesh& mesh, double friction) {
    ModelInput input = pulled_block(mesh);
    input.laws[0].friction = friction;
    input.laws[0].sigma_c = 4e6;
    input.loads = {load(Load::Kind::velocity, "left", 8.0, 0.0), load(Load::Kind::velocity, "right", -8.0, 0.0)};
    return input;
}

std::set<Index> broken_points(const Run& run) {
    std::set<Index> broken;
    for (Index p = 0; p < run.model.n_points(); ++p)
        if (cohesion(run.model, run.now, p) == 0) broken.insert(p);
    return broken;
}

void check_energy_balance(const Run& run) {
    const StepReport& worst = run.ledger.worst();
    CHECK(run.ledger.largest_residual() <= 1e-11 * run.ledger.largest_energy());
    CHECK(worst.worst_friction_work <= 1e-14 * run.ledger.largest_energy());
    CHECK(worst.worst_impact_work <= 1e-14 * run.ledger.largest_energy());
    CHECK(worst.largest_beta_growth == 0);
    CHECK(worst.residual <= 1e-10);  // at least 1 where a fan had no solution
    CHECK(run.ledger.row().surface() <= energy_of_all_interfaces(run.model) * (1 + 1e-12));
}

/// Every edge of a block is a crack with friction and restitution; the triangles have random velocities.
ModelInput rubble(double speed, double restitution) {
    ModelInput input = pulled_block(bar_mesh(4, 4, 0.04, 0.04));
    input.loads.clear();
    for (InteriorEdge& edge : input.mesh.interior_edges) edge.cracked = true;
    input.laws[0].restitution = restitution;
    Random random(1, "rubble");
    for (Index t = 0; t < input.mesh.n_triangles(); ++t) {
        const Vec2 middle = (input.mesh.corner(t, 0) + input.mesh.corner(t, 1) + input.mesh.corner(t, 2)) / 3;
        input.initial_velocities.push_back(
            {.on = {.boundary = "", .box = Box{middle - Vec2(1e-4, 1e-4), middle + Vec2(1e-4, 1e-4)}},
             .value = speed * Vec2(random.uniform(-1, 1), random.uniform(-1, 1))});
    }
    return input;
}

/// At rest nothing ever moves, and a small random motion only dies out.
void leave_rubble_alone(const SchemeOptions& path, int n_steps) {
    on_path(path);
    const bool is_explicit = path.bulk == BulkScheme::explicit_lumped;
    const double restitution = is_explicit ? 0.5 : 0;
    Run still(rubble(0, restitution), path), run(rubble(1e-3, restitution), path);
    const double h = is_explicit ? 0.5 * still.stepper.stable_step() : 1e-6;
    for (int i = 0; i < 1000; ++i) still.step(h);
    double fastest = 0;
    for (const Vec2& v : still.now.velocity) fastest = std::max(fastest, v.norm());
    verify_at_most("largest speed at rest, 1000 steps", fastest, 0);

    double energy = run.ledger.row().kinetic, growth = 0;
    const double first = energy;
    CHECK(first > 0);
    for (int i = 0; i < n_steps; ++i) {
        const StepReport& report = run.step(h);
        REQUIRE(report.rejection == Rejection::none);
        growth = std::max(growth, report.kinetic + report.strain - energy);
        energy = report.kinetic + report.strain;
    }
    // the strain of a triangle that has flown far is a difference of large displacements
    const double rounding = n_steps > 10000 ? 1e-11 : 1e-13;
    verify_small(
        "largest growth of the energy in a step, over that of the start, " + std::to_string(n_steps) + " steps",
        growth / first, {rounding});
    verify_at_most("energy at the end over that of the start", energy / first, 0.9);
    if (is_explicit && n_steps <= 10000) check_energy_balance(run);
}

}  // namespace

TEST_CASE("E3 all interfaces of a homogeneous bar reach their strength in one step") {
    describe("A bar of 20 x 4 cells with a homogeneous rate of strain: all interfaces reach sigma_c in one step.");
    on_path(both_explicit);
    Run run(tied_bar()), again(tied_bar());
    strain_evenly(run);
    strain_evenly(again);
    const double h = 0.5 * run.stepper.stable_step();
    std::size_t most_at_once = 0, before = 0;
    double residual = 0;  // the energy balance begins without the strain energy of the start
    for (int i = 0; i < 4000; ++i) {
        run.step(h);
        if (i == 0) residual = run.ledger.row().residual;
        again.step(h);
        most_at_once = std::max(most_at_once, run.now.split_fans.size() - before);
        before = run.now.split_fans.size();
    }
    verify_at_least("vertices that come apart in one step (95 inside)", static_cast<double>(most_at_once),
                    0.8 * 19 * 5);
    verify_that("a second run has the same bits", same_bits(run.now, again.now));
    CHECK(broken_points(run).size() > 0);
    verify_at_most(
        "fans whose states cycled, of all that were solved",
        static_cast<double>(run.ledger.worst().fan_fallbacks) / static_cast<double>(run.ledger.worst().fan_solves),
        1e-3);
    CHECK(std::abs(run.ledger.row().residual - residual) <= 1e-12 * run.ledger.largest_energy());
    verify_small("residual of the interface laws", run.ledger.worst().residual, {1e-10});
    verify_at_most("surface energy over that of breaking all",
                   run.ledger.row().surface() / energy_of_all_interfaces(run.model), 1);
}

TEST_CASE("with restitution what is pressed comes to rest and a crack costs its energy") {
    // with rebounds of what cohesion holds, and of what lasting pressure holds, the law lag was -4 % (e = .3) to -10 %
    // (e = 1), the residual 8e-11
    const Mesh mesh = cracked_block(1.5e-3);
    for (const double e : {0.3, 0.8, 1.0})
        for (const bool crushed : {false, true}) {
            CAPTURE(e);
            CAPTURE(crushed);
            ModelInput input = crushed ? crushed_block(mesh, 0.3) : pulled_block(mesh);
            input.laws[0].restitution = e;
            Run run(input);
            const double h = 0.5 * run.stepper.stable_step();
            while (run.now.time < 25e-6) run.step(h);
            check_energy_balance(run);
            CHECK(run.ledger.worst().residual <= 1e-12);
            const EnergyRow& row = run.ledger.row();
            CHECK(broken_points(run).size() > 20);
            CHECK(std::abs(row.law_lag) <= 0.02 * row.dissipated);
            MESSAGE("e = ", e, ": law lag over dissipated energy ", row.law_lag / row.dissipated, ", impact work ",
                    row.impact_work / row.dissipated, ", residual ", run.ledger.worst().residual);
        }
}

TEST_CASE("a fracture run gives the same bits with one thread and with two") {
    const Mesh mesh = cracked_block(1.05e-3);
    CHECK(mesh.n_triangles() > 1500);
    std::vector<State> ends;
    for (const int n_threads : {1, 2, 2}) {
        omp_set_num_threads(n_threads);
        Run run(pulled_block(mesh));
        const double h = 0.5 * run.stepper.stable_step();
        while (run.now.time < 20e-6) run.step(h);
        if (ends.empty()) {
            CHECK(broken_points(run).size() > 20);
            check_energy_balance(run);
            MESSAGE(mesh.n_triangles(), " triangles, ", run.now.n_steps, " steps, broken ", broken_points(run).size(),
                    ", fallbacks ", run.ledger.worst().fan_fallbacks, " of ", run.ledger.worst().fan_solves,
                    ", iterations a solve ",
                    static_cast<double>(run.ledger.worst().fan_iterations) / run.ledger.worst().fan_solves);
        }
        ends.push_back(run.now);
    }
    omp_set_num_threads(1);
    CHECK(same_bits(ends[0], ends[1]));
    CHECK(same_bits(ends[1], ends[2]));
}

TEST_CASE("E20 the same events in SI and in mm and g and ms") {
    describe(
        "A cracked block of glass that is pulled apart, in SI and in mm, g, ms; after every step the same fans are "
        "apart and the same points broken.");
    on_path(both_explicit);
    const Mesh mesh = cracked_block(2e-3);
    const Units si, mm{.length = 1e-3, .mass = 1e-3, .time = 1e-3};
    Run a(pulled_block(mesh, si)), b(pulled_block(mesh, mm));
    CHECK(mm.stress() == relative(1e6));
    const double h = 0.5 * a.stepper.stable_step();
    std::size_t n_broken = 0;
    while (a.now.time < 15e-6) {
        a.step(h);
        b.step(h / mm.time);
        REQUIRE(a.now.split_fans == b.now.split_fans);
        REQUIRE(broken_points(a) == broken_points(b));
        n_broken = broken_points(a).size();
    }
    CHECK(n_broken > 10);
    const EnergyRow &in_si = a.ledger.row(), &in_mm = b.ledger.row();
    const double scale = a.ledger.largest_energy();
    const auto equal = [&](const std::string& name, double first, double second) {
        verify_small("difference of " + name + " over the energy", (first - second * mm.energy()) / scale, {1e-10});
    };
    verify_that("the same fans apart and the same points broken after every step",
                a.now.split_fans == b.now.split_fans);
    equal("kinetic energies", in_si.kinetic, in_mm.kinetic);
    equal("strain energies", in_si.strain, in_mm.strain);
    equal("surface energies", in_si.surface(), in_mm.surface());
    equal("external works", in_si.external_work, in_mm.external_work);
    equal("friction works", in_si.friction_work, in_mm.friction_work);
    equal("impact works", in_si.impact_work, in_mm.impact_work);
}

TEST_CASE("E19 fragments gain no energy") {
    describe(
        "A block whose edges are all cracks, with friction, at rest or with random velocities of its 32 triangles.");
    leave_rubble_alone(both_explicit, 10000);
    leave_rubble_alone(both_implicit, 300);
}

TEST_CASE("E19 fragments gain no energy in a hundred thousand steps" * doctest::test_suite("slow")) {
    leave_rubble_alone(both_explicit, 100000);
    leave_rubble_alone(both_implicit, 10000);
}

TEST_CASE("E11 friction of 1 and 10 and 1000") {
    const Mesh mesh = cracked_block(2e-3);
    describe(
        "A block with a crack, crushed between two ends that move at 8 m/s, with friction of 1, 10 and 1000: no impact "
        "or sliding gives energy, and every fan is solved.");
    on_path(both_explicit);
    for (const double friction : {1.0, 10.0, 1000.0}) {
        const std::string at = ", mu = " + digits(friction);
        Run run(crushed_block(mesh, friction));
        const double h = 0.5 * run.stepper.stable_step();
        while (run.now.time < 25e-6) run.step(h);
        CHECK(broken_points(run).size() > 20);
        const double scale = run.ledger.largest_energy();
        verify_at_most("friction work over the energy" + at, run.ledger.row().friction_work / scale, 0);
        verify_at_most("largest friction work of a point in a step, over the energy" + at,
                       run.ledger.worst().worst_friction_work / scale, 1e-14);
        verify_small("residual of the interface laws" + at, run.ledger.worst().residual, {1e-10});
        verify_small("energy residual" + at, run.ledger.largest_residual() / scale, {1e-11});
        check_energy_balance(run);
    }
}

}  // namespace ties_test
