// Inertia and scatter raise the strength of a bar that expands, without any rate in the law.
#include "support/bodies.hpp"
#include "support/verification.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

using namespace knap;
using namespace knap::tests;

namespace {

constexpr double E = 60e9, length = 0.04;  // [Pa], [m]

/// A chain of `n` cells of granite, each of four triangles that do not break, with one edge between two cells.
ModelInput chain(int n, double strain_rate, double modulus, std::uint64_t seed, const CohesiveLaw& law) {
    ModelInput input;
    input.plane = PlaneModel::stress;
    input.mesh = symmetric_bar_mesh(n, length, 1e-4, [](int i) { return i % 2; });
    input.materials.assign(2, {.density = 2650, .E = E, .nu = 0});
    input.laws = {law, CohesiveLaw::unbreakable()};
    input.law_of_pair = {{1, 0}, {0, 1}};
    // the weakest of the edges along 20 mm has the strength of the law on average
    input.scatter = {{.kind = Scatter::Kind::weibull, .modulus = modulus, .length = 0.02 * n * 1e-4 / length}};
    input.seed = seed;
    input.initial_velocities = {{.on = {}, .value = {0, 0}, .strain_rate = {strain_rate, 0, 0}}};
    const double v = 0.5 * length * strain_rate;
    input.loads = {load(Load::Kind::velocity, "left", -v, std::nullopt),
                   load(Load::Kind::velocity, "right", v, std::nullopt)};
    return input;
}

struct Peak {
    double stress = 0, weakest = 0;  // [Pa] largest mean stress; strength of the weakest edge

    Peak& operator+=(const Peak& other) {
        stress += other.stress, weakest += other.weakest;
        return *this;
    }
};

/// Until the mean stress has fallen to half of its largest value.
Peak peak_of(const ModelInput& input) {
    Run run(input);
    const double h = 0.8 * run.stepper.stable_step();
    double peak = 0;
    for (double mean = 0; mean >= 0.5 * peak;) {
        for (int i = 0; i < 4; ++i) run.step(h);
        REQUIRE(run.last.rejection == Rejection::none);
        double sum = 0;
        for (Index t = 0; t < run.model.mesh.n_triangles(); ++t)
            sum += run.model.mesh.area(t) * stress(run.model, run.now, t)[0];
        mean = sum / (length * 1e-4);
        peak = std::max(peak, mean);
        if (run.now.time > 1e-3) break;
    }
    CHECK(run.ledger.largest_residual() <= 1e-11 * run.ledger.largest_energy());
    Peak found{peak, CohesiveLaw::unbreakable().sigma_c};
    for (const Interface& interface : run.model.interfaces)
        found.weakest = std::min(found.weakest, run.model.laws[interface.law].sigma_c);
    return found;
}

/// Mean of four seeds.
Peak mean_peak(int n, double strain_rate, double modulus, const CohesiveLaw& law) {
    Peak sum;
    for (int seed = 1; seed <= 4; ++seed) sum += peak_of(chain(n, strain_rate, modulus, seed, law));
    return {0.25 * sum.stress, 0.25 * sum.weakest};
}

const CohesiveLaw granite{.sigma_c = 10e6, .G_c = 80};

}  // namespace

TEST_CASE("E27 a chain of cells with random strength bears more the faster it expands" * doctest::test_suite("slow")) {
    describe(
        "400 cells of .1 mm in a bar of granite of 40 mm that expands uniformly (E = 60 GPa, G_c = 80 J/m2, Weibull's "
        "modulus m, weakest link of 20 mm 10 MPa): largest mean stress over that at 1/s, mean of 4 seeds. Reference: a "
        "one-dimensional program of its own, other random numbers.");
    // against the weakest link of 20 mm, whose mean is known, at a rate at which many edges open: the least scatter
    for (const int n : {400, 800})
        verify("m = 10, 100 1/s, over 10 MPa, " + std::to_string(n) + " cells",
               mean_peak(n, 100, 10, granite).stress / granite.sigma_c, n == 400 ? 1.25 : 1.24, {0.05, 0.03});
    struct Row {
        double modulus, deviation, at[4];  // standard deviation of Weibull's distribution over its mean
    };
    for (const Row& row : {Row{5, 0.229, {1.14, 1.38, 1.82, 2.26}}, Row{10, 0.120, {1.11, 1.27, 1.46, 1.64}},
                           Row{20, 0.062, {1.09, 1.16, 1.25, 1.31}}}) {
        const Peak slow = mean_peak(400, 1, row.modulus, granite);
        const std::string m = "m = " + digits(row.modulus) + ", ";
        verify(m + "1 1/s, over the weakest edge of the same bars", slow.stress / slow.weakest, 1, {0.1, 0.05});
        constexpr double rates[] = {10, 30, 100, 300};
        // The stress at 1/s is that of the weakest of 400 edges, here and in the reference: the mean of four such has
        // half of Weibull's deviation, the quotient of two such means .7 of it. Three times that
        for (int i = 0; i < 4; ++i)
            verify(m + digits(rates[i]) + " 1/s", mean_peak(400, rates[i], row.modulus, granite).stress / slow.stress,
                   row.at[i], {2.1 * row.deviation, 0.7 * row.deviation});
    }
}
