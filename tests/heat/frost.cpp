// Strength, friction and pressure in cracks that follow the temperature (H20, H21, H22).
#include "heat_bodies.hpp"
#include "mesh/triangulate.hpp"
#include "model/make_model.hpp"
#include "output/frame.hpp"
#include "stepper/common/crack_forces.hpp"
#include "stepper/explicit/bond_criteria.hpp"
#include "support/paths.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace frost_test {

using namespace knap;
using namespace knap::tests;

namespace {

constexpr double sigma_c = 2, G_c = 0.01, delta_c = 2 * G_c / sigma_c;

std::shared_ptr<const StrengthOfTemperature> tables(TemperatureTable strength, TemperatureTable friction = {}) {
    return std::make_shared<StrengthOfTemperature>(StrengthOfTemperature{std::move(strength), std::move(friction)});
}

/// phi = 1 below -10, 0.2 above 0.
const TemperatureTable falling{.temperature = {-10, 0}, .value = {1, 0.2}};

/// Two point masses of 1 kg on a support, each with a point of 1 m2, at a temperature that is the same everywhere.
ModelInput warm_points(const CohesiveLaw& law, bool glued, const std::string& temperature) {
    ModelInput input = point_masses(law, glued);
    Heat heat = field(temperature, {0});
    heat.every = 1;
    input.heat = std::make_shared<Heat>(heat);
    return input;
}

/// A law, and the sine of the angle at which it is loaded: the norm with gamma = 1 has one strength in all directions.
struct Shaped {
    const char* name;
    SofteningOptions options;
    Coupling coupling = Coupling::sum;
    double along = 0;
};
const Shaped shapes[] = {{"linear", {}},
                         {"Petersson", {.shape = SofteningOptions::Shape::petersson}},
                         {"exponential", {.shape = SofteningOptions::Shape::exponential}},
                         {"linear, norm", {}, Coupling::norm, 0.6}};

}  // namespace

TEST_CASE("H20 a joint that is warmed under load breaks when phi(T) sigma_c has fallen to it") {
    describe(
        "Two points carry 1.2 Pa in tension (norm: at an angle), sigma_c = 2 Pa at -10 C; T rises by 10 K in 1 s and "
        "phi falls linearly "
        "from 1 to 0.2, so that "
        "phi sigma_c = 1.2 Pa at t = 0.5 s. First loss of cohesion, within a step; and the energy that the break has "
        "dissipated.");
    for (const Shaped& shape : shapes)
        for (const SchemeOptions& scheme : all_paths()) {
            on_path(scheme);
            CohesiveLaw law{.sigma_c = sigma_c, .G_c = G_c, .gamma = 1, .coupling = shape.coupling};
            law.softening = make_softening(shape.options);
            law.of_temperature = tables(falling);
            ModelInput input = warm_points(law, true, "-10 + 10*t");
            input.loads = {
                load(Load::Kind::acceleration, "", 1.2 * shape.along, 1.2 * std::sqrt(1 - shape.along * shape.along))};
            SchemeOptions options = scheme;
            options.respect_assumption_1 = false;
            Run run(input, options);
            const double h = 1e-4;
            double breaks = 0, beta = 1;
            while (beta > 0) {
                run.step(h);
                REQUIRE(run.last.rejection == Rejection::none);
                beta = cohesion(run.model, run.now, 0);
                if (breaks == 0 && beta < 1) breaks = run.now.time;
                REQUIRE(run.now.time < 1);
            }
            verify_near(std::string("loses cohesion at, ") + shape.name, breaks, 0.5, {3 * h, 2.1 * h});
            // consumed at the strengths of the times at which beta fell: phi from 0.6 down to that of the break
            const EnergyRow& row = run.ledger.row();
            const double phi_end = falling(-10 + 10 * run.now.time);
            CHECK(row.dissipated < 2 * 0.6 * G_c);
            CHECK(row.dissipated > 2 * phi_end * G_c);
            CHECK(std::abs(row.law_lag) < 0.02 * row.dissipated);
            CHECK(run.ledger.largest_residual() < 1e-12 * run.ledger.largest_energy());
            const double after_break = row.dissipated;
            for (int i = 0; i < 100; ++i) run.step(h);
            CHECK(row.dissipated == relative(after_break, 1e-12));  // thaw takes nothing back
        }
}

