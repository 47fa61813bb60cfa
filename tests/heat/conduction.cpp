// Conduction against series, its book and its maximum principle (H3, H4).
#include "heat/conduction.hpp"

#include "heat_bodies.hpp"
#include "mesh/triangulate.hpp"
#include "model/make_model.hpp"
#include "support/paths.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

namespace conduction_test {

using namespace knap;
using namespace knap::tests;

namespace {

using Kind = HeatExchange::Kind;
constexpr Elastic unit{.density = 1, .E = 1, .nu = 0.25};

/// k = rho = c = 1, so that time is Fo on a length of 1.
Heat conducting(const std::string& start, std::vector<double> expansion = {0}) {
    Heat heat = field(start, std::move(expansion));
    for (Thermal& material : heat.materials) material.conductivity = material.heat_capacity = 1;
    heat.conduction = true;
    heat.every = 1;
    return heat;
}

HeatExchange exchange(Kind kind, const std::string& boundary, double value, double transfer = 0) {
    return {.kind = kind, .on = {.boundary = boundary}, .value = value, .transfer = transfer};
}

/// A state whose temperatures are those of the heat, and nothing moves.
struct Slab {
    explicit Slab(ModelInput input)
        : model(make_model(std::move(input))), conduction(model), now(initial_state(model)) {}
    void go(double end, bool implicit) {
        now.temperature = implicit ? conduction.implicit_step(now, end) : conduction.explicit_step(now, end);
    }
    double at(const Vec2& place) const {
        for (Index c = 0; c < model.mesh.n_corners(); ++c)
            if ((model.mesh.corner(c) - place).norm() < 1e-9) return now.temperature->of_corner[c];
        return std::nan("");
    }
    double book() const {
        const Temperatures& T = *now.temperature;
        return std::abs(T.heat - T.heat_in) / (T.heat_scale + T.heat_moved);
    }
    Model model;
    Conduction conduction;
    State now;
};

Mesh mesh_of_order(Mesh mesh, Index order) {
    mesh.order = order;
    return mesh;
}

}  // namespace

// Half of a plate of thickness 2 L = 2: its face y = 1 is cooled with Bi = 10, the middle y = 0 is insulated.
TEST_CASE("H3 a plate that convection cools follows its Fourier series") {
    describe(
        "Half a plate with Bi = 10 (a L/k): temperature over the initial one at the face, in the middle and in the "
        "mean against the "
        "series mu tan mu = Bi, at Fo = 0.05 and 0.2, forward Euler below its limit and backward Euler.");
    for (const Index order : {1, 2})
        for (const bool implicit : {false, true}) {
            Heat heat = conducting("1");
            heat.exchanges = {exchange(Kind::convection, "top", 0, 10)};
            Slab slab(heated(mesh_of_order(bar_mesh(2, 60 / order, 0.05, 1), order), heat, unit));
            const int n = implicit ? 400 : 1;
            const double expected[2][3] = {{0.232326, 0.998530, 0.824454}, {0.122482, 0.829255, 0.583262}};
            const double times[] = {0.05, 0.2};
            on_path(implicit ? "backward Euler" : "forward Euler");
            for (int i = 0; i < 2; ++i) {
                const double from = i == 0 ? 0 : times[0];
                for (int step = 1; step <= n; ++step) slab.go(from + (times[i] - from) * step / n, implicit);
                const std::string Fo = ", Fo = " + digits(times[i]) + ", order " + std::to_string(order);
                verify("temperature of the face" + Fo, slab.at({0, 1}), expected[i][0], {4e-3});
                verify("temperature of the middle" + Fo, slab.at({0, 0}), expected[i][1], {1e-3});
                verify("mean temperature" + Fo, 1 + slab.now.temperature->heat / 0.05, expected[i][2], {1e-3});
            }
            CHECK(slab.book() < 1e-13);
            CHECK(slab.now.temperature->overshoot <= 1e-14);
        }
}

TEST_CASE("heat is conserved to rounding and stays between its bounds on a random mesh with open cracks") {
    Shape shape;
    shape.outer.points = {{0, 0}, {2, 0}, {2, 1}, {0, 1}};
    shape.outer.boundary = {0, 1, 2, 3};
    shape.boundary_names = {"bottom", "right", "top", "left"};
    MeshOptions sizes;
    sizes.size = 0.08;
    const Mesh mesh = triangulate(shape, sizes);
    Mesh cracked = mesh;  // everywhere: every vertex is split
    for (InteriorEdge& edge : cracked.interior_edges) edge.cracked = true;
    for (const bool implicit : {false, true}) {
        Heat heat = conducting("100*x - 50*y");
        heat.exchanges = {exchange(Kind::convection, "top", -20, 30), exchange(Kind::temperature, "left", 250)};
        heat.gap_conductivity = 1e-3;
        Slab slab(heated(cracked, heat, unit));
        for (std::size_t i = 0; i < slab.now.displacement.size(); ++i)
            slab.now.displacement[i] = 1e-3 * Vec2(std::sin(i), std::cos(3. * i));
        for (int i = 1; i <= 20; ++i) slab.go(1e-3 * i, implicit);
        CHECK(slab.book() < 1e-13);
        CHECK(slab.now.temperature->heat_moved > 0.1 * slab.now.temperature->heat_scale);
        CHECK(slab.now.temperature->overshoot < 1e-3 * slab.now.temperature->range);
        Slab whole(heated(mesh, heat, unit));
        for (int i = 1; i <= 20; ++i) whole.go(1e-3 * i, implicit);
        CHECK(whole.book() < 1e-13);
        CHECK(whole.now.temperature->overshoot <= 1e-12);  // Delaunay: the maximum principle holds
    }
}

TEST_CASE("flux and sources heat a body by what they supply") {
    for (const bool implicit : {false, true}) {
        Heat heat = conducting("5");
        heat.exchanges = {exchange(Kind::flux, "right", 3), {.kind = Kind::source, .on = {}, .value = 2}};
        heat.exchanges[0].history = {.time = {0, 10}, .value = {1, 1}};
        Slab slab(heated(bar_mesh(6, 3, 2, 1), heat, unit));
        slab.go(0.25, implicit), slab.go(0.5, implicit);
        CHECK(slab.now.temperature->heat == relative(0.5 * (3 * 1 + 2 * 2), 1e-12));
        CHECK(slab.book() < 1e-14);
        heat.time_factor = 100;  // a hundredth of the capacity: temperatures rise a hundred times faster
        Slab fast(heated(bar_mesh(6, 3, 2, 1), heat, unit));
        slab.go(1, implicit), fast.go(0.01, implicit);
        CHECK(fast.at({1, 0.}) == relative(slab.at({1, 0.}), implicit ? 0.05 : 2e-3));
    }
}

TEST_CASE("heat between steps: a flux and a source give all of their heat and a warm moment is no overshoot") {
    const TimeFunction pulse{{0, 0.2121, 0.2122, 0.2127, 0.213}, {0, 0, 1, 1, 0}},
        several{{0, 0.11, 0.18, 0.18, 0.37}, {0, 0, 2, 1, 0}};
    for (const bool implicit : {false, true})
        for (const auto& [table, integral] : {std::pair{&pulse, 7e-4}, {&several, 0.165}}) {
            Heat heat = conducting("5");
            heat.exchanges = {exchange(Kind::flux, "right", 3), {.kind = Kind::source, .on = {}, .value = 2}};
            for (HeatExchange& each : heat.exchanges) each.history = *table;
            Slab slab(heated(bar_mesh(6, 3, 2, 1), heat, unit));
            for (int i = 1; i <= 10; ++i) slab.go(0.05 * i, implicit);
            CHECK(slab.now.temperature->heat_in == relative(integral * (3 * 1 + 2 * 2), 1e-12));
            CHECK(slab.book() < 1e-14);
        }
    for (const Kind kind : {Kind::temperature, Kind::convection}) {
        Heat heat = conducting("5");
        heat.exchanges = {exchange(kind, "right", 50, kind == Kind::convection ? 3 : 0)};
        heat.exchanges[0].history = pulse;
        heat.exchanges[0].value = 50, heat.reference = 5;
        Slab slab(heated(bar_mesh(6, 3, 2, 1), heat, unit));
        for (int i = 1; i <= 10; ++i) slab.go(0.05 * i, false);
        CHECK(slab.now.temperature->heat > 1e-4);  // it had been lost between two steps
        CHECK(slab.now.temperature->overshoot <= 1e-12);
        CHECK(slab.book() < 1e-14);
    }
}

TEST_CASE("heat in steps far beyond the passage of an edge is balanced to the rounding of its flows") {
    Heat heat = conducting("20");
    heat.exchanges = {exchange(Kind::temperature, "left", 100)};
    Slab slab(heated(bar_mesh(20, 10, 2, 1), heat, unit));
    for (int i = 1; i <= 3; ++i) slab.go(1e8 * i, true);
    CHECK(slab.at({2, 0}) == relative(100, 1e-6));
    CHECK(slab.book() < 1e-11);
}

// h = 1/(u_N/k_f + 1/h_0): the jump of temperature at an open crack in a bar between 0 and 1.
TEST_CASE("an open crack resists as the gap that it is") {
    Heat heat = conducting("0", {0, 0});
    heat.exchanges = {exchange(Kind::temperature, "left", 0), exchange(Kind::temperature, "right", 1)};
    heat.gap_conductivity = 0.02;
    heat.closed_conductance = 40;
    Mesh mesh = bar_mesh(8, 2, 1, 0.25, [](int i) { return i < 4 ? 0 : 1; });
    for (InteriorEdge& edge : mesh.interior_edges)
        edge.cracked = mesh.region[edge.triangle[0]] != mesh.region[edge.triangle[1]];
    const ModelInput input = heated(std::move(mesh), heat, unit);
    for (const double u : {0.0, 0.01, 0.05}) {
        Slab slab(input);
        for (Index c = 0; c < slab.model.mesh.n_corners(); ++c)
            if (slab.model.mesh.region[slab.model.mesh.triangle_of(c)] == 1)
                slab.now.displacement[slab.now.node_of_corner[c]] = {u, 0};
        for (int i = 1; i <= 60; ++i) slab.go(i, true);
        const double resistance = u / 0.02 + 1. / 40, flow = 1 / (1 + resistance);
        double right = 0, left = 0;  // of the crack
        for (Index c = 0; c < slab.model.mesh.n_corners(); ++c)
            if (std::abs(slab.model.mesh.corner(c).x() - 0.5) < 1e-9)
                (slab.model.mesh.region[slab.model.mesh.triangle_of(c)] == 1 ? right : left) =
                    slab.now.temperature->of_corner[c];
        CHECK(right - left == relative(flow * resistance, 1e-9));
        CHECK(left == relative(0.5 * flow, 1e-9));
    }
}

// Sih 1962: an insulated crack of length 2 a across a uniform flow of gradient g has the jump 2 g a in its middle.
TEST_CASE("H4 an insulated crack across a heat flow has the jump 2 a g") {
    describe(
        "An insulated crack of length 2 a = 2 across a flow of heat of gradient 1, in a plate of width 6 with "
        "insulated sides: jump of "
        "temperature in its middle against the periodic solution (Sih 1962 for the infinite plate: 2 a g).");
    Mesh mesh = bar_mesh(120, 160, 6, 8);
    for (InteriorEdge& edge : mesh.interior_edges) {
        const Vec2 p = mesh.corner(edge.triangle[0], edge.side[0]),
                   q = mesh.corner(edge.triangle[0], (edge.side[0] + 1) % 3);
        edge.cracked =
            std::abs(p.y() - 4) < 1e-9 && std::abs(q.y() - 4) < 1e-9 && std::abs(0.5 * (p.x() + q.x()) - 3) < 1;
    }
    Heat heat = conducting("y");
    heat.exchanges = {exchange(Kind::temperature, "bottom", 0), exchange(Kind::temperature, "top", 8)};
    heat.closed_conductance = heat.gap_conductivity = 0;
    Slab slab(heated(std::move(mesh), heat, unit));
    for (int i = 1; i <= 4; ++i) slab.go(1e4 * i, true);
    double low = 1e300, high = -1e300;
    for (Index c = 0; c < slab.model.mesh.n_corners(); ++c)
        if ((slab.model.mesh.corner(c) - Vec2(3, 4)).norm() < 1e-9) {
            low = std::min(low, slab.now.temperature->of_corner[c]);
            high = std::max(high, slab.now.temperature->of_corner[c]);
        }
    // a = 1 between insulated walls at a distance of 2 b = 6: 4 b/pi arcosh(1/cos(pi a/(2 b))) g instead of 2 a g
    // where the crack adds the resistance of a length 4 b/pi ln(1/cos(pi a/(2 b))) to that of the plate
    const double b = 3, secant = 1 / std::cos(std::numbers::pi / (2 * b)),
                 g = 8 / (8 + 4 * b / std::numbers::pi * std::log(secant)),
                 exact = 4 * b / std::numbers::pi * std::acosh(secant) * g;
    verify("jump of temperature", high - low, exact, {0.025});
}

// The thermal displacement a_th Re int Theta dz of the flow Theta = -i g sqrt(z^2 - a^2) has the jump a_th g (x sqrt(a^2 - x^2) - a^2
// arccos(x/a)). Dislocations c arccos(x/a) make the faces meet at both ends: c = a_th g a^2, and x sqrt(a^2 - x^2) stays.
TEST_CASE("H4 the faces of an insulated crack across a heat flow slide") {
    describe(
        "The same crack in a free plate of 24 x 24, order 2, a/25 at the crack: K_II/(E a_th g a^1.5) from the slip of "
        "its faces, which is a_th g x "
        "sqrt(a^2 - x^2), against sqrt(pi)/4 (Sih 1962); g is that of the periodic solution.");
    constexpr double W = 24, a_th = 1e-5;
    Shape shape;
    shape.outer.points = {{0, 0}, {W, 0}, {W, W}, {0, W}};
    shape.outer.boundary = {0, 1, 2, 3};
    shape.boundary_names = {"bottom", "right", "top", "left"};
    shape.cracks = {{.points = {{0.5 * W - 1, 0.5 * W}, {0.5 * W + 1, 0.5 * W}}}};
    MeshOptions sizes;
    sizes.size = 1;
    sizes.refine = {{{{0.5 * W - 1.2, 0.5 * W - 0.2}, {0.5 * W + 1.2, 0.5 * W + 0.2}}, 0.04}};
    Heat heat = conducting("y", {a_th});
    heat.exchanges = {exchange(Kind::temperature, "bottom", 0), exchange(Kind::temperature, "top", W)};
    heat.closed_conductance = heat.gap_conductivity = 0;
    ModelInput input = heated(mesh_of_order(triangulate(shape, sizes), 2), heat, unit);
    input.loads = pins(W);
    Slab slab(std::move(input));
    for (int i = 1; i <= 4; ++i) slab.go(1e6 * i, true);
    MoreauJean(slab.model, {.bulk = BulkScheme::implicit_theta}).start_in_equilibrium(slab.now);
    const double secant = 1 / std::cos(std::numbers::pi / W), g = W / (W + 2 * W / std::numbers::pi * std::log(secant));
    double product = 0, square = 0, worst = 0;
    const Mesh& mesh = slab.model.mesh;
    for (Index below = 0; below < mesh.n_corners(); ++below)
        for (Index above = 0; above < mesh.n_corners(); ++above) {
            const Vec2 x = mesh.corner(below) - Vec2(0.5 * W, 0.5 * W);
            if (std::abs(x.y()) > 1e-9 || std::abs(x.x()) > 0.99) break;
            if ((mesh.corner(above) - mesh.corner(below)).norm() > 1e-9) continue;
            if (mesh.centroid(mesh.triangle_of(below)).y() > 0.5 * W ||
                mesh.centroid(mesh.triangle_of(above)).y() < 0.5 * W)
                continue;
            const double slip = (slab.now.displacement_of(above) - slab.now.displacement_of(below)).x(),
                         exact = a_th * g * x.x() * std::sqrt(1 - x.x() * x.x());
            product += slip * exact, square += exact * exact,
                worst = std::max(worst, std::abs(x.x()) < 0.9 ? std::abs(slip - exact) : 0);
        }
    REQUIRE(square > 0);
    verify("K_II", std::sqrt(std::numbers::pi) / 4 * product / square, std::sqrt(std::numbers::pi) / 4, {0.02});
    CHECK(worst < 0.03 * a_th * g * 0.5);
}

// The largest tension of the face over all times, E a DT max(mean - theta), with theta over the thickness from conduction.
TEST_CASE("H3 the largest surface stress of a plate that convection cools") {
    describe(
        "The same half plate, 200 edges through it and steps of 1 % of the time so far: largest (mean - theta) at the "
        "face, which is the stress over "
        "E a DT of a free plate, and its time, against the series.");
    struct Row {
        double Bi, stress, Fo;
    };
    for (const Row row : {Row{0.1, 0.03088, 0.416},
                          {1, 0.20826, 0.192},
                          {5, 0.47779, 0.0730},
                          {10, 0.59351, 0.0420},
                          {20, 0.69280, 0.0228},
                          {50, 0.79428, 0.0096}}) {
        Heat heat = conducting("1");
        heat.exchanges = {exchange(Kind::convection, "top", 0, row.Bi)};
        Slab slab(heated(bar_mesh(1, 200, 0.005, 1), heat, unit));
        double largest = 0, at = 0;
        for (double Fo = 1e-5; Fo < 1.3 * row.Fo; Fo *= 1.01) {
            slab.go(Fo, true);
            const double stress = 1 + slab.now.temperature->heat / 0.005 - slab.at({0, 1});
            if (stress > largest) largest = stress, at = Fo;
        }
        const std::string of = ", Bi = " + digits(row.Bi);
        verify("largest surface stress" + of, largest, row.stress, {5e-3});
        verify("its Fo" + of, at, row.Fo, {0.05});
    }
    Heat heat = conducting("1");
    heat.exchanges = {exchange(Kind::temperature, "top", 0)};
    Slab slab(heated(bar_mesh(1, 200, 0.005, 1), heat, unit));
    for (double Fo = 1e-5; Fo < 1e-3; Fo *= 1.02) slab.go(Fo, true);
    const double Fo = slab.now.temperature->time;  // the layer has not felt the middle: mean = 1 - 2 sqrt(Fo/pi)
    verify("surface stress, Bi infinite", 1 + slab.now.temperature->heat / 0.005 - slab.at({0, 1}),
           1 - 2 * std::sqrt(Fo / std::numbers::pi), {5e-3});
}

TEST_CASE("conduction gives the same bits for 1 and 2 and 4 threads") {
    const auto end = [](int threads, bool implicit) {
        omp_set_num_threads(threads);
        Heat heat = conducting("300*exp(-x)*cos(9*y)", {1e-4});
        heat.exchanges = {exchange(Kind::convection, "top", -200, 5)};
        Slab slab(heated(bar_mesh(60, 50, 2, 1.2), heat, unit));
        for (int i = 1; i <= 3; ++i) slab.go(1e-4 * i, implicit);
        omp_set_num_threads(1);
        return std::pair(slab.now.temperature->of_corner, slab.now.temperature->heat_in);
    };
    for (const bool implicit : {false, true})
        CHECK((end(1, implicit) == end(2, implicit) && end(1, implicit) == end(4, implicit)));
}

TEST_CASE("a quenched body gives the same bits for 1 and 2 threads and keeps its energy balance") {
    const auto run_with = [](int threads) {
        omp_set_num_threads(threads);
        Heat heat = conducting("100", {1e-5});
        heat.every = 4;
        heat.materials[0].conductivity = 1e-3;
        heat.exchanges = {exchange(Kind::convection, "top", 0, 0.5)};
        auto run = std::make_unique<Run>(
            heated(bar_mesh(24, 12, 2, 1), heat, unit, {.sigma_c = 2e-4, .G_c = 1e-8, .gamma = 1, .friction = 0.2}));
        const double h = 0.8 * run->stepper.stable_step();
        for (int i = 0; i < 400; ++i) run->step(h);
        omp_set_num_threads(1);
        return run;
    };
    const auto one = run_with(1), two = run_with(2);
    CHECK(same_bits(one->now, two->now));
    CHECK(one->now.temperature->of_corner == two->now.temperature->of_corner);
    CHECK(one->now.split_fans.size() > 5);
    CHECK(one->ledger.largest_residual() < 1e-12 * one->ledger.largest_energy());
    CHECK(one->ledger.largest_heat_residual() < 1e-13);
}

// sigma = E a DT (mean - theta) in a plate that is free at its ends, plane stress; quasi-static with backward Euler.
TEST_CASE("H3 the stress of a plate that convection cools") {
    describe(
        "A plate of thickness 2, free, cooled on both faces with Bi = 10: stress over E a DT in the middle of its "
        "length against "
        "(mean - theta) of the series, implicit bulk, theta = 1.");
    Heat heat = conducting("0", {1e-5});
    heat.exchanges = {exchange(Kind::convection, "top", -1, 10), exchange(Kind::convection, "bottom", -1, 10)};
    ModelInput input = heated(bar_mesh(40, 40, 10, 2), heat, {.density = 1, .E = 1e8, .nu = 0.25});
    input.loads = {pin({0, 1}, true, true), pin({10, 1}, false, true)};
    Run run(std::move(input), {.bulk = BulkScheme::implicit_theta, .theta = 1});
    struct Row {
        double Fo, middle, mean;
    };
    for (const Row& row : {Row{0.05, -0.174075, 0.824454}, Row{0.2, -0.245993, 0.583262}}) {
        const double from = run.now.time;
        for (int i = 0; i < 80; ++i) REQUIRE(run.step((row.Fo - from) / 80).rejection == Rejection::none);
        double near_face = 0, near_middle = 0, T_face = 0, n_face = 0, n_middle = 0;
        for (Index t = 0; t < run.model.mesh.n_triangles(); ++t) {
            const Vec2 x = run.model.mesh.centroid(t);
            if (std::abs(x.x() - 5) > 0.13) continue;
            double T = 0;
            for (Index k = 0; k < 3; ++k) T += run.now.temperature->of_corner[3 * t + k] / 3;
            const double s = stress(run.model, run.now, t)[0] / 1e3;
            if (x.y() > 1.95) near_face += s, T_face += T, ++n_face;
            if (std::abs(x.y() - 1) < 0.05) near_middle += s, ++n_middle;
        }
        // theta = T + 1; compared where the triangles are, with their own temperatures: sigma + T is uniform
        const std::string Fo = ", Fo = " + digits(row.Fo);
        verify("stress in the middle" + Fo, near_middle / n_middle, row.middle, {0.01});
        verify("mean temperature from the stress near the face" + Fo, near_face / n_face + T_face / n_face + 1,
               row.mean, {3e-3});
    }
    verify_small("largest error of the energy balance over the largest energy",
                 run.ledger.largest_residual() / run.ledger.largest_energy(), {1e-11});
}

}  // namespace conduction_test
