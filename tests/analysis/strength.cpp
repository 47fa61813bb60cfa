// Numbers of a stress-strain curve: an elastic strip has its moduli; a curve made by hand its peak and the stresses of
// its cracks.
#include "analysis/strength.hpp"
#include "analysis/specimen.hpp"
#include "figures/curve_figures.hpp"

#include "base/error.hpp"
#include "model/make_model.hpp"
#include "support/bodies.hpp"
#include "support/obstacles.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace strength_test {

using namespace knap;
using namespace knap::tests;

namespace {

constexpr double E = 30e9, nu = 0.3, length = 0.1, height = 0.04;

ModelInput strip(PlaneModel plane, Index order) {
    ModelInput input;
    input.mesh = bar_mesh(6, 3, length, height);
    input.mesh.order = order;
    input.plane = plane;
    input.thickness = 0.5;
    input.materials = {{.density = 2600, .E = E, .nu = nu}};
    input.laws = {CohesiveLaw::unbreakable()};
    input.law_of_pair = {{0}};
    return input;
}

const TimeFunction slow{{0, 1}, {0, 1}};

/// Driven slowly by large implicit steps, watched every fifth of them.
Strength strength_after(Run& run, const SpecimenOptions& options) {
    const Reactions reactions(run.model);
    Specimen specimen(run.model, reactions, options);
    specimen.begin(run.now);
    History curve{.columns = names_of<SpecimenMoment>(stress_strain_columns(options)), .rows = {specimen.line(0, 0)}};
    for (int i = 1; i <= 100; ++i) {
        run.step(0.01);
        specimen.after_step(run.now);
        if (i % 5 == 0) curve.rows.push_back(specimen.line(0, 0));
    }
    return strength_of(curve, options.modulus_between);
}

const SchemeOptions damped{.bulk = BulkScheme::implicit_theta, .theta = 1};

}  // namespace

TEST_CASE("strength: an elastic strip that is pulled has its modulus and its Poisson ratio") {
    for (const PlaneModel plane : {PlaneModel::strain, PlaneModel::stress})
        for (const Index order : {1, 2}) {
            ModelInput input = strip(plane, order);
            input.loads = {load(Load::Kind::displacement, "left", -1e-5, std::nullopt, slow),
                           load(Load::Kind::displacement, "right", 3e-5, std::nullopt, slow)};
            Run run(input, damped);
            const Strength s = strength_after(
                run, {.test = SpecimenOptions::Test::tension,
                      .axis = 0,
                      .driver = {.kind = GaugeEnd::Kind::load, .number = 1},
                      .axial = GaugeEnds{GaugeEnd{.boundary = "right"}, GaugeEnd{.boundary = "left"}},
                      .lateral = GaugeEnds{GaugeEnd{.boundary = "bottom"}, GaugeEnd{.boundary = "top"}}});
            // uniform strain is exact on any mesh; what is left is inertia, (transit time over the time of loading)^2
            const MaterialConstants found = material_constants(s, plane);
            CHECK(found.E == relative(E, 1e-6));
            CHECK(found.nu == relative(nu, 1e-6));
            CHECK(s.tangent_modulus == relative(plane == PlaneModel::strain ? E / (1 - nu * nu) : E, 1e-6));
            CHECK(s.peak_strain == relative(4e-5 / length, 0.03));  // the last line is the mean of its steps
            CHECK(std::isnan(s.crack_initiation));
        }
}

