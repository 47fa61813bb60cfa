// Thermal strain of prescribed temperatures against closed forms, and its exact energy balance (H1, H2, H5, H6).
#include "heat_bodies.hpp"
#include "mesh/triangulate.hpp"
#include "support/paths.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <utility>

namespace thermal_strain_test {

using namespace knap;
using namespace knap::tests;

namespace {

Mesh strip(int n_x, int n_y, double length, double height, Index order) {
    Mesh mesh = bar_mesh(n_x, n_y, length, height);
    mesh.order = order;
    return mesh;
}

}  // namespace

TEST_CASE("a free body under a uniform or linear temperature has no stress") {
    for (const auto& [plane, material] : {std::pair{PlaneModel::stress, unit},
                                          {PlaneModel::strain, unit},
                                          {PlaneModel::stress, layered},
                                          {PlaneModel::strain, layered}}) {
        Still uniform(heated(strip(8, 4, 2, 1, 1), field("100", {a}), material, weak, plane));
        CHECK(uniform.largest_stress() < 1e-12 * 100 * a);
        CHECK(std::abs(uniform.strain_energy()) < 1e-14 * std::pow(100 * a, 2));
        ModelInput input = heated(strip(6, 3, 2, 1, 2), field("40 + 70*x - 30*y", {a}), material, weak, plane);
        input.loads = pins(2);
        Still linear(std::move(input), {.bulk = BulkScheme::implicit_theta, .theta = 1});
        // the start lets inertia carry 1e-12 of the sum of all forces, some hundred times the force of a triangle; one
        // long step from rest leaves rounding
        CHECK(linear.largest_stress() < 1e-10 * 100 * a);
        State end;
        REQUIRE(linear.stepper.step(linear.now, 100, end).rejection == Rejection::none);
        linear.now = end;
        CHECK(linear.largest_stress() < 1e-12 * 100 * a);
        CHECK(linear.now.split_fans.empty());
    }
}

TEST_CASE("the explicit bulk keeps a free warm body at rest") {
    for (const Elastic& material : {unit, layered}) {
        Still start(heated(strip(8, 4, 2, 1, 1), field("100", {a}), material, weak, PlaneModel::strain), {});
        State next;
        const double h = 0.8 * start.stepper.stable_step();
        for (int i = 0; i < 200; ++i) {
            REQUIRE(start.stepper.step(start.now, h, next).rejection == Rejection::none);
            std::swap(start.now, next);
        }
        CHECK(start.largest_stress() < 1e-11 * 100 * a);
        CHECK(start.now.split_fans.empty());  // no candidate was released by D eps instead of sigma
    }
}

TEST_CASE("a clamped bar has the stress -E a dT in plane stress") {
    for (const Index order : {1, 2}) {
        Heat heat = field("50", {a});
        heat.reference = -20;
        ModelInput input = heated(strip(10, 2, 5, 1, order), heat, unit);
        input.loads = {load(Load::Kind::displacement, "left", 0.0, std::nullopt),
                       load(Load::Kind::displacement, "right", 0.0, std::nullopt)};
        const Still bar(std::move(input));
        for (Index t = 0; t < bar.model.mesh.n_triangles(); ++t) {
            CHECK(bar.stress(t)[0] == relative(-70 * a, 1e-11));
            CHECK(std::abs(bar.stress(t)[1]) < 1e-11 * 70 * a);
        }
    }
}

TEST_CASE("a table of integrated strain is linear between its points and goes on with its end slopes") {
    const Expansion table{.temperature = {0, 100, 110}, .strain = {0, 1e-3, 5e-3}};
    CHECK(table(50) == relative(5e-4, 1e-15));
    CHECK(table(105) == relative(3e-3, 1e-14));
    CHECK(table(120) == relative(9e-3, 1e-14));
    CHECK(table(-10) == relative(-1e-4, 1e-14));
    Heat heat = field("105", {0});
    heat.reference = 20;
    heat.materials[0].expansion = table;
    ModelInput input = heated(strip(4, 1, 4, 1, 1), heat, {.density = 1, .E = 1, .nu = 0});
    input.loads = {load(Load::Kind::displacement, "left", 0.0, std::nullopt),
                   load(Load::Kind::displacement, "right", 0.0, std::nullopt)};
    CHECK(Still(std::move(input)).stress(3)[0] == relative(-(3e-3 - 2e-4), 1e-11));
}

// A bar of length l = 1 and height 0.1 between rigid ends cools by a dT = 5e-3 t; one interface in its middle opens. Its
// ends are held in x only, or also in y.
namespace {

struct CooledBar : Run {
    static constexpr double sigma_c = 1e-3, l = 1;
    CooledBar(double delta_c, bool held_in_y) : Run(input(delta_c, held_in_y), implicit) {
        for (Index p = 0; p < model.n_points(); ++p)
            if (model.laws[model.fan_points[model.fan_point_of[p]].law].breakable()) point = p;
    }
    static constexpr SchemeOptions implicit{.bulk = BulkScheme::implicit_theta,
                                            .cohesion = CohesionScheme::implicit_beta,
                                            .theta = 1,
                                            .respect_assumption_1 = false};
    static ModelInput input(double delta_c, bool held_in_y);
    double strain() const { return 5e-3 * now.time; }
    Vec2 u() const { return opening(model, now, point); }
    double beta() const { return cohesion(model, now, point); }
    Index point = -1;
};

ModelInput CooledBar::input(double delta_c, bool held_in_y) {
    Heat heat = field("-500", {a, a}, {.time = {0, 1}, .value = {0, 1}});  // E a dT = 5e-3 at t = 1
    ModelInput input =
        heated(bar_mesh(10, 1, l, 0.1, [](int i) { return i < 5 ? 0 : 1; }), heat, {.density = 1e-8, .E = 1, .nu = 0});
    input.laws = {CohesiveLaw::unbreakable(), {.sigma_c = sigma_c, .G_c = 0.5 * sigma_c * delta_c, .gamma = 1}};
    input.law_of_pair = {{0, 1}, {1, 0}};
    const std::optional<double> in_y = held_in_y ? std::optional(0.0) : std::nullopt;
    input.loads = {load(Load::Kind::displacement, "left", 0.0, in_y),
                   load(Load::Kind::displacement, "right", 0.0, in_y)};
    if (!held_in_y) input.loads.insert(input.loads.end(), {pin({0, 0}, false, true), pin({l, 0}, false, true)});
    return input;
}

}  // namespace

// E a dT - sigma_c = (E/l - sigma_c/delta_c) u while u < delta_c; broken at a dT = delta_c/l.
TEST_CASE("an interface in a clamped bar that cools opens by (E a dT - sigma_c)/(E/l - sigma_c/delta_c)") {
    constexpr double sigma_c = CooledBar::sigma_c, delta_c = 4e-3, l = CooledBar::l;
    CooledBar bar(delta_c, false);
    for (int i = 1; i <= 200; ++i) {
        REQUIRE(bar.step(1. / 200).rejection == Rejection::none);
        const double strain = bar.strain(), u = bar.u().x(), exact = (strain - sigma_c) / (1 / l - sigma_c / delta_c);
        if (strain < 0.999 * sigma_c) CHECK(std::abs(u) < 1e-12);
        if (strain > 1.001 * sigma_c && strain < 0.999 * delta_c / l) {
            CHECK(std::abs(u - exact) < 1e-6 * delta_c);
            CHECK(bar.beta() == relative(1 - exact / delta_c, 1e-6));
        }
        if (strain > 1.001 * delta_c / l) {
            CHECK(bar.beta() == 0);
            CHECK(u == relative(strain * l, 1e-6));
        }
    }
    CHECK(bar.ledger.largest_residual() < 1e-13 * bar.ledger.largest_energy());
}

// E/l < sigma_c/delta_c: no equilibrium between u = 0 and the broken bar. What its elastic energy exceeds G_c S by is radiated: the
// scheme dissipates it (theta = 1) together with G_c S itself, which is the law lag of a snap within one step: cohesion at the
// end of the step does no work any more.
TEST_CASE("an interface in a clamped bar that cools snaps where E/l < sigma_c/delta_c") {
    constexpr double sigma_c = CooledBar::sigma_c, delta_c = 5e-4, l = CooledBar::l, S = 0.1;
    CooledBar bar(delta_c, false);
    for (int i = 1; i <= 100; ++i) {
        REQUIRE(bar.step(1. / 200).rejection == Rejection::none);
        if (bar.strain() < 0.999 * sigma_c) CHECK(bar.beta() == 1);
        if (bar.strain() < 1.03 * sigma_c) continue;
        CHECK(bar.beta() == 0);
        CHECK(bar.u().x() == relative(bar.strain() * l, 1e-4));
    }
    const double G_c = 0.5 * sigma_c * delta_c, before = 0.5 * sigma_c * sigma_c * l * S;
    CHECK(bar.ledger.row().dissipated == relative(G_c * S, 1e-12));
    const EnergyRow& end = bar.ledger.row();
    CHECK(std::abs(end.cohesive_work) < 1e-3 * G_c * S);
    CHECK(end.scheme_dissipation + end.cohesive_work - end.dissipated ==
          relative(before - G_c * S, 0.06));  // 2.5 % of sigma_c a step
    CHECK(bar.ledger.largest_residual() < 1e-13 * bar.ledger.largest_energy());
}

// Ends held in y as well: they hinder the contraction in y, and the diagonals of the mesh, which all lean to one side, turn that
// into a shear of the interface. It slips as soon as its strength beta sigma_c gamma falls below this shear, and the body is too
// soft against slip (u_T is of the order of u_N) to go on without a jump.
TEST_CASE("an interface in a bar whose ends are held slips before it is broken") {
    CooledBar bar(4e-3, true);
    ModelInput whole = CooledBar::input(4e-3, true);
    whole.laws[1] = CohesiveLaw::unbreakable();
    Run elastic(std::move(whole), CooledBar::implicit);
    const auto shear = [&] {  // [Pa] force across the middle over the area; constant along the bar
        double sum = 0;
        for (Index t = 0; t < elastic.model.mesh.n_triangles(); ++t) sum += stress(elastic.model, elastic.now, t)[2];
        return sum / elastic.model.mesh.n_triangles();
    };
    double beta = 1, before = 0;
    while (std::abs(bar.u().y()) < 1e-9) {
        beta = bar.beta(), before = std::abs(shear());
        REQUIRE(bar.now.time < 1);
        REQUIRE(bar.step(1. / 200).rejection == Rejection::none);
        REQUIRE(elastic.step(1. / 200).rejection == Rejection::none);
    }
    const double next = 1 - (bar.strain() - CooledBar::sigma_c) / 0.75 / 4e-3;  // beta, had it not slipped
    CHECK(before < beta * CooledBar::sigma_c);
    CHECK(std::abs(shear()) > next * CooledBar::sigma_c);
    CHECK(bar.beta() == 0);
}

// Timoshenko 1925, layers equal but for a: curvature 1.5 da dT/H; plane strain: a (1 + nu).
TEST_CASE("H2 a strip of two layers bends by 1.5 da dT/H") {
    describe(
        "Two layers equal but for a (S. Timoshenko 1925): curvature away from the ends, order 2, plane stress and "
        "plane strain.");
    constexpr double H = 1, L = 10, da = 2e-5, dT = 80;
    for (const PlaneModel plane : {PlaneModel::stress, PlaneModel::strain}) {
        Mesh mesh = strip(40, 4, L, H, 2);
        for (Index t = 0; t < mesh.n_triangles(); ++t) mesh.region[t] = mesh.centroid(t).y() > 0.5 * H;
        ModelInput input = heated(std::move(mesh), field("80", {a, a + da}), unit, CohesiveLaw::unbreakable(), plane);
        input.loads = pins(L);
        const Still bent(std::move(input));
        const auto u_y = [&](double x) {
            for (Index c = 0; c < bent.model.mesh.n_corners(); ++c)
                if ((bent.model.mesh.corner(c) - Vec2(x, 0.5 * H)).norm() < 1e-9)
                    return bent.now.displacement_of(c).y();
            return std::nan("");
        };
        const double curvature = (u_y(4) - 2 * u_y(5) + u_y(6)) / 1;
        const double factor = plane == PlaneModel::strain ? 1 + unit.nu : 1;
        verify(plane == PlaneModel::strain ? "curvature, plane strain" : "curvature, plane stress", -curvature,
               1.5 * factor * da * dT / H, {2e-6});
    }
}

// K/(E a th0 sqrt W) = 0.759 (a/W = 1/4), 0.624 +- 0.003 (1/2): two independent prototypes. K^2/E = G from the energies of
// two lengths; the strip has half the length 2 W, its ends are held in x, the crack starts at the cold edge.
TEST_CASE("H5 an edge crack in a strip under a linear temperature has the known stress intensity") {
    describe(
        "Strip of width W and length 4 W, ends held in x, T = th0 (2 y/W - 1), crack a from the cold edge: K/(E a th0 "
        "sqrt W) by energies of "
        "two lengths, order 2, W/24, against finite elements and Tada's compliances (two prototypes).");
    constexpr double W = 1;
    const auto energy = [&](int n, int n_open) {
        Mesh mesh = strip(4 * n, n, 4 * W, W, 2);
        for (InteriorEdge& edge : mesh.interior_edges) {
            const Vec2 p = mesh.corner(edge.triangle[0], edge.side[0]),
                       q = mesh.corner(edge.triangle[0], (edge.side[0] + 1) % 3);
            edge.cracked = std::abs(p.x() - 2 * W) < 1e-9 && std::abs(q.x() - 2 * W) < 1e-9 &&
                           std::max(p.y(), q.y()) < (n_open + 0.5) * W / n;
        }
        ModelInput input = heated(std::move(mesh), field("100*(2*y - 1)", {a}), unit);
        input.loads = {load(Load::Kind::displacement, "left", 0.0, std::nullopt),
                       load(Load::Kind::displacement, "right", 0.0, std::nullopt), pin({0, 0}, false, true)};
        return Still(std::move(input)).strain_energy();
    };
    const auto K = [&](int n, int n_open) {
        const double G = (energy(n, n_open - 1) - energy(n, n_open + 1)) / (2 * W / n);
        return std::sqrt(G) / (a * 100 * std::sqrt(W));
    };
    verify("K, a/W = 1/4", K(24, 6), 0.759, {6e-3});
    verify("K, a/W = 1/2", K(24, 12), 0.624, {6e-3});
}

// Plane stress, equal E: pressure E da dT/2 inside, hoop stress +that (R/r)^2 outside, in a plate of radius b less (R/b)^2 of it.
TEST_CASE("H6 a disc that expands more than the plate round it") {
    describe(
        "Disc of radius 1 in a free plate of radius 4, equal E and nu, mismatch da dT: pressure inside and hoop stress "
        "at r = 2, order 2.");
    const auto ring = [](double radius, int n) {
        std::vector<Vec2> points;
        for (int i = 0; i < n; ++i)
            points.push_back(radius * Vec2(std::cos(2 * M_PI * i / n), std::sin(2 * M_PI * i / n)));
        return points;
    };
    Shape shape;
    shape.outer.points = ring(4, 80);
    shape.outer.boundary.assign(80, 0);
    shape.boundary_names = {"rim"};
    shape.regions = {{.points = ring(1, 40), .tag = 1}};
    MeshOptions sizes;
    sizes.size = 0.25;
    Mesh mesh = triangulate(shape, sizes);
    mesh.order = 2;
    const Still plate(heated(std::move(mesh), field("50", {a, 3 * a}), unit));
    const double P = 0.5 * 2 * a * 50, far = 1. / 16;
    double inside = 0, n_inside = 0, hoop = 0, n_hoop = 0;
    for (Index t = 0; t < plate.model.mesh.n_triangles(); ++t) {
        const Vec2 x = plate.model.mesh.centroid(t);
        const Eigen::Vector3d s = plate.stress(t);
        const double r2 = x.squaredNorm();
        const Vec2 along = turned_left(x) / std::sqrt(r2);
        if (r2 < 0.6) inside -= 0.5 * (s[0] + s[1]), ++n_inside;
        if (r2 > 2.5 && r2 < 6)
            hoop += (s[0] * along.x() * along.x() + s[1] * along.y() * along.y() + 2 * s[2] * along.x() * along.y()) /
                    (1 / r2 + far),
                ++n_hoop;
    }
    verify("pressure inside", inside / n_inside, P * (1 - far), {1e-2});
    verify("hoop stress outside over (R/r)^2 + (R/b)^2", hoop / n_hoop, P, {1e-2});
}

// The energy balance of src/heat/README.md: E - E_start = works + thermal work, for strains that change in every step, while the body
// tears, with steps of changing size.
TEST_CASE("the energy balance with changing temperatures closes to rounding") {
    for (const SchemeOptions& scheme : all_paths())
        for (const Index order : {1, 2}) {
            if (scheme.bulk == BulkScheme::explicit_lumped && scheme.cohesion == CohesionScheme::implicit_beta)
                continue;
            on_path(scheme);
            for (const double theta : {0.5, 0.8}) {
                if (theta > 0.5 && scheme.bulk == BulkScheme::explicit_lumped) continue;
                if (order == 2 && theta > 0.5) continue;
                SchemeOptions options = scheme;
                options.theta = theta;
                options.respect_assumption_1 = false;
                Heat heat = field("120*sin(3*t + 2*x)*cos(y - 5*t) + 40*x*y", {a});
                heat.every = 3;
                ModelInput input = heated(strip(4, 2, 2, 1, order), heat, unit, weak, PlaneModel::strain);
                input.loads = {load(Load::Kind::displacement, "left", 0.0, std::nullopt)};
                Run run(std::move(input), options);
                const double stable = scheme.bulk == BulkScheme::implicit_theta ? 0.02 : run.stepper.stable_step();
                int taken = 0;
                for (int i = 0; i < 200; ++i) taken += run.step_if_taken(stable * (0.6 + 0.2 * std::sin(i)));
                CHECK(taken > 100);
                CHECK(std::abs(run.ledger.row().thermal_work) > 0.05 * run.ledger.largest_energy());
                CHECK(run.ledger.largest_residual() < 1e-13 * run.ledger.largest_energy());
                CHECK(run.ledger.row().scheme_dissipation >= 0);
                CHECK(!run.now.split_fans.empty());
            }
        }
}

}  // namespace thermal_strain_test
