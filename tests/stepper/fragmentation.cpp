// A bar stretched at a constant rate breaks into as many pieces as published for alumina, from slow to fast.
//
// Source of the numbers: F. Zhou, J.-F. Molinari, K. T. Ramesh, "Characteristic fragment size distributions in dynamic
// fragmentation", Appl. Phys. Lett. 88 (2006) 261918 (and Int. J. Fract. 139 (2006) 169): mean fragment length s_0 s
// with s = 4.5/(1 + 4.5 r^(2/3)), s_0 = E G_c/sigma_c^2, r = strain rate over sigma_c^3 c/(E^2 G_c). That fit is for an
// irreversible law whose unloading goes to the origin (secant). With constant unloading a damaged interface that stops
// opening draws its sides together with its whole traction and gives beta sigma_c s back.
#include "analysis/fragments.hpp"
#include "support/bodies.hpp"
#include "support/meshes.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace fragmentation_test {

using namespace knap;
using namespace knap::tests;

namespace {

constexpr double E = 370e9, density = 3900, sigma_c = 262e6, G_c = 50;
const double s_0 = E * G_c / (sigma_c * sigma_c), c = std::sqrt(E / density);
const double unit_rate = sigma_c * sigma_c * sigma_c * c / (E * E * G_c);

double fitted_length(double r) { return s_0 * 4.5 / (1 + 4.5 * std::pow(r, 2.0 / 3)); }

struct Broken {
    double pieces = 0, dissipated = 0;  // [-], [J] of a breaking interface
    double iterations = 0;              // linear systems of fans per step and expected piece

    Broken& operator+=(const Broken& other) {
        pieces += other.pieces, dissipated += other.dissipated, iterations += other.iterations;
        return *this;
    }
};

/// Of a bar of `n_expected` fitted lengths, `n_cells` interfaces in each.
Broken broken(double r, int n_expected, int n_cells, std::uint64_t seed, Unloading unloading) {
    const double rate = r * unit_rate, length = n_expected * fitted_length(r), cell = fitted_length(r) / n_cells;
    const int n = n_expected * n_cells;
    ModelInput input;
    input.mesh = symmetric_bar_mesh(n, length, cell);
    for (Index t = 0; t < input.mesh.n_triangles(); ++t)
        input.mesh.grain.push_back(t / 4);  // a cell cannot break, its ends can
    input.plane = PlaneModel::stress;
    input.materials = {{.density = density, .E = E, .nu = 0}};
    input.laws = {{.sigma_c = sigma_c, .G_c = G_c, .unloading = unloading}, CohesiveLaw::unbreakable()};
    input.law_of_pair = {{0}};
    input.law_within = {1};
    input.scatter = {{.kind = Scatter::Kind::uniform, .deviation = 0.01 / std::sqrt(3.0)}, {}};  // within +- 1 %
    input.seed = seed;
    const double end_speed = 0.5 * rate * length;
    input.loads = {load(Load::Kind::velocity, "left", -end_speed, std::nullopt),
                   load(Load::Kind::velocity, "right", end_speed, std::nullopt)};
    Run run(std::move(input));
    for (Index corner = 0; corner < run.model.mesh.n_corners(); ++corner)
        run.now.velocity[run.now.node_of_corner[corner]] = {rate * (run.model.mesh.corner(corner).x() - 0.5 * length),
                                                            0};
    run.ledger = EnergyLedger(run.model, run.now);
    // from the strength on, until pieces that part have gone several critical openings
    const double delta_c = 2 * G_c / sigma_c, end = sigma_c / (E * rate) + 8 * delta_c / (rate * fitted_length(r));
    const double h = 0.5 * run.stepper.stable_step();
    while (run.now.time < end) run.step(h);
    CHECK(run.ledger.largest_residual() < 1e-10 * run.ledger.largest_energy());
    const EnergyRow& row = run.ledger.row();
    // the energy of the ramps that are still stretched is no loss
    return {static_cast<double>(find_fragments(run.model, run.now).pieces.size()), row.dissipated / (G_c * cell),
            static_cast<double>(run.ledger.worst().fan_iterations) / static_cast<double>(run.now.n_steps * n_expected)};
}

}  // namespace

TEST_CASE("a stretched bar of alumina breaks into as many pieces as published" * doctest::test_suite("slow")) {
    for (const Unloading unloading : {Unloading::constant, Unloading::secant})
        for (const double r : {0.3, 1.0, 3.0, 10.0, 30.0}) {
            Broken sum;
            constexpr int n_seeds = 2, n_expected = 30;
            for (int seed = 1; seed <= n_seeds; ++seed) sum += broken(r, n_expected, 16, seed, unloading);
            const double pieces = sum.pieces / n_seeds, cracks = sum.dissipated / n_seeds;
            MESSAGE(std::string(unloading == Unloading::secant ? "secant" : "constant"), " unloading, strain rate ", r,
                    ": ", pieces, " pieces, expected ", n_expected, ", dissipated over G_c S ", cracks,
                    ", linear systems a step and piece ", sum.iterations / n_seeds);
            CHECK(pieces == relative(n_expected, 0.3));
            CHECK(cracks > pieces - 1 - 1e-9);  // whole cracks, and what damaged edges have lost
        }
}

}  // namespace fragmentation_test