TEST_CASE("strength: an elastic strip pushed by a platen from either side and gauged between two points") {
    for (const bool from_top : {true, false}) {
        ModelInput input = strip(PlaneModel::stress, 1);
        input.loads = {load(Load::Kind::displacement, from_top ? "bottom" : "top", std::nullopt, 0.0)};
        input.obstacles = {platen({0.05, from_top ? height : 0}, {0, from_top ? -1. : 1.})};
        input.obstacles[0].drive[1] = driven(from_top ? -1e-5 : 1e-5);
        Run run(input);  // obstacles move with the explicit bulk: means over many steps
        const Reactions reactions(run.model);
        Specimen specimen(run.model, reactions,
                          {.driver = {.kind = GaugeEnd::Kind::obstacle, .number = 0},
                           .lateral = GaugeEnds{GaugeEnd{.kind = GaugeEnd::Kind::place, .at = {0.02, 0.02}},
                                                GaugeEnd{.kind = GaugeEnd::Kind::place, .at = {0.08, 0.02}}}});
        specimen.begin(run.now);
        const double h = 0.8 * run.stepper.stable_step(), end = 3e-3;
        std::vector<std::vector<double>> lines;
        while (run.now.time < end) {
            for (int i = 0; i < 200; ++i) run.step(h), specimen.after_step(run.now);
            lines.push_back(specimen.line(0, 0));
        }
        const std::vector<double>&first = lines[lines.size() / 4], &last = lines.back();
        CHECK(last.size() == 7);
        const double axial = last[2] - first[2];
        CHECK(axial == relative(1e-5 * (last[0] - first[0]) / height, 1e-9));
        CHECK((last[1] - first[1]) / axial == relative(E, 0.02));  // it rings
        CHECK((last[3] - first[3]) / axial == relative(-nu, 0.03));
        CHECK(last[4] == relative(last[2] + last[3], 1e-12));
    }
}

TEST_CASE("strength: stress of a disc and of a beam") {
    const double P = 1000;
    ModelInput input = strip(PlaneModel::stress, 1);
    input.loads = {load(Load::Kind::displacement, "bottom", 0.0, 0.0),
                   load(Load::Kind::displacement, "top", std::nullopt, -1e-6)};
    Run run(input);
    const Reactions reactions(run.model);
    run.now.reaction.assign(run.now.reaction.size(), Vec2::Zero());
    for (std::size_t i = 0; i < run.model.prescribed.size(); ++i)
        if (run.model.prescribed[i].history[1] == 1) run.now.reaction[i] = {0, -P / 7};  // seven corners at the top
    const auto stress = [&](SpecimenOptions options) {
        options.driver = {.kind = GaugeEnd::Kind::load, .number = 1};
        Specimen specimen(run.model, reactions, options);
        specimen.begin(run.now);
        return specimen.line(0, 0)[1];
    };
    const double force = -reactions.at(run.now)[1].force.y();
    REQUIRE(force > 0);
    CHECK(stress({.test = SpecimenOptions::Test::compression}) == relative(force / (length * 0.5), 1e-12));
    CHECK(stress({.test = SpecimenOptions::Test::tension}) == relative(-force / (length * 0.5), 1e-12));
    CHECK(stress({.test = SpecimenOptions::Test::brazilian, .height = 0.05}) ==
          relative(2 * force / (3.14159265358979 * 0.05 * 0.5), 1e-12));
    CHECK(stress({.test = SpecimenOptions::Test::bending, .height = 0.03, .span = 0.09}) ==
          relative(3 * force * 0.09 / (2 * 0.03 * 0.03 * 0.5), 1e-12));
}

TEST_CASE("strength: the curve of a specimen does not depend on the lines that are written") {
    ModelInput input = strip(PlaneModel::stress, 1);
    input.loads = {load(Load::Kind::displacement, "left", 0, std::nullopt),
                   load(Load::Kind::displacement, "right", 3e-5, std::nullopt, slow)};
    History curves[2];
    for (const int every : {3, 7}) {
        Run run(input, damped);
        const Reactions reactions(run.model);
        Specimen specimen(run.model, reactions,
                          {.test = SpecimenOptions::Test::tension,
                           .axis = 0,
                           .driver = {.kind = GaugeEnd::Kind::load, .number = 1},
                           .window = 0.05});
        specimen.begin(run.now);
        for (int i = 1; i <= 52; ++i) {
            run.step(0.01);
            specimen.after_step(run.now);
            if (i % every == 0) specimen.line(0, 0);
            specimen.end_window(run.now, i, 0);
        }
        curves[every == 7] = specimen.curve(52, 0);
    }
    CHECK(curves[0].rows == curves[1].rows);
    REQUIRE(curves[0].rows.size() == 12);  // the start, ten windows, the rest
    CHECK(curves[0].rows[10][0] == relative(0.475, 1e-12));
    CHECK(curves[0].column("tensile_breaks")[10] == 50);
    CHECK(curves[0].rows[11][0] == relative(0.51, 1e-12));
}

