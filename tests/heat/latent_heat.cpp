// Latent heat: the front of melting (H23), and its book.
#include "heat/conduction.hpp"
#include "heat_bodies.hpp"
#include "model/make_model.hpp"
#include "support/paths.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace latent_heat_test {

using namespace knap;
using namespace knap::tests;

namespace {

constexpr Elastic unit{.density = 1, .E = 1, .nu = 0.25};

Heat melting(const std::string& start, double latent_heat, std::array<double, 2> range) {
    Heat heat = field(start, {0});
    heat.materials[0].conductivity = heat.materials[0].heat_capacity = 1;
    heat.materials[0].latent_heat = latent_heat;
    heat.materials[0].freezing_range = range;
    heat.conduction = true;
    return heat;
}

double book(const Temperatures& T) { return std::abs(T.heat - T.heat_in) / (T.heat_scale + T.heat_moved); }

/// lambda of X = 2 lambda sqrt(kappa t), equal properties on both sides: a = T_face - T_melt, b = T_melt - T_start,
/// exp(-l^2)/erf(l) - (b/a) exp(-l^2)/erfc(l) = l sqrt(pi) L/(c a).
double neumann(double a, double b, double latent_over_c) {
    double low = 1e-6, high = 5;
    for (int i = 0; i < 100; ++i) {
        const double l = 0.5 * (low + high), e = std::exp(-l * l);
        (e / std::erf(l) - b / a * e / std::erfc(l) > l * std::sqrt(M_PI) * latent_over_c / a ? low : high) = l;
    }
    return low;
}

}  // namespace

TEST_CASE("H23 the front of melting goes as Neumann's") {
    describe(
        "A half space at -2 C whose face is at 5 C from t = 0, latent heat L/c = 20 K, taken up between -0.05 and 0.05 "
        "C; k = rho = c = 1. Place "
        "of T = 0 against 2 lambda sqrt(kappa t) (F. Neumann, two phases with equal properties), cells of 0.0075.");
    constexpr double a = 5, b = 2, L = 20;
    const double lambda = neumann(a, b, L);
    for (const bool implicit : {false, true}) {
        on_path(implicit ? "backward Euler" : "forward Euler");
        Heat heat = melting("-2", L, {-0.05, 0.05});
        heat.exchanges = {{.kind = HeatExchange::Kind::temperature, .on = {.boundary = "left"}, .value = a}};
        const Model model = make_model(heated(bar_mesh(200, 1, 1.5, 0.0075), heat, unit));
        Conduction conduction(model);
        State now = initial_state(model);
        double time = 0;
        for (const double end : {0.1, 0.2}) {
            const int n = implicit ? 100 : 1;
            const double from = time;
            for (int i = 1; i <= n; ++i) {
                time = from + (end - from) * i / n;
                now.temperature = implicit ? conduction.implicit_step(now, time) : conduction.explicit_step(now, time);
            }
            double front = 0;  // along the bottom
            for (Index t = 0; t < model.mesh.n_triangles(); ++t)
                for (Index k = 0; k < 3; ++k) {
                    const Index c = 3 * t + k, d = 3 * t + (k + 1) % 3;
                    const Vec2 p = model.mesh.corner(c), q = model.mesh.corner(d);
                    const double T_c = now.temperature->of_corner[c], T_d = now.temperature->of_corner[d];
                    if (p.y() == 0 && q.y() == 0 && T_c > 0 && T_d <= 0)
                        front = p.x() + (q.x() - p.x()) * T_c / (T_c - T_d);
                }
            verify("front at t = " + digits(end), front, 2 * lambda * std::sqrt(end), {0.01, 0.003});
        }
        CHECK(book(*now.temperature) < 1e-13);
        CHECK(now.temperature->overshoot <= 1e-13);
    }
}

TEST_CASE("melting takes up its latent heat once for every step size") {
    // 1 m2 gets 2.5 J/m3 s from -2: 2 K to 0, then L = 3 over [0, 1], then on
    const auto level = [](double T) { return T + 3 * std::clamp(T, 0., 1.); };
    for (const bool implicit : {false, true})
        for (const double factor : {1., 10.}) {
            Heat heat = melting("-2", 3, {0, 1});
            heat.exchanges = {{.kind = HeatExchange::Kind::source, .on = {}, .value = 2.5}};
            heat.time_factor = factor;
            const Model model = make_model(heated(bar_mesh(4, 2, 1, 1), heat, unit));
            Conduction conduction(model);
            State now = initial_state(model);
            for (const double t : {0.3, 0.8, 0.9, 1.7, 3.0}) {  // from far below to far above in one step, too
                now.temperature =
                    implicit ? conduction.implicit_step(now, t / factor) : conduction.explicit_step(now, t / factor);
                for (const double T : now.temperature->of_corner) CHECK(std::abs(level(T) - (-2 + 2.5 * t)) < 1e-12);
                CHECK(book(*now.temperature) < 1e-14);
            }
        }
}

TEST_CASE("two materials of which one freezes share the temperature of their nodes and keep the book of heat") {
    for (const bool implicit : {false, true})
        for (const Index order : {1, 2}) {
            Heat heat = melting("3*sin(7*x)*cos(5*y)", 30, {-1, 0});
            heat.materials.push_back(
                {.conductivity = 4, .heat_capacity = 2, .latent_heat = 7, .freezing_range = {-0.3, 0.4}});
            heat.materials.push_back({.conductivity = 2, .heat_capacity = 1});
            heat.exchanges = {
                {.kind = HeatExchange::Kind::convection, .on = {.boundary = "top"}, .value = -5, .transfer = 8},
                {.kind = HeatExchange::Kind::temperature, .on = {.boundary = "left"}, .value = 4}};
            Mesh mesh = bar_mesh(12, 6, 2, 1, [](int i) { return i % 3; });
            mesh.order = order;
            const Model model = make_model(heated(std::move(mesh), heat, unit));
            Conduction conduction(model);
            State now = initial_state(model);
            for (int i = 1; i <= 30; ++i)
                now.temperature =
                    implicit ? conduction.implicit_step(now, 0.02 * i) : conduction.explicit_step(now, 0.02 * i);
            CHECK(book(*now.temperature) < 1e-13);
            CHECK(now.temperature->heat_moved > 0.1 * now.temperature->heat_scale);
            CHECK(now.temperature->overshoot <= 1e-12);
        }
}

}  // namespace latent_heat_test