// An opening that is held: beta stays, and phi alone changes the force and what closing would give back.
TEST_CASE("H20 the energy of an open joint that thaws changes by dphi beta sigma_c s") {
    describe(
        "Two points are pulled open by 0.3 delta_c and held while T rises from -10 C to -4 C and falls back: beta "
        "stays, the traction is "
        "phi beta sigma_c, and the ledger's law_change is dphi beta sigma_c s (a half of it with secant unloading), "
        "zero after the cycle.");
    for (const Unloading unloading : {Unloading::constant, Unloading::secant})
        for (const Shaped& shape : shapes)
            for (const SchemeOptions& scheme : both_paths()) {
                on_path(scheme);
                CohesiveLaw law{.sigma_c = sigma_c, .G_c = G_c, .gamma = 1, .coupling = shape.coupling};
                law.softening = make_softening(shape.options);
                law.unloading = unloading;
                law.of_temperature = tables(falling);
                ModelInput input = warm_points(law, true, "-10 + max(0, min(6*(t - 0.2), 6*(2.2 - t)))");
                input.loads = {
                    load(Load::Kind::displacement, "base", 0.0, 0.3 * delta_c, {.time = {0, 0.1}, .value = {0, 1}})};
                SchemeOptions options = scheme;
                options.respect_assumption_1 = false;
                Run run(input, options);
                const double h = 1. / 512;
                const auto go = [&](double end) {
                    while (run.now.time < end - 0.5 * h) REQUIRE(run.step(h).rejection == Rejection::none);
                };
                go(0.2);
                const double beta = cohesion(run.model, run.now, 0), dissipated = run.ledger.row().dissipated;
                CHECK(beta == relative(law.next_cohesion(1, 0.3 * delta_c, 0), 1e-12));
                go(1.2);  // the last step before has the temperature of its begin
                run.step(h), run.step(h);
                const double T = run.now.temperature_before->of_corner[0], dphi = falling(T) - 1,
                             part = unloading == Unloading::secant ? 0.5 : 1;
                CHECK(dphi < -0.47);
                const std::string of = std::string(", ") + shape.name + (part < 1 ? ", secant" : "");
                verify("law_change over dphi beta sigma_c s" + of,
                       run.ledger.row().law_change / (2 * part * dphi * beta * sigma_c * 0.3 * delta_c), 1, {1e-10});
                verify("traction over phi beta sigma_c" + of,
                       run.now.points[0].traction.x() / (-(1 + dphi) * beta * sigma_c), 1, {1e-10});
                CHECK(cohesion(run.model, run.now, 0) == relative(beta, 1e-12));
                CHECK(run.ledger.row().dissipated == relative(dissipated, 1e-12));
                CHECK(law_of(run.model, run.now, run.model.fan_points[0]).sigma_c < 0.53 * sigma_c);
                go(2.5);
                CHECK(std::abs(run.ledger.row().law_change) < 1e-14);
                CHECK(run.now.points[0].traction.x() ==
                      relative(-beta * sigma_c, 1e-10));  // no healing, but it freezes again
                CHECK(run.ledger.largest_residual() < 1e-13 * run.ledger.largest_energy());
            }
}

TEST_CASE("H21 a mass slides when mu(T) has fallen to the slope") {
    describe(
        "Point masses on a slope of 30 degrees (g = 9.81) while T rises by 10 K in 1 s and mu falls linearly from 0.8 "
        "to 0.3: the slide "
        "begins when mu = tan 30, and the speed at t = 1 s is the integral of g (sin - mu(T(t)) cos).");
    const double g = 9.81, angle = M_PI / 6, h = 1e-4;
    for (const SchemeOptions& scheme : both_paths()) {
        on_path(scheme);
        CohesiveLaw law{.sigma_c = 0, .friction = 0.8};
        law.of_temperature = tables({}, {.temperature = {-10, 0}, .value = {0.8, 0.3}});
        ModelInput input = warm_points(law, false, "-10 + 10*t");
        input.loads = {load(Load::Kind::acceleration, "", g * std::sin(angle), -g * std::cos(angle))};
        Run run(input, scheme);
        double starts = 0;
        while (run.now.time < 1 - 0.5 * h) {
            run.step(h);
            REQUIRE(run.last.rejection == Rejection::none);
            if (starts == 0 && run.v(0, 0).x() > 1e-12) starts = run.now.time;
        }
        const double at = (0.8 - std::tan(angle)) / 0.5;
        verify_near("slides at", starts, at, {3 * h, 2 * h});
        const double speed = 0.5 * g * std::cos(angle) * 0.5 * (1 - at) * (1 - at);  // mu falls by 0.5 a second
        verify("speed at t = 1 s", run.v(0, 0).x(), speed, {1e-3});
        CHECK(run.ledger.largest_residual() < 1e-12 * run.ledger.largest_energy());
        CHECK(run.ledger.worst().worst_friction_work <= 1e-14 * run.ledger.largest_energy());
    }
}

