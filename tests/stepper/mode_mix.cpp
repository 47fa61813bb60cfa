// A fracture energy of slip of its own (G_II), and friction that follows the slip, on points with all pairs of schemes.
#include "support/bodies.hpp"
#include "support/paths.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace mode_mix_test {

using namespace knap;
using namespace knap::tests;

namespace {

/// [J/m2] G(m) by the formulas of the guide.
double criterion(const CohesiveLaw& law, double m) {
    const double a = law.mix_exponent;
    if (law.mode_mix == ModeMix::benzeggagh_kenane) return law.G_c + (law.G_II - law.G_c) * std::pow(m, a);
    return std::pow(std::pow((1 - m) / law.G_c, a) + std::pow(m / law.G_II, a), -1 / a);
}

/// The direction (u_N, u_T) in which slip does the part m of the work.
Vec2 direction(const CohesiveLaw& law, double m) {
    if (law.coupling == Coupling::norm) return {std::sqrt(1 - m), std::sqrt(m) / law.gamma};
    return {1 - m, m / law.gamma};
}

}  // namespace

TEST_CASE("A1 a point that opens in one proportion costs the fracture energy of its mode mix") {
    describe(
        "G_c = .25, G_II = .75, gamma = 1.5. A point opens with the part m of slip in its work until it breaks: it "
        "costs "
        "G(m), by the power law with a = 1 and 2 and by Benzeggagh and Kenane with a = 2.3, to rounding in the books "
        "and to the size of a step in the work of its traction.");
    struct Mix {
        ModeMix kind;
        double exponent;
    };
    for (const SchemeOptions& path : all_paths())
        for (const Coupling coupling : {Coupling::sum, Coupling::norm})
            for (const Mix& mix :
                 {Mix{ModeMix::power, 1}, Mix{ModeMix::power, 2}, Mix{ModeMix::benzeggagh_kenane, 2.3}})
                for (const double m : {0.0, 0.2, 0.5, 0.8, 1.0}) {
                    if (coupling == Coupling::norm && name_of(path) == name_of(both_implicit)) continue;  // refused
                    CohesiveLaw law{.sigma_c = 0.5, .G_c = 0.25, .gamma = 1.5, .coupling = coupling};
                    law.G_II = 0.75, law.mode_mix = mix.kind, law.mix_exponent = mix.exponent;
                    on_path(path);
                    CAPTURE(m);
                    CAPTURE(mix.exponent);
                    const double G = criterion(law, m);
                    const Vec2 u = direction(law, m);
                    ModelInput input = point_masses(law, true);
                    // to 1.3 of the opening at which it breaks, s_d = delta_c
                    const double reach = 1.3 * law.delta_c() * G / law.G_c;
                    input.loads = {
                        load(Load::Kind::displacement, "base", reach * u.y(), reach * u.x(), {{0, 1}, {0, 1}})};
                    Run run(input, path);
                    constexpr int n = 2000;
                    for (int i = 0; i < n; ++i) {
                        run.step(1.0 / n);
                        REQUIRE(run.last.rejection == Rejection::none);
                    }
                    const EnergyRow& row = run.ledger.row();
                    REQUIRE(cohesion(run.model, run.now, 0) == 0);
                    CHECK(row.dissipated + row.mixed_dissipation == relative(2 * G, 1e-12));
                    CHECK(row.cohesive_work == relative(2 * G, 4.0 / n));
                    CHECK(run.ledger.largest_residual() < 1e-12 * run.ledger.largest_energy());
                }
}

