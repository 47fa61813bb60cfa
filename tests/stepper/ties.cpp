// Fracture runs that must not depend on what is no physics: ties (E3), threads, units (E20); fragments that come to no energy of their
// own (E19); friction of any size (E11).
#include "base/random.hpp"
#include "geometry/triangulate.hpp"
#include "support/bodies.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <set>

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
    input.materials = {{.density = glass.density / (units.mass / std::pow(units.length, 3)), .E = glass.E / units.stress(), .nu = glass.nu}};
    input.laws = {{.sigma_c = 8e6 / units.stress(), .G_c = 3 / (units.stress() * units.length), .gamma = 1, .friction = 0.5}};
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

void check_books(const Run& run) {
    const StepReport& worst = run.ledger.worst();
    CHECK(run.ledger.largest_residual() <= 1e-11 * run.ledger.largest_energy());
    CHECK(worst.worst_friction_work <= 1e-14 * run.ledger.largest_energy());
    CHECK(worst.worst_impact_work <= 1e-14 * run.ledger.largest_energy());
    CHECK(worst.largest_beta_growth == 0);
    CHECK(worst.residual <= 1e-10);  // at least 1 where a fan had no solution
    CHECK(run.ledger.row().surface <= energy_of_all_interfaces(run.model) * (1 + 1e-12));
}

}  // namespace

TEST_CASE("E3 all interfaces of a homogeneous bar reach their strength in one step") {
    const auto tied_bar = [] {
        ModelInput input;
        input.plane = PlaneModel::stress;
        input.mesh = bar_mesh(20, 4, 1, 0.2);
        input.materials = {{.density = 1, .E = 1, .nu = 0}};
        input.laws = {{.sigma_c = 1e-3, .G_c = 2e-5, .gamma = 1, .friction = 0.3}};
        input.law_of_pair = {{0}};
        input.loads = {load(Load::Kind::velocity, "left", -1e-3, std::nullopt), load(Load::Kind::velocity, "right", 1e-3, std::nullopt)};
        return input;
    };
    const auto start = [](Run& run) {  // a homogeneous rate of strain, from a stress a little below the strength
        for (Index c = 0; c < run.model.mesh.n_corners(); ++c) {
            const double x = run.model.mesh.corner(c / 3, c % 3).x();
            run.now.displacement[run.now.node_of_corner[c]].x() = 0.999e-3 * (x - 0.5);
            run.now.velocity[run.now.node_of_corner[c]].x() = 2e-3 * (x - 0.5);
        }
    };
    Run run(tied_bar()), again(tied_bar());
    start(run);
    start(again);
    const double h = 0.5 * run.stepper.stable_step();
    std::size_t most_at_once = 0, before = 0;
    double residual = 0;  // the books begin without the strain energy of the start
    for (int i = 0; i < 4000; ++i) {
        run.step(h);
        if (i == 0) residual = run.ledger.row().residual;
        again.step(h);
        most_at_once = std::max(most_at_once, run.now.split_fans.size() - before);
        before = run.now.split_fans.size();
    }
    CHECK(most_at_once > 0.8 * 19 * 5);  // the vertices of all columns but the ends
    CHECK(same_bits(run.now, again.now));
    CHECK(broken_points(run).size() > 0);
    CHECK(run.ledger.worst().fan_fallbacks < 0.001 * static_cast<double>(run.ledger.worst().fan_solves));
    CHECK(std::abs(run.ledger.row().residual - residual) <= 1e-12 * run.ledger.largest_energy());
    CHECK(run.ledger.worst().residual <= 1e-10);
    CHECK(run.ledger.row().surface <= energy_of_all_interfaces(run.model));
    MESSAGE("at once ", most_at_once, ", broken ", broken_points(run).size(), ", fallbacks ", run.ledger.worst().fan_fallbacks, " of ",
            run.ledger.worst().fan_solves, ", iterations a solve ", static_cast<double>(run.ledger.worst().fan_iterations) / run.ledger.worst().fan_solves);
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
            check_books(run);
            MESSAGE(mesh.n_triangles(), " triangles, ", run.now.n_steps, " steps, broken ", broken_points(run).size(), ", fallbacks ",
                    run.ledger.worst().fan_fallbacks, " of ", run.ledger.worst().fan_solves, ", iterations a solve ",
                    static_cast<double>(run.ledger.worst().fan_iterations) / run.ledger.worst().fan_solves);
        }
        ends.push_back(run.now);
    }
    omp_set_num_threads(1);
    CHECK(same_bits(ends[0], ends[1]));
    CHECK(same_bits(ends[1], ends[2]));
}

