// Conductivity and heat capacity over temperature (H24).
#include "heat/conduction.hpp"
#include "heat_bodies.hpp"
#include "model/make_model.hpp"
#include "support/paths.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace temperature_tables_test {

using namespace knap;
using namespace knap::tests;

namespace {

constexpr Elastic unit{.density = 1, .E = 1, .nu = 0.25};
using Kind = HeatExchange::Kind;

/// k(T)/k = (1 + 2 T)/3 and c(T)/c = 1 + 2 T between 0 and 1, with k = 3 and c = 1.
Heat following(const std::string& start) {
    Heat heat = field(start, {0});
    heat.conduction = true;
    heat.materials[0].conductivity = 3, heat.materials[0].heat_capacity = 1;
    heat.materials[0].conductivity_part = PropertyOverTemperature({{0, 1}, {1. / 3, 1}});
    heat.materials[0].capacity_part = PropertyOverTemperature({{0, 1}, {1, 3}});
    return heat;
}

HeatExchange held(const std::string& boundary, double T) {
    return {.kind = Kind::temperature, .on = {.boundary = boundary}, .value = T};
}

Mesh mesh_of_order(Mesh mesh, Index order) {
    mesh.order = order;
    return mesh;
}

struct Warmed {
    explicit Warmed(ModelInput input)
        : model(make_model(std::move(input))), conduction(model), now(initial_state(model)) {}
    void go(double to, bool implicit) {
        now.temperature = implicit ? conduction.implicit_step(now, to) : conduction.explicit_step(now, to);
    }
    double book() const {
        const Temperatures& T = *now.temperature;
        return std::abs(T.heat - T.heat_in) / (T.heat_scale + T.heat_moved);
    }
    /// Largest difference to T(x).
    template <class Function>
    double error(const Function& exact) const {
        double largest = 0;
        for (Index c = 0; c < model.mesh.n_corners(); ++c)
            largest = std::max(largest, std::abs(now.temperature->of_corner[c] - exact(model.mesh.corner(c).x())));
        return largest;
    }

    Model model;
    Conduction conduction;
    State now;
};

}  // namespace

TEST_CASE("H24 a wall whose k is linear in T has the temperatures of Kirchhoff's transform") {
    describe(
        "A wall between T = 0 and 1, k = 1 + 2 T: T + T^2 = 2 x (G. Kirchhoff 1894), largest error over the nodes of "
        "10 "
        "cells, which is rounding since the k of two nodes is the mean over their temperatures.");
    for (const Index order : {1, 2})
        for (const bool implicit : {false, true}) {
            on_path(implicit ? "backward Euler" : "forward Euler");
            Heat heat = following("0");
            heat.exchanges = {held("left", 0), held("right", 1)};
            Warmed wall(heated(mesh_of_order(bar_mesh(10, 1, 1, 0.1), order), heat, unit));
            for (int i = 1; i <= (implicit ? 90 : 64); ++i) wall.go(0.05 * i, implicit);
            verify_small("error of T, order " + std::to_string(order),
                         wall.error([](double x) { return 0.5 * (std::sqrt(1 + 8 * x) - 1); }), {1e-11});
            CHECK(wall.book() < 1e-10);  // the gate: far more heat goes through in thousands of steps than is stored
            CHECK(wall.now.temperature->overshoot <= 1e-13);
        }
}

TEST_CASE("H24 where k and c follow the temperature alike T + T^2 conducts as T of a linear material") {
    describe(
        "A half space at T = 0 whose face is at 1 from t = 0, k = c = 1 + 2 T, rho = 1: T + T^2 = 2 erfc(x/sqrt(4 t)); "
        "largest error of T at t = 0.1 with cells of 0.02.");
    for (const bool implicit : {false, true}) {
        on_path(implicit ? "backward Euler" : "forward Euler");
        Heat heat = following("0");
        heat.exchanges = {held("left", 1)};
        Warmed half(heated(bar_mesh(150, 1, 3, 0.02), heat, unit));
        const int n = implicit ? 400 : 1;
        for (int i = 1; i <= n; ++i) half.go(0.1 * i / n, implicit);
        const double error =
            half.error([](double x) { return 0.5 * (std::sqrt(1 + 8 * std::erfc(x / std::sqrt(0.4))) - 1); });
        verify_small("error of T", error, {3e-3});
        CHECK(half.book() < 1e-13);
        CHECK(half.now.temperature->overshoot <= 1e-13);
    }
}

TEST_CASE("H24 a plate with a source stores the integral of c") {
    describe("c = 1 + 2 T up to T = 1, then 3, and 2.5 W/m3: T + T^2 = 2.5 t, then T = (2.5 t + 1)/3, with any step.");
    for (const bool implicit : {false, true})
        for (const double latent : {0., 4.}) {  // in addition over [0.5, 0.75]
            on_path(implicit ? "backward Euler" : "forward Euler");
            Heat heat = following("0");
            heat.materials[0].latent_heat = latent, heat.materials[0].freezing_range = {0.5, 0.75};
            heat.exchanges = {{.kind = Kind::source, .on = {}, .value = 2.5}};
            Warmed plate(heated(bar_mesh(4, 2, 1, 1), heat, unit));
            for (const double t : {0.1, 0.5, 0.6, 2.5, 4.0}) {
                plate.go(t, implicit);
                double error = 0;
                for (const double T : plate.now.temperature->of_corner) {
                    const double sensible = T < 1 ? T + T * T : 3 * T - 1;
                    error =
                        std::max(error, std::abs(sensible + latent * std::clamp((T - 0.5) / 0.25, 0., 1.) - 2.5 * t));
                }
                if (latent == 0) verify_small("error of the stored heat, t = " + digits(t), error, {1e-12});
                else CHECK(error < 1e-12);
                CHECK(plate.book() < 1e-14);
            }
        }
}

TEST_CASE("materials with k and c over temperature share their nodes and keep the book of heat") {
    for (const bool implicit : {false, true})
        for (const Index order : {1, 2}) {
            Heat heat = following("2*sin(7*x)*cos(5*y)");
            heat.materials.push_back({.conductivity = 4,
                                      .heat_capacity = 2,
                                      .conductivity_part = PropertyOverTemperature({{-1, 0, 2}, {1, 0.2, 0.7}}),
                                      .capacity_part = PropertyOverTemperature({{-2, -0.2, 0.1}, {4, 1, 2}}),
                                      .latent_heat = 7,
                                      .freezing_range = {-0.3, 0.4}});
            heat.materials.push_back({.conductivity = 2, .heat_capacity = 1});
            heat.exchanges = {{.kind = Kind::convection, .on = {.boundary = "top"}, .value = -5, .transfer = 8},
                              held("left", 4)};
            Mesh mesh = bar_mesh(12, 6, 2, 1, [](int i) { return i % 3; });
            mesh.order = order;
            Warmed body(heated(std::move(mesh), heat, unit));
            for (int i = 1; i <= 30; ++i) body.go(0.02 * i, implicit);
            CHECK(body.book() < 1e-13);
            CHECK(body.now.temperature->heat_moved > 0.1 * body.now.temperature->heat_scale);
            CHECK(body.now.temperature->overshoot <= 1e-12);
        }
}

}  // namespace temperature_tables_test
