// Absorbing boundaries: a pulse of normal incidence leaves the body. The part that returns is an amplitude, measured by
// the energy that is left once the pulse has gone.
#include "support/bodies.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include <cmath>

using namespace knap;
using namespace knap::tests;

namespace {

constexpr int n_cells = 200, pulse_cells = 40;
constexpr double length = 2, height = length / n_cells;

/// (1 - cos(2 pi t/T))/2 until T, then 0.
TimeFunction pulse(double T) {
    TimeFunction history;
    for (int i = 0; i <= 64; ++i) {
        history.time.push_back(T * i / 64);
        history.value.push_back(0.5 * (1 - std::cos(2 * M_PI * i / 64)));
    }
    return history;
}

ModelInput bar(Mesh mesh, const Elastic& material, PlaneModel plane) {
    ModelInput input;
    input.mesh = std::move(mesh);
    input.plane = plane;
    input.materials = {material};
    input.laws = {{.sigma_c = 20e6, .G_c = 1e3, .gamma = 1}};  // more than any wave here
    input.law_of_pair = {{0}};
    return input;
}

SchemeOptions let_out(const std::string& boundary) {
    return {.absorbing = {{.boundary = boundary, .box = {}, .body = {}}}};
}

/// [-] Amplitude of the reflected over that of the incident pulse; the speed of the pulse is c.
double reflection(ModelInput input, const Vec2& traction, double c) {
    const double T = pulse_cells * length / n_cells / c;
    input.loads.push_back(load(Load::Kind::traction, "right", traction.x(), traction.y(), pulse(T)));
    Run run(std::move(input), let_out("left"));
    const double h = 0.8 * run.stepper.stable_step();
    double largest = 0, error = 0, work = 0, radiated = 0;
    while (run.now.time < length / c + 1.5 * T) {
        const StepReport& r = run.step(h);
        CHECK(r.radiated_work <= 0);
        work += r.external_work - r.cohesive_work + r.impact_work + r.friction_work + r.radiated_work;
        radiated += r.radiated_work;
        largest = std::max(largest, r.kinetic + r.strain);
        error = std::max(error, std::abs(r.kinetic + r.strain - work));
    }
    CHECK(error < 1e-12 * largest);
    CHECK(-radiated > 0.999 * largest);
    return std::sqrt((run.last.kinetic + run.last.strain) / largest);
}

constexpr Elastic rock{.density = 2500, .E = 50e9, .nu = 0.25};

}  // namespace

TEST_CASE("absorbing boundary: a pressure wave of normal incidence leaves") {
    for (const PlaneModel plane : {PlaneModel::strain, PlaneModel::stress}) {
        ModelInput input = bar(symmetric_bar_mesh(n_cells, length, height), rock, plane);
        for (const char* side : {"bottom", "top"})
            input.loads.push_back(load(Load::Kind::displacement, side, std::nullopt, 0.0));
        const double part = reflection(std::move(input), {1e6, 0}, rock.dilatational_speed(plane));
        MESSAGE("reflected amplitude " << part);
        CHECK(part < 2e-3);
    }
}

TEST_CASE("absorbing boundary: a shear wave of normal incidence leaves") {
    ModelInput input = bar(symmetric_bar_mesh(n_cells, length, height), rock, PlaneModel::strain);
    for (const char* side : {"bottom", "top"})
        input.loads.push_back(load(Load::Kind::displacement, side, 0.0, std::nullopt));
    const double part = reflection(std::move(input), {0, 1e6}, rock.shear_speed());
    MESSAGE("reflected amplitude " << part);
    CHECK(part < 2e-3);
}

TEST_CASE("absorbing boundary: in any direction and with a crack that reaches it") {
    const Elastic slender{.density = 2500, .E = 50e9, .nu = 0};
    const double turn = 0.5;
    Mesh mesh = bar_mesh(n_cells, 2, length, 2 * height);
    for (InteriorEdge& edge : mesh.interior_edges) {
        const Vec2 middle =
            0.5 * (mesh.corner(edge.triangle[0], edge.side[0]) + mesh.corner(edge.triangle[0], (edge.side[0] + 1) % 3));
        edge.cracked = std::abs(middle.y() - height) < 1e-9 && middle.x() < 0.2 * length;
    }
    for (Vec2& x : mesh.vertices) x = Eigen::Rotation2Dd(turn) * x;
    ModelInput input = bar(std::move(mesh), slender, PlaneModel::stress);
    const double part = reflection(std::move(input), Eigen::Rotation2Dd(turn) * Vec2(1e6, 0),
                                   slender.dilatational_speed(PlaneModel::stress));
    MESSAGE("reflected amplitude " << part);
    CHECK(part < 1e-2);
}

TEST_CASE("absorbing boundary: stress in situ on the same boundary stays in equilibrium") {
    ModelInput input = bar(bar_mesh(8, 4, 2, 1), rock, PlaneModel::strain);
    for (const char* side : {"left", "right", "bottom", "top"}) {
        Load stress = load(Load::Kind::stress, side, std::nullopt, std::nullopt);
        stress.stress = {-5e6, -8e6, 1e6};
        input.loads.push_back(stress);
    }
    SchemeOptions scheme = let_out("left");
    scheme.absorbing.push_back({.boundary = "bottom", .box = {}, .body = {}});
    Run run(std::move(input), scheme);
    run.stepper.start_in_equilibrium(run.now);
    for (int i = 0; i < 2000; ++i) run.step(0.8 * run.stepper.stable_step());
    CHECK(run.last.kinetic < 1e-20 * run.last.strain);
    const Eigen::Vector3d s = stress(run.model, run.now, 0);
    CHECK(s[0] == doctest::Approx(-5e6).epsilon(1e-9));
    CHECK(s[1] == doctest::Approx(-8e6).epsilon(1e-9));
    CHECK(s[2] == doctest::Approx(1e6).epsilon(1e-9));
}

TEST_CASE("absorbing boundary: refused where the boundary is held or led") {
    ModelInput held = bar(bar_mesh(4, 2, 2, 1), rock, PlaneModel::strain);
    held.supports = {{.on = {.boundary = "left", .box = {}, .body = {}}}};
    CHECK_THROWS_AS(Run(held, let_out("left")), UserError);
    ModelInput led = bar(bar_mesh(4, 2, 2, 1), rock, PlaneModel::strain);
    led.loads = {load(Load::Kind::velocity, "left", 0.0, 1.0)};
    CHECK_THROWS_AS(Run(led, let_out("left")), UserError);
}