TEST_CASE("strength: a gauge without length and a driver without prescribed motion are errors") {
    ModelInput input = strip(PlaneModel::stress, 1);
    input.loads = {load(Load::Kind::displacement, "top", 0.0, 0.0), load(Load::Kind::displacement, "top", 0.0, -1e-6)};
    const Model model = make_model(input);
    const Reactions reactions(model);
    CHECK_THROWS_AS(Specimen(model, reactions, {.driver = {.kind = GaugeEnd::Kind::load, .number = 0}}), UserError);
    const SpecimenOptions flat{.driver = {.kind = GaugeEnd::Kind::load, .number = 1},
                               .lateral = GaugeEnds{GaugeEnd{.boundary = "top"}, GaugeEnd{.boundary = "bottom"}}};
    CHECK_THROWS_AS(Specimen(model, reactions, flat), UserError);
}

TEST_CASE("strength: peak and stresses of cracks of a curve made by hand") {
    // elastic with E = 20 GPa and lateral/axial -0.25; cracks open sideways from 40 MPa on, the volume turns at 80, the
    // peak is 100 MPa
    History curve{
        {"time", "stress", "axial_strain", "lateral_strain", "volumetric_strain", "tensile_breaks", "shear_breaks"},
        {}};
    const double compliance = 1 / 20e9;
    for (int i = 0; i <= 120; ++i) {
        const double stress = (i <= 100 ? i : 200 - i) * 1e6, way = i * 1e6, axial = way * compliance,
                     open = way > 40e6 ? way - 40e6 : 0;
        // d/d way of 0.75 way - open^2/a vanishes at 80 MPa for a = 2 x 40/0.75
        const double lateral = -0.25 * axial - open * open * 0.75 / 80e6 * compliance;
        const double n = way > 40e6 ? (way - 40e6) / 60e6 * 1000 : 0;  // 1000 breaks at the peak
        curve.rows.push_back(
            {1e-6 * i, stress, axial, lateral, axial + lateral, std::floor(0.75 * n), std::floor(0.25 * n)});
    }
    const Strength s = strength_of(curve, {0.1, 0.35});
    CHECK(s.peak_stress == 100e6);
    CHECK(s.strength == 100e6);
    CHECK(s.peak_strain == relative(100e6 / 20e9, 1e-12));
    CHECK(s.tangent_modulus == relative(20e9, 1e-9));
    CHECK(s.strain_ratio == relative(0.25, 1e-9));
    CHECK(s.crack_initiation == 41e6);  // 16 of 1000 breaks; at 40 MPa none
    CHECK(s.crack_damage == 80e6);
    // 1 % of the elastic contraction at 40 MPa, 0.75 x 40: open^2 0.75/80 = 0.3
    CHECK(s.dilatancy == 46e6);
    // a wave that comes back after the fracture makes a higher peak, and no other modulus
    History late{{"time", "stress", "axial_strain", "tensile_breaks", "shear_breaks"}, {}};
    for (int i = 0; i <= 40; ++i)
        late.rows.push_back({1. * i,
                             i <= 20   ? 1. * i
                             : i <= 30 ? 3. * (30 - i) - 10
                                       : 3. * (i - 30) - 8,
                             2. * i, 0, 0});
    CHECK(strength_of(late, {0.4, 0.6}).peak_stress == 22);
    CHECK(std::isnan(strength_of(late, {0.4, 0.6}).strength));  // nothing broke
    CHECK(strength_of(late, {0.4, 0.6}).tangent_modulus == relative(0.5, 1e-12));
    // the axis of a figure is that of the axial strain, whatever flies apart
    curve.rows.push_back({1, 0, 0.01, -0.5, -0.49, 1000, 0});
    const Chart chart = stress_strain_chart(curve);
    REQUIRE(chart.curves.size() == 4);
    CHECK(chart.curves[0].x.back() == relative(1, 1e-12));
    const Box axes = axis_ranges(chart);
    CHECK(axes.low.x() == -chart.curves[0].x.back());
    CHECK(axes.high.x() == chart.curves[0].x.back());
    CHECK(chart.curves[1].x[50] == relative(100 * curve.rows[50][3], 1e-12));
    REQUIRE(chart.levels.size() == 3);  // at 41, 46 and 80 MPa
    CHECK(chart.levels[0].label == "crack initiation");
    for (std::vector<double>& row : curve.rows) row[4] = row[2];  // no dilatancy, no damage
    CHECK(stress_strain_chart(curve).levels.size() == 1);
    // a curve of tension has no volume, and a peak at its end is a peak
    History rising{{"time", "stress", "axial_strain", "tensile_breaks", "shear_breaks"},
                   {{0, 0, 0, 0, 0}, {1, 1, 2, 0, 0}, {2, 2, 4, 0, 0}, {3, 3, 6, 0, 1}}};
    const Strength end = strength_of(rising, {0.4, 0.6});
    CHECK(end.peak_stress == 3);
    CHECK(std::isnan(end.strength));                        // it still rises
    CHECK(stress_strain_chart(rising).curves.size() == 1);  // no peak is marked
    CHECK(end.tangent_modulus == relative(0.5, 1e-12));
    CHECK(end.crack_initiation == 3);
    CHECK(std::isnan(end.crack_damage));
    CHECK(std::isnan(strength_of(History{rising.columns, {}}, {0.4, 0.6}).peak_stress));
}

