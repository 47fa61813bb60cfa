// Onset of cracks in a quenched plate by its strength (H25).
#include "heat/conduction.hpp"
#include "heat_bodies.hpp"
#include "support/paths.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace onset_test {

using namespace knap;
using namespace knap::tests;

namespace {

// Alumina; half the thickness of the plate, which cools from one face. Its motion is quasi-static: a ten-thousandth of the density, with
// ten thousand times the heat capacity, leaves the heat as it is.
constexpr double lighter = 1e4;
constexpr Elastic alumina{.density = 3980 / lighter, .E = 370e9, .nu = 0.3};
constexpr double expansion = 7.5e-6, kappa = 31 / (3980. * 880), half = 5e-3, width = 1e-3, sigma_c = 180e6;

/// A strip of the plate, two columns wide, with rows that are thin at the cooled face: 2 um.
Mesh strip() {
    constexpr int n_y = 50;
    Mesh mesh = bar_mesh(2, n_y, width, half);
    for (Vec2& x : mesh.vertices) x.y() = half * (1 - std::pow(1 - x.y() / half, 2));
    return mesh;
}

/// Cooled by DT from its face; its ends stay straight and free of force in the mean, as inside a long plate: they move by
/// the mean of the thermal strain over the thickness (known, from conduction alone).
ModelInput cooled(double DT, double transfer, const TimeFunction& mean = {}) {
    Heat heat = field("0", {expansion});
    heat.conduction = true;
    heat.materials[0].conductivity = 31, heat.materials[0].heat_capacity = 880 * lighter;
    using Kind = HeatExchange::Kind;
    heat.exchanges = {{.kind = Kind::convection, .on = {.boundary = "top"}, .value = -DT, .transfer = transfer}};
    ModelInput input = heated(strip(), heat, alumina, {.sigma_c = sigma_c, .G_c = 42.47, .gamma = 1});
    if (mean.time.empty()) return input;
    input.loads = {load(Load::Kind::displacement, "left", 0.0, {}), load(Load::Kind::displacement, "bottom", {}, 0.0),
                   load(Load::Kind::displacement, "right", DT * expansion * width, {}, mean)};
    return input;
}

/// Times that grow by a factor, and the mean temperature over DT at them.
TimeFunction mean_of(double transfer, double end, double growth) {
    const Model model = make_model(cooled(1, transfer));
    Conduction conduction(model);
    State now = initial_state(model);
    double capacity = 0;
    for (Index c = 0; c < model.mesh.n_corners(); ++c) capacity += conduction.capacity(c);
    TimeFunction mean{.time = {0}, .value = {0}};
    for (double t = 1e-8; t < end; t *= growth) {
        now.temperature = conduction.implicit_step(now, t);
        mean.time.push_back(t), mean.value.push_back(now.temperature->heat / capacity);
    }
    return mean;
}

/// [s] Of the first loss of cohesion; infinite without one.
double first_crack(double DT, double transfer, const TimeFunction& mean) {
    Run run(cooled(DT, transfer, mean), {.bulk = BulkScheme::implicit_theta,
                                         .cohesion = CohesionScheme::implicit_beta,
                                         .theta = 1,
                                         .respect_assumption_1 = false});
    for (std::size_t i = 1; i < mean.time.size(); ++i)
        for (double h = mean.time[i] - run.now.time; run.now.time < mean.time[i] * (1 - 1e-12);
             h = std::min(h, mean.time[i] - run.now.time)) {
            if (!run.step_if_taken(h)) h *= 0.5;
            REQUIRE(h > 1e-6 * mean.time[i]);
            if (run.ledger.row().surface() > 1e-9) return run.now.time;  // [J] 2e-5 of a point at the face
        }
    return std::numeric_limits<double>::infinity();
}

}  // namespace

TEST_CASE("H25 a plate that is quenched cracks from the drop of temperature of its strength on") {
    describe(
        "A plate of alumina (E = 370 GPa, nu = 0.3, a = 7.5e-6/K, kappa = 8.85e-6 m2/s, sigma_c = 180 MPa, 10 mm "
        "thick) cooled on both "
        "faces with the coefficient h: smallest drop of temperature at which it cracks, by bisection, sigma_c/(E a) "
        "over the largest "
        "(mean - theta) of the Fourier series; and the time of the first crack for a drop of 380 K. A strip of two "
        "columns, rows "
        "of 2 um at the face, implicit bulk with theta = 1 and steps of 5 % (for the first crack 2 %) of the time so "
        "far.");
    struct Row {
        double transfer, DT, time;
    };
    for (const Row row : {Row{2e4, 162, 9.5e-3}, {5e4, 116, 1.4e-3}, {1e5, 98, 0.35e-3}}) {
        const TimeFunction mean = mean_of(row.transfer, 0.25 * half * half / kappa, 1.05);
        double holds = 0.97 * row.DT, cracks = 1.03 * row.DT;
        REQUIRE(std::isinf(first_crack(holds, row.transfer, mean)));
        REQUIRE(std::isfinite(first_crack(cracks, row.transfer, mean)));
        for (int i = 0; i < 3; ++i) {
            const double DT = 0.5 * (holds + cracks);
            (std::isinf(first_crack(DT, row.transfer, mean)) ? holds : cracks) = DT;
        }
        const std::string of = ", h = " + digits(row.transfer);
        verify("drop of temperature" + of, 0.5 * (holds + cracks), row.DT, {0.015});
        // set afterwards: a one-dimensional computation with these rows and steps is up to 5.7 % late (backward Euler, the mean over the
        // row at the face), and up to two steps pass before a point has opened visibly
        verify("first crack at a drop of 380 K" + of,
               first_crack(380, row.transfer, mean_of(row.transfer, 12e-3, 1.02)), row.time, {0.1});
    }
}

}  // namespace onset_test