TEST_CASE("A1 with the linear power law the parts of both modes add up to one on every way") {
    describe(
        "G_II = 3 G_c, power law with a = 1. A point first opens by a fifth of delta_c, then slides until it breaks: "
        "its "
        "works over G_c and G_II add up to 1.");
    for (const SchemeOptions& path : all_paths()) {
        on_path(path);
        CohesiveLaw law{.sigma_c = 0.5, .G_c = 0.25, .gamma = 1};
        law.G_II = 0.75;
        ModelInput input = point_masses(law, true);
        input.loads = {load(Load::Kind::displacement, "base", 0.0, 1.0, {{0, 1, 2}, {0, 0.2, 0.2}}),
                       load(Load::Kind::displacement, "base", 1.0, {}, {{0, 1, 2}, {0, 0, 3}})};
        input.loads[0].value[0] = {};
        Run run(input, path);
        constexpr int n = 4000;
        Vec2 work = Vec2::Zero(), before = Vec2::Zero();
        for (int i = 0; i < 2 * n; ++i) {
            run.step(1.0 / n);
            REQUIRE(run.last.rejection == Rejection::none);
            const Vec2 u = opening(run.model, run.now, 0);
            work -= run.now.points[0].traction.cwiseProduct(u - before);
            before = u;
        }
        REQUIRE(cohesion(run.model, run.now, 0) == 0);
        verify_near("G_I/G_c + G_II/G_II", work.x() / law.G_c + work.y() / law.G_II, 1, {8.0 / n});
        verify_near("work of the slip over G_II", work.y() / law.G_II, 0.8 * 0.8, {8.0 / n});
    }
}

TEST_CASE("a sheared and pulled block breaks with its own fracture energy of slip and its energies balance") {
    for (const SchemeOptions& path : both_paths()) {
        CohesiveLaw law{.sigma_c = 8e6, .G_c = 60, .gamma = 1, .friction = 0.3};
        law.G_II = 180;
        ModelInput input = body_with(bar_mesh(12, 6, 0.04, 0.02), {.density = 2450, .E = 32e9, .nu = 0.2}, law);
        input.thickness = 1e-3;
        input.loads = {load(Load::Kind::traction, "top", 4e6, 8e6, {{0, 5e-6}, {0, 1}}),
                       load(Load::Kind::traction, "bottom", -4e6, -8e6, {{0, 5e-6}, {0, 1}})};
        Run run(input, path);
        const double h = 0.6 * MoreauJean(run.model, both_explicit).stable_step();
        while (run.now.time < 25e-6) {
            run.step(h);
            REQUIRE(run.last.rejection == Rejection::none);
        }
        const EnergyRow& row = run.ledger.row();
        const double scale = run.ledger.largest_energy();
        CHECK(row.dissipated > 0);
        CHECK(row.mixed_dissipation > 0.03 * row.dissipated);
        CHECK(row.mixed_dissipation < 2 * row.dissipated);
        CHECK(run.ledger.largest_residual() <= 1e-11 * scale);
        CHECK(run.ledger.worst().residual <= 1e-10);
        CHECK(std::abs(row.law_lag) < 0.05 * (row.dissipated + row.mixed_dissipation));
        MESSAGE(name_of(path), ": law lag over dissipated ", row.law_lag / (row.dissipated + row.mixed_dissipation),
                ", mixed over dissipated ", row.mixed_dissipation / row.dissipated);
    }
}

TEST_CASE("A2 a mass that slides stops where friction that falls with the slip has taken its energy") {
    describe(
        "m = S = 1 under a pressure of 1 slides with v^2 = .5; friction falls from .6 to .2 over a slip of .5: it "
        "takes "
        ".2 up to there, and the rest up to a slip of .75.");
    for (const SchemeOptions& path : both_paths()) {
        on_path(path);
        CohesiveLaw law{.friction = 0.6};
        law.kinetic_friction = 0.2, law.slip_distance = 0.5;
        ModelInput input = point_masses(law, false);
        input.loads = {load(Load::Kind::acceleration, "", 0.0, -1.0)};
        Run run(input, path);
        for (Vec2& velocity : run.now.velocity) velocity = {std::sqrt(0.5), 0};
        const double h = 1e-3;
        while (run.now.time < 4) {
            run.step(h);
            REQUIRE(run.last.rejection == Rejection::none);
        }
        verify_near("slip", run.u(0, 0).x(), 0.75, {3 * h});
        verify_near("way", run.now.points[0].slid, 0.75, {3 * h});
        CHECK(std::abs(run.v(0, 0).x()) < 1e-3);
    }
}

}  // namespace mode_mix_test