TEST_CASE("the largest stress of a specimen is its strength once the stress has fallen while interfaces broke") {
    const auto strength = [](std::initializer_list<std::pair<double, double>> stress_and_breaks) {
        History curve{{"time", "stress", "axial_strain", "tensile_breaks", "shear_breaks"}, {}};
        for (const auto& [stress, n] : stress_and_breaks) {
            const double i = static_cast<double>(curve.rows.size());
            curve.rows.push_back({i, stress, i, n, 0});
        }
        return strength_of(curve, {0.4, 0.6}).strength;
    };
    CHECK(strength({{0, 0}, {5, 0}, {10, 0}, {2, 4}}) == 10);
    CHECK(strength({{0, 0}, {5, 0}, {10, 4}, {2, 4}}) == 10);                // all in the line of the peak
    CHECK(std::isnan(strength({{0, 0}, {5, 0}, {10, 2}, {9.6, 3}})));        // it has not fallen by 5 %
    CHECK(std::isnan(strength({{0, 0}, {5, 0}, {10, 0}, {2, 0}})));          // a wave, or an unloading
    CHECK(std::isnan(strength({{0, 0}, {5, 1}, {9, 1}, {10, 1}, {2, 1}})));  // unloaded after some damage
}

TEST_CASE("the strength of a specimen by the law is that of interfaces in all directions") {
    using Test = SpecimenOptions::Test;
    const CohesiveLaw law{.sigma_c = 5e6, .G_c = 4, .gamma = 1, .friction = 0.75};
    CHECK(strength_by_law(Test::tension, law) == 5e6);
    CHECK(strength_by_law(Test::brazilian, law) == 5e6);
    // Coulomb: 2 c cos(phi)/(1 - sin(phi)) with c = 1.75 sigma_c, sin(phi) = 0.6
    CHECK(strength_by_law(Test::compression, law) == relative(2 * 1.75 * 5e6 * 0.8 / 0.4, 1e-14));
    CHECK(std::isnan(strength_by_law(Test::bending, law)));
}

}  // namespace strength_test
