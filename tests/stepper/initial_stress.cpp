// Stresses of the undeformed body, and tractions that vary over place and time: columns under their weight, a tunnel
// against Kirsch, and impulses.
#include "mesh/triangulate.hpp"
#include "support/paths.hpp"
#include "support/plates.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <string>

namespace initial_stress_test {

using namespace knap;
using namespace knap::tests;

namespace {

constexpr double weight = 27e3, K0 = 0.5, H = 40, W = 20;  // [N/m3], [-], [m], [m]
constexpr double g = 10;

PlaceField field(const std::string& xx, const std::string& yy, const std::string& xy = "0", double unit = 1) {
    const auto formula = [&](const std::string& text) { return PlaceField::Formula{Expression(text), unit}; };
    return {.path = "initial[0].stress", .formulas = {formula(xx), formula(yy), formula(xy)}};
}

/// Of a free surface at y = 40 m.
PlaceField k0_stress() { return field("-13.5*(40 - y)", "-27*(40 - y)", "0", 1e3); }

/// A column under its weight with the K0 state; rollers at the sides, or the stress of the state on them.
ModelInput column(Index order, bool large_rotation, bool rollers, const PlaceField& stress = k0_stress()) {
    ModelInput input = body_with(bar_mesh(5, 10, W, H), {.density = weight / g, .E = 10e9, .nu = 0.25},
                                 {.sigma_c = 1e6, .G_c = 100, .gamma = 1, .friction = 0.6});
    input.mesh.order = order;
    input.large_rotation = large_rotation;
    input.initial_stresses = {{.on = {}, .field = stress}};
    input.loads = {load(Load::Kind::acceleration, "", 0, -g), load(Load::Kind::displacement, "bottom", {}, 0)};
    for (const char* side : {"left", "right"})
        if (rollers) input.loads.push_back(load(Load::Kind::displacement, side, 0, {}));
        else
            input.loads.push_back({.kind = Load::Kind::stress,
                                   .on = {.boundary = side, .box = {}},
                                   .field = std::make_shared<PlaceField>(k0_stress())});
    if (!rollers) input.loads[1].value[0] = 0;
    return input;
}

/// [-] Largest error of the stress in the middles of the triangles, over the largest stress.
double error_of_stress(const Model& model, const State& state) {
    double error = 0;
    for (Index t = 0; t < model.mesh.n_triangles(); ++t) {
        const double v = -weight * (H - model.mesh.centroid(t).y());
        error = std::max(error, (stress(model, state, t) - Eigen::Vector3d(K0 * v, v, 0)).norm());
    }
    return error / (weight * H);
}

double largest_speed(const State& state) {
    double largest = 0;
    for (const Vec2& v : state.velocity) largest = std::max(largest, v.norm());
    return largest;
}

}  // namespace

TEST_CASE("initial stress: a column under its weight with its K0 state rests from the first step on") {
    double stress_error = 0, speed = 0;
    for (const bool implicit : {false, true})
        for (const bool rollers : {false, true})
            for (const auto& [order, large] : {std::pair{1, false}, std::pair{2, false}, std::pair{1, true}}) {
                CAPTURE(implicit);
                CAPTURE(rollers);
                CAPTURE(order);
                CAPTURE(large);
                Run run(column(order, large, rollers),
                        {.bulk = implicit ? BulkScheme::implicit_theta : BulkScheme::explicit_lumped});
                const double h = implicit ? 1e-3 : 0.5 * run.stepper.stable_step();
                for (int i = 0; i < 100; ++i) run.step(h);
                CHECK(run.now.split_fans.empty());
                stress_error = std::max(stress_error, error_of_stress(run.model, run.now));
                speed = std::max(speed, largest_speed(run.now));
            }
    MESSAGE("largest error of a stress, over the largest: " << stress_error << ", speed " << speed << " m/s");
    CHECK(stress_error < 1e-11);
    CHECK(speed < 1e-12 * g * H / 2100);  // of the time in which a wave passes
}

TEST_CASE("initial stress: a start in equilibrium strains what the loads do not balance") {
    // half of the vertical stress is given: the weight adds the other half, with nu/(1 - nu) of it sideways
    for (const Index order : {1, 2}) {
        Run run(column(order, false, true, field("0", "-13.5*(40 - y)", "0", 1e3)),
                {.bulk = BulkScheme::implicit_theta});
        State start = run.now;
        run.stepper.start_in_equilibrium(start);
        double error = 0;
        for (Index t = 0; t < run.model.mesh.n_triangles(); ++t) {
            const double v = -weight * (H - run.model.mesh.centroid(t).y());
            const Eigen::Vector3d exact(0.5 * v * 0.25 / 0.75, v, 0);
            error = std::max(error, (stress(run.model, start, t) - exact).norm() / (weight * H));
        }
        CAPTURE(order);
        CHECK(error < (order == 1 ? 0.02 : 1e-8));  // strains that are linear in y: exact with order 2
        CHECK(start.displacement[0].norm() < 1e-2);
        double sag = 0;
        for (const Vec2& u : start.displacement) sag = std::min(sag, u.y());
        // of (1 + nu)(1 - 2 nu)/((1 - nu) E) times the integral of half the weight over the height
        CHECK(sag == relative(-1.25 * 0.5 / (0.75 * 10e9) * 0.5 * weight * H * H / 2, order == 1 ? 1e-2 : 1e-8));
    }
}

TEST_CASE("initial stress: it and its forces turn with the body") {
    ModelInput input = body_with(bar_mesh(2, 2, 2, 1), {.density = 1, .E = 1e3, .nu = 0.2}, CohesiveLaw::unbreakable());
    input.large_rotation = true;
    input.initial_stresses = {{.on = {}, .field = field("3", "-1", "0.5")}};
    const Model model = make_model(std::move(input));
    const State start = initial_state(model);
    State turned_state = start;
    const Rotation R = Rotation::by(0.7);
    for (Index c = 0; c < model.mesh.n_corners(); ++c)
        turned_state.displacement[turned_state.node_of_corner[c]] =
            R.turned(model.mesh.corner(c)) - model.mesh.corner(c);
    REQUIRE(model.corner_loads.size() == 3 * static_cast<std::size_t>(model.mesh.n_triangles()));
    for (const CornerLoad& at : model.corner_loads)
        CHECK((force_of(model, at, turned_state) - R.turned(at.force)).norm() < 1e-13);
    const double c = std::cos(0.7), s = std::sin(0.7);
    const Eigen::Matrix2d turn = (Eigen::Matrix2d() << c, -s, s, c).finished(),
                          own = (Eigen::Matrix2d() << 3, 0.5, 0.5, -1).finished(), seen = turn * own * turn.transpose();
    const Eigen::Vector3d found = stress(model, turned_state, 0);
    CHECK((found - Eigen::Vector3d(seen(0, 0), seen(1, 1), seen(0, 1))).norm() < 1e-12);
}

TEST_CASE("initial stress: later ones overwrite earlier ones and a field needs a value everywhere") {
    const auto input = [](std::vector<InitialStress> stresses) {
        ModelInput made = body_with(bar_mesh(4, 1, 4, 1), {.density = 1, .E = 1, .nu = 0}, CohesiveLaw::unbreakable());
        made.initial_stresses = std::move(stresses);
        return made;
    };
    const Model model =
        make_model(input({{.on = {}, .field = field("x", "0")},
                          {.on = {.boundary = "", .box = Box{{2, 0}, {4, 1}}}, .field = field("9", "0")}}));
    CHECK(model.initial_stress[0][0] == relative(model.mesh.centroid(0).x(), 1e-15));
    CHECK(model.initial_stress.back()[0] == 9);
    CHECK_THROWS_AS(make_model(input({{.on = {}, .field = field("1/(x - x)", "0")}})), BadPlace);
    CHECK_THROWS_AS(make_model(input({{.on = {.boundary = "", .box = Box{{8, 0}, {9, 1}}}, .field = field("1", "0")}})),
                    EmptySelection);
    PlaceField table{.path = "initial[0].stress"};
    table.table = std::make_shared<PointTable>(
        std::vector<PointTable::Row>{{{0, 0}, {1, 0, 0}}, {{1, 0}, {1, 0, 0}}, {{0, 1}, {1, 0, 0}}});
    CHECK_THROWS_AS(make_model(input({{.on = {}, .field = table}})), BadPlace);
}

TEST_CASE("a traction over place and time gives its impulse in both schemes") {
    // 3 t (1 + x) on the top of a free block of 4 x 1: the force is 3 t (4 + 8), its impulse 18 t^2
    for (const Index order : {1, 2})
        for (const bool implicit : {false, true}) {
            ModelInput input =
                body_with(bar_mesh(4, 1, 4, 1), {.density = 2, .E = 1e3, .nu = 0.2}, CohesiveLaw::unbreakable());
            input.mesh.order = order;
            input.loads = {{.kind = Load::Kind::traction,
                            .on = {.boundary = "top", .box = {}},
                            .field = std::make_shared<PlaceField>(field("0", "3*t*(1 + x)"))}};
            Run run(std::move(input),
                    {.bulk = implicit ? BulkScheme::implicit_theta : BulkScheme::explicit_lumped, .theta = 0.5});
            const double h = implicit ? 0.01 : 0.4 * run.stepper.stable_step();
            for (int i = 0; i < 50; ++i) run.step(h);
            double momentum = 0;
            for (Index c = 0; c < run.model.mesh.n_corners(); ++c)
                momentum += run.model.corner_mass[c] * run.now.velocity[run.now.node_of_corner[c]].y();
            CAPTURE(order);
            CAPTURE(implicit);
            // kicks at the starts of steps: the velocity is that of the middle of the last one
            const double t = run.now.time - (implicit ? 0 : 0.5 * h);
            const double of_kicks = implicit ? 18 * t * t : 36 * h * h * 49 * 50 / 2;
            CHECK(momentum == relative(of_kicks, 1e-10));
            CHECK(run.ledger.row().residual < 1e-12);
        }
}

// G. Kirsch, Z. VDI 42, 1898, 797, in plane strain (E' = E/(1 - nu^2), nu' = nu/(1 - nu)), hole of radius 1 in the
// stress (sigma_h, sigma_v):
// the displacements that it causes on its wall are
//     u_r = ((sigma_h + sigma_v)(1 + nu') + (sigma_h - sigma_v)(3 - nu') cos 2 theta)/(2 E')
// and the hoop stress there is sigma_h + sigma_v - 2 (sigma_h - sigma_v) cos 2 theta.
TEST_CASE("initial stress: a tunnel in rock under a K0 state moves as that of Kirsch") {
    constexpr double L = 4, E = 30e9, nu = 0.25, v = -20e6, h = -10e6;
    // superposition of both stresses; c2, s2, c4, s4: cosines and sines of 2 and 4 theta
    const std::string r2 = "(x*x + y*y)", c2 = "((x*x - y*y)/" + r2 + ")", s2 = "(2*x*y/" + r2 + ")",
                      c4 = "(" + c2 + "^2 - " + s2 + "^2)", s4 = "(2*" + s2 + "*" + c2 + ")", a2 = "(1/" + r2 + ")",
                      a4 = "(" + a2 + "^2)";
    // of a stress along x; along y theta is pi/2 less: c2, s2 change their sign, and xx and yy their places
    const auto sum = [&](const std::string& along_x, const std::string& along_y) {
        return "-10*(" + along_x + ") - 20*(" + along_y + ")";
    };
    const PlaceField exact = field(sum("1 - " + a2 + "*(1.5*" + c2 + " + " + c4 + ") + 1.5*" + a4 + "*" + c4,
                                       "-" + a2 + "*(-0.5*" + c2 + " - " + c4 + ") - 1.5*" + a4 + "*" + c4),
                                   sum("-" + a2 + "*(0.5*" + c2 + " - " + c4 + ") - 1.5*" + a4 + "*" + c4,
                                       "1 - " + a2 + "*(-1.5*" + c2 + " + " + c4 + ") + 1.5*" + a4 + "*" + c4),
                                   sum("-" + a2 + "*(0.5*" + s2 + " + " + s4 + ") + 1.5*" + a4 + "*" + s4,
                                       a2 + "*(-0.5*" + s2 + " + " + s4 + ") - 1.5*" + a4 + "*" + s4),
                                   1e6);
    std::vector<double> error, hoop;
    for (const double size : {0.4, 0.2, 0.1}) {
        ModelInput input =
            body_with(plate_with_hole(L, size), {.density = 2600, .E = E, .nu = nu}, CohesiveLaw::unbreakable());
        input.initial_stresses = {{.on = {}, .field = field("-10", "-20", "0", 1e6)}};
        input.loads = {{.kind = Load::Kind::stress,
                        .on = {.boundary = "rim", .box = {}},
                        .field = std::make_shared<PlaceField>(exact)}};
        hold_middles_of_sides(input, L);
        const Model model = make_model(std::move(input));
        State state = initial_state(model);
        MoreauJean(model, {}).start_in_equilibrium(state);
        const double E_strain = E / (1 - nu * nu), nu_strain = nu / (1 - nu);
        const auto u_r = [&](double cos2) {
            return ((h + v) * (1 + nu_strain) + (h - v) * (3 - nu_strain) * cos2) / (2 * E_strain);
        };
        double largest = 0, of_hoop = 0;
        for (Index c = 0; c < model.mesh.n_corners(); ++c) {
            const Vec2 x = model.mesh.corner(c);
            const double r = x.norm();
            if (r > 1 + 1e-9) continue;
            const double cos2 = (x.x() * x.x() - x.y() * x.y()) / (r * r);
            largest = std::max(largest, std::abs(state.displacement_of(c).dot(x) / r - u_r(cos2)) / std::abs(u_r(-1)));
        }
        for (Index t = 0; t < model.mesh.n_triangles(); ++t) {
            const Vec2 x = model.mesh.centroid(t);
            const std::array<double, 3> known = exact.at(x, 0);
            of_hoop = std::max(of_hoop,
                               (stress(model, state, t) - Eigen::Vector3d(known[0], known[1], known[2])).norm() / 50e6);
        }
        error.push_back(largest), hoop.push_back(of_hoop);
    }
    MESSAGE("errors of u_r: " << error[0] << " " << error[1] << " " << error[2] << ", of the stress: " << hoop[0] << " "
                              << hoop[1] << " " << hoop[2]);
    CHECK(error[2] < 1.2e-2);
    CHECK(std::log2(error[0] / error[2]) / 2 > 1.5);
    CHECK(hoop[2] < 0.6 * hoop[0]);
}

}  // namespace initial_stress_test