// p(T) against p(t) with the same values: the same motion.
TEST_CASE("H22 the pressure of ice is that of the temperature at the crack") {
    describe(
        "A joint in a block of 1 m x 1 m holds ice: p = 1.12 MPa/K below 0 C, at most 5 MPa (Clapeyron with a cap). "
        "Forces at a temperature that "
        "varies along the joint; and the run with T(t) against one with the same p(t).");
    const TemperatureTable clapeyron{.temperature = {-5. / 1.12, 0}, .value = {5e6, 0}};
    Shape shape;
    shape.outer = {.points = {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, .boundary = {0, 1, 2, 3}};
    shape.boundary_names = {"bottom", "right", "top", "left"};
    shape.cracks = {{.points = {{0, 0.5}, {0.5, 0.5}}, .joint = 0}};
    const auto block = [&](const std::string& temperature) {
        Heat heat = field(temperature, {0});
        heat.every = 1;
        ModelInput input = heated(triangulate(shape, {.size = 0.1, .seed = 2}), heat,
                                  {.density = 2500, .E = 30e9, .nu = 0.2}, {.sigma_c = 1e7, .G_c = 100, .gamma = 1});
        input.laws.push_back({.sigma_c = 1e6, .G_c = 10, .gamma = 1});
        input.law_of_joint = {1};
        input.crack_pressures = {{.pressure = 5e6, .joint_law = 1}};
        return input;
    };
    // sum over the trapezoidal points of p(T(x)) S with T = -8 x: the cap holds from x = 0.558
    ModelInput still = block("-8*x");
    still.crack_pressures[0].over_temperature = clapeyron;
    const Model model = make_model(still);
    CrackForces forces(model);
    double sum = 0, expected = 0;
    for (const CornerLoad& at : forces.find(initial_state(model))) sum += 0.5 * at.force.norm();
    for (const FanPoint& at : model.fan_points) {
        const Interface& interface = model.interfaces[model.interface_of(at.point)];
        const auto& V = model.mesh.vertices;
        const auto on_joint = [&](Index v) { return std::abs(V[v].y() - 0.5) < 1e-9 && V[v].x() < 0.5 + 1e-9; };
        if (on_joint(interface.vertex[0]) && on_joint(interface.vertex[1]))
            expected += at.area * std::min(5e6, 1.12e6 * 8 * model.mesh.corner(at.corner()).x());
    }
    CHECK(expected > 1e5);
    const std::vector<double> pressures = CrackForces(model).pressures(initial_state(model));
    double pressed = 0;
    for (const FanPoint& at : model.fan_points) pressed += at.area * pressures[at.point];
    CHECK(pressed == relative(expected, 1e-12));
    const Frame frame = make_frame(model, initial_state(model));
    REQUIRE(frame.fluid.size() == frame.end_position.size());
    for (std::size_t i = 0; i < frame.fluid.size(); ++i)
        if (const Vec2& x = frame.end_position[i]; std::abs(x.y() - 0.5) > 0.2 || x.x() > 0.6)
            CHECK(frame.fluid[i] == 0);
    CHECK(std::ranges::max(frame.fluid) == relative(1.12e6 * 8 * 0.5, 1e-12));
    verify("force on a face", sum, expected, {1e-12});

    ModelInput by_ice = block("-4 - 2000*t"), by_time = block("-4");
    by_ice.crack_pressures[0].over_temperature = clapeyron;
    by_time.crack_pressures[0].history = {.time = {0, (5 / 1.12 - 4) / 2000}, .value = {4 * 1.12 / 5, 1}};
    Run ice(std::move(by_ice)), time(std::move(by_time));
    const double h = 0.8 * ice.stepper.stable_step();
    for (int i = 0; i < 150; ++i) ice.step(h), time.step(h);
    CHECK(time.ledger.row().external_work > 1);
    verify("work of p(T) over that of p(t)", ice.ledger.row().external_work / time.ledger.row().external_work, 1,
           {1e-10});
    CHECK(ice.ledger.row().dissipated == relative(time.ledger.row().dissipated, 1e-9));
    CHECK(ice.ledger.row().dissipated > 0);
    CHECK(ice.ledger.largest_residual() < 1e-12 * ice.ledger.largest_energy());
}

TEST_CASE("the stress criterion holds for the weakest law of all temperatures") {
    const Mesh mesh = bar_mesh(6, 4, 3, 2);
    const auto thresholds = [&](double strength, double friction, std::shared_ptr<const StrengthOfTemperature> of_T) {
        CohesiveLaw law{.sigma_c = strength, .G_c = 1, .gamma = 0.4, .friction = friction};
        law.of_temperature = std::move(of_T);
        return stress_thresholds(make_model(heated(mesh, field("0", {0}), {.density = 1, .E = 1, .nu = 0}, law)));
    };
    const auto follows = thresholds(10, 0.5, tables(falling, {.temperature = {-10, -5, 0}, .value = {0.9, 0.1, 7}})),
               low = thresholds(2, 0.1, nullptr), high = thresholds(2, 7, nullptr);
    for (std::size_t f = 0; f < follows.size(); ++f)
        if (std::isfinite(low[f])) CHECK(follows[f] == relative(std::min(low[f], high[f]), 1e-14));
}

TEST_CASE("the energy balance closes to rounding while a body that thaws tears") {
    constexpr double a = 1e-5;
    for (const SchemeOptions& scheme : all_paths())
        for (const Index order : {1, 2}) {
            if (scheme.bulk == BulkScheme::explicit_lumped && scheme.cohesion == CohesionScheme::implicit_beta)
                continue;
            for (const auto& [unloading, coupling] : {std::pair{Unloading::constant, Coupling::sum},
                                                      {Unloading::secant, Coupling::sum},
                                                      {Unloading::constant, Coupling::norm},
                                                      {Unloading::secant, Coupling::norm}}) {
                const bool implicit = scheme.bulk == BulkScheme::implicit_theta;
                if (implicit && order == 2) continue;  // slow, and the same code
                on_path(scheme);
                SchemeOptions options = scheme;
                options.respect_assumption_1 = false;
                CohesiveLaw law{.sigma_c = 8e-4,
                                .G_c = 1.2e-6,
                                .gamma = 1,
                                .friction = 0.3,
                                .coupling = coupling,
                                .unloading = unloading};
                law.of_temperature = tables({.temperature = {-100, 0, 100}, .value = {1, 0.6, 0.3}},
                                            {.temperature = {-100, 100}, .value = {0.7, 0.2}});
                Heat heat = field("120*sin(3*t + 2*x)*cos(y - 5*t) + 40*x*y", {a});
                heat.every = 3;
                Mesh mesh = bar_mesh(6, 3, 2, 1);
                mesh.order = order;
                ModelInput input =
                    heated(std::move(mesh), heat, {.density = 1, .E = 1, .nu = 0.3}, law, PlaneModel::strain);
                input.loads = {load(Load::Kind::displacement, "left", 0.0, std::nullopt)};
                Run run(std::move(input), options);
                const double h = implicit ? 0.02 : 0.4 * run.stepper.stable_step();
                int taken = 0;
                for (int i = 0; i < (implicit ? 40 : 800); ++i)
                    taken += run.step_if_taken(h * (0.8 + 0.2 * std::sin(i)));
                const EnergyRow& row = run.ledger.row();
                CHECK(taken > 20);
                CHECK(run.ledger.largest_residual() < (implicit ? 2e-11 : 1e-13) * run.ledger.largest_energy());
                CHECK(std::abs(row.law_change) > 1e-3 * row.surface());
                CHECK(row.dissipated > 0);
                // what is in no other book: a small part, which would be as large as law_change without it
                if (unloading == Unloading::constant) CHECK(std::abs(row.law_lag) < 0.2 * std::abs(row.law_change));
                CHECK(run.ledger.worst().worst_friction_work <= 1e-13 * run.ledger.largest_energy());
            }
        }
}

}  // namespace frost_test
