// Onset of cracks in a quenched plate by its strength (H25).
#include "heat/conduction.hpp"
#include "heat_bodies.hpp"
#include "model/make_model.hpp"
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
constexpr double expansion = 7.5e-6, kappa = 31 / (3980. * 880), half = 5e-3, width = 1.25e-5;

/// A strip of the plate, two columns wide, with rows that are thin at the cooled face: 0.125 um. It is narrow, since slender triangles
/// leave steps unsolved.
Mesh strip() {
    constexpr int n_y = 200;
    Mesh mesh = bar_mesh(2, n_y, width, half);
    for (Vec2& x : mesh.vertices) x.y() = half * (1 - std::pow(1 - x.y() / half, 2));
    return mesh;
}

/// Cooled by DT from its face; its ends stay straight and free of force in the mean, as inside a long plate: they move by
/// the mean of the thermal strain over the thickness (known, from conduction alone).
/// An infinite coefficient: the face has the temperature of the water at once.
ModelInput cooled(double DT, double transfer, double sigma_c = 1, const TimeFunction& mean = {}) {
    Heat heat = field("0", {expansion});
    heat.conduction = true;
    heat.materials[0].conductivity = 31, heat.materials[0].heat_capacity = 880 * lighter;
    using Kind = HeatExchange::Kind;
    const bool at_once = std::isinf(transfer);
    heat.exchanges = {{.kind = at_once ? Kind::temperature : Kind::convection,
                       .on = {.boundary = "top"},
                       .value = -DT,
                       .transfer = at_once ? 0 : transfer}};
    ModelInput input = heated(strip(), heat, alumina, {.sigma_c = sigma_c, .G_c = 42.47, .gamma = 1});
    if (mean.time.empty()) return input;
    input.loads = {load(Load::Kind::displacement, "left", 0.0, {}), load(Load::Kind::displacement, "bottom", {}, 0.0),
                   load(Load::Kind::displacement, "right", DT * expansion * width, {}, mean)};
    return input;
}

/// Times from `begin` on that grow faster at first and then by 0.5 %, and the mean temperature over DT at them.
TimeFunction mean_of(double transfer, double begin, double end) {
    const Model model = make_model(cooled(1, transfer));
    Conduction conduction(model);
    State now = initial_state(model);
    double capacity = 0;
    for (Index c = 0; c < model.mesh.n_corners(); ++c) capacity += conduction.capacity(c);
    TimeFunction mean{.time = {0}, .value = {0}};
    double growth = 0.5;
    for (double t = begin; t < end; t *= 1 + growth, growth = std::max(0.005, 0.9 * growth)) {
        now.temperature = conduction.implicit_step(now, t);
        mean.time.push_back(t), mean.value.push_back(now.temperature->heat / capacity);
    }
    return mean;
}

/// [s] Of the first loss of cohesion, in the middle of its step; infinite without one.
double first_crack(double DT, double transfer, double sigma_c, const TimeFunction& mean) {
    Run run(cooled(DT, transfer, sigma_c, mean), {.bulk = BulkScheme::implicit_theta,
                                                  .cohesion = CohesionScheme::implicit_beta,
                                                  .theta = 1,
                                                  .respect_assumption_1 = false});
    for (std::size_t i = 1; i < mean.time.size(); ++i)
        for (double h = mean.time[i] - run.now.time; run.now.time < mean.time[i] * (1 - 1e-12);
             h = std::min(h, mean.time[i] - run.now.time)) {
            const double before = run.now.time;
            if (!run.step_if_taken(h)) h *= 0.5;
            REQUIRE(h > 1e-6 * mean.time[i]);
            // [J] 2e-8 of a point at the face: a row that opens by 1e-8 delta_c. What opens one row against its neighbours
            // needs a stress beyond the strength; with 1e-12 J and rows of 0.5 um that made the first crack 0.5 % later
            if (run.ledger.row().surface() > 1e-14) return 0.5 * (before + run.now.time);
        }
    return std::numeric_limits<double>::infinity();
}

}  // namespace

TEST_CASE("H25 a plate that is quenched cracks from the drop of temperature of its strength on" *
          doctest::test_suite("slow")) {
    describe(
        "A plate of alumina (E = 370 GPa, nu = 0.3, a = 7.5e-6/K, kappa = 8.85e-6 m2/s, 10 mm thick) cooled on both "
        "faces with the coefficient h: smallest drop of temperature at which it cracks, by bisection, with sigma_c = "
        "180 and 342.2 MPa, and the time of the first crack for a drop of 380 K with 180 MPa. References: sigma_c/(E "
        "a) over the largest (mean - theta) of the Fourier series, and the time at which (mean - theta) is sigma_c/(E "
        "a 380 K). A strip of two columns, rows of 0.125 um at the face, implicit bulk with theta = 1 and steps of 0.5 "
        "% of the time so far.");
    struct Row {
        double transfer, begin, end, largest, first_crack;  // [W/(m2 K)], [s], [s], [-], [s]
    };
    // h infinite: times from 10 us on. Earlier the cooled layer is as thin as a row, and steps are no longer slow beside
    // waves; by then the mean has fallen by 0.2 %, and a first step of backward Euler has a row 0.5 % warmer than its face.
    // First cracks are late, since the stress of a row is that of its middle and one row opens against the next: with
    // rows of 2, 0.5 and 0.125 um (columns of 25, 12.5, 6.25 um) by 5.8, 2.2 and 0.7 % (h = 1e5), 3.2, 1.2 and 0.7 % (5e4).
    // Steps of 1, 0.5 and 0.25 % of the time so far have 0.5, 0.7 and 0.9 %, and 0.5, 0.7 and 0.4 %: all within a step
    constexpr double whole = 0.15 * half * half / kappa;  // beyond the largest stress of all
    for (const Row row : {Row{2e4, 1e-4, 2 * whole, 0.400153, 9.4604e-3},
                          {5e4, 1e-4, whole, 0.559050, 1.3994e-3},
                          {1e5, 1e-4, 0.6 * whole, 0.664034, 0.34150e-3},
                          {infinity, 1e-5, 1e-3, 1, 0}}) {
        const TimeFunction mean = mean_of(row.transfer, row.begin, row.end);
        const std::string of = ", h = " + digits(row.transfer);
        for (const double sigma_c : {180e6, 342.2e6}) {
            const double reference = sigma_c / (alumina.E * expansion) / row.largest;
            double holds = 0.98 * reference, cracks = 1.02 * reference;
            REQUIRE(std::isinf(first_crack(holds, row.transfer, sigma_c, mean)));
            REQUIRE(std::isfinite(first_crack(cracks, row.transfer, sigma_c, mean)));
            for (int i = 0; i < 4; ++i) {
                const double DT = 0.5 * (holds + cracks);
                (std::isinf(first_crack(DT, row.transfer, sigma_c, mean)) ? holds : cracks) = DT;
            }
            verify("drop of temperature" + of + ", " + digits(1e-6 * sigma_c) + " MPa", 0.5 * (holds + cracks),
                   reference, {std::isinf(row.transfer) ? 0.015 : 0.002});
        }
        if (row.first_crack == 0) continue;
        const double found = first_crack(380, row.transfer, 180e6,
                                         mean_of(row.transfer, 0.001 * row.first_crack, 1.2 * row.first_crack));
        verify("first crack at a drop of 380 K" + of, found, row.first_crack, {0.01});
    }
}

}  // namespace onset_test