TEST_CASE("E20 the same events in SI and in mm and g and ms") {
    const Mesh mesh = cracked_block(2e-3);
    const Units si, mm{.length = 1e-3, .mass = 1e-3, .time = 1e-3};
    Run a(pulled_block(mesh, si)), b(pulled_block(mesh, mm));
    CHECK(mm.stress() == doctest::Approx(1e6));
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
    const auto equal = [&](double first, double second) { CHECK(std::abs(first - second * mm.energy()) <= 1e-10 * scale); };
    equal(in_si.kinetic, in_mm.kinetic);
    equal(in_si.strain, in_mm.strain);
    equal(in_si.surface, in_mm.surface);
    equal(in_si.external_work, in_mm.external_work);
    equal(in_si.friction_work, in_mm.friction_work);
    equal(in_si.impact_work, in_mm.impact_work);
}

TEST_CASE("E19 fragments gain no energy") {
    // every edge is a crack with friction and impact; at rest nothing ever moves, and a small random motion only dies out
    const auto rubble = [](double speed) {
        ModelInput input = pulled_block(bar_mesh(4, 4, 0.04, 0.04));
        input.loads.clear();
        for (InteriorEdge& edge : input.mesh.interior_edges) edge.cracked = true;
        input.laws[0].restitution = 0.5;
        Random random(1, "rubble");
        for (Index t = 0; t < input.mesh.n_triangles(); ++t) {
            const Vec2 middle = (input.mesh.corner(t, 0) + input.mesh.corner(t, 1) + input.mesh.corner(t, 2)) / 3;
            input.initial_velocities.push_back({.on = {.boundary = "", .box = Box{middle - Vec2(1e-4, 1e-4), middle + Vec2(1e-4, 1e-4)}},
                                                .value = speed * Vec2(random.uniform(-1, 1), random.uniform(-1, 1))});
        }
        return input;
    };
    Run still(rubble(0));
    const double h = 0.5 * still.stepper.stable_step();
    for (int i = 0; i < 1000; ++i) still.step(h);
    for (const Vec2& v : still.now.velocity) CHECK(v == Vec2(0, 0));

    Run run(rubble(1e-3));
    double energy = run.ledger.row().kinetic;
    const double first = energy;
    CHECK(first > 0);
    for (int i = 0; i < 10000; ++i) {
        const StepReport& report = run.step(h);
        REQUIRE(report.kinetic + report.strain <= energy + 1e-13 * first);
        energy = report.kinetic + report.strain;
    }
    CHECK(energy < 0.9 * first);
    check_books(run);
}

TEST_CASE("E11 friction of 1 and 10 and 1000") {
    const Mesh mesh = cracked_block(2e-3);
    for (const double friction : {1.0, 10.0, 1000.0}) {
        Run run(crushed_block(mesh, friction));
        const double h = 0.5 * run.stepper.stable_step();
        while (run.now.time < 25e-6) run.step(h);
        CHECK(broken_points(run).size() > 20);
        CHECK(run.ledger.row().friction_work < 0);
        check_books(run);
        MESSAGE("friction ", friction, ": broken ", broken_points(run).size(), ", fallbacks ", run.ledger.worst().fan_fallbacks, " of ",
                run.ledger.worst().fan_solves, ", iterations a solve ", static_cast<double>(run.ledger.worst().fan_iterations) / run.ledger.worst().fan_solves,
                ", friction work over energy ", run.ledger.row().friction_work / run.ledger.largest_energy());
    }
}
