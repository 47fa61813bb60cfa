// Inertia and scatter raise the strength of a bar that expands, without any rate in the law.
#include "model/make_model.hpp"
#include "support/bodies.hpp"
#include "support/verification.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

namespace spall_test {

using namespace knap;
using namespace knap::tests;

namespace {

constexpr double E = 60e9, density = 2650, length = 0.04;  // [Pa], [kg/m3], [m]
const CohesiveLaw granite{.sigma_c = 10e6, .G_c = 80};
constexpr std::array rates{1.0, 10.0, 30.0, 100.0, 300.0};  // [1/s]
using Peaks = std::array<double, rates.size()>;

/// A chain of `n` cells of granite, each of four triangles that do not break, with one edge between two cells.
Model chain(int n, double strain_rate, double modulus, std::uint64_t seed) {
    ModelInput input;
    input.plane = PlaneModel::stress;
    input.mesh = symmetric_bar_mesh(n, length, 1e-4, [](int i) { return i % 2; });
    input.materials.assign(2, {.density = density, .E = E, .nu = 0});
    input.laws = {granite, CohesiveLaw::unbreakable()};
    input.law_of_pair = {{1, 0}, {0, 1}};
    // the weakest of the edges along 20 mm has the strength of the law on average
    input.scatter = {{.kind = Scatter::Kind::weibull, .modulus = modulus, .length = 0.02 * n * 1e-4 / length}};
    input.seed = seed;
    input.initial_velocities = {{.on = {}, .value = {0, 0}, .strain_rate = {strain_rate, 0, 0}}};
    const double v = 0.5 * length * strain_rate;
    input.loads = {load(Load::Kind::velocity, "left", -v, std::nullopt),
                   load(Load::Kind::velocity, "right", v, std::nullopt)};
    return make_model(std::move(input));
}

/// [Pa] Strengths of the edges between the cells, from left to right.
std::vector<double> strengths(const Model& model) {
    std::vector<std::pair<double, double>> found;
    for (const Interface& interface : model.interfaces)
        if (const double sigma_c = model.laws[interface.law].sigma_c; std::isfinite(sigma_c))
            found.emplace_back(model.mesh.vertices[interface.vertex[0]].x(), sigma_c);
    std::ranges::sort(found);
    std::vector<double> sorted;
    for (const auto& [x, sigma_c] : found) sorted.push_back(sigma_c);
    return sorted;
}

// Both programs start with the strain at which the weakest edge bears .98 of its strength: a homogeneous expansion has
// done nothing else until then.

/// [Pa] Largest mean stress, until it has fallen to half of it.
double peak_of(const Model& model, double strain_rate) {
    MoreauJean stepper(model);
    State now = initial_state(model), next;
    const double strain = 0.98 * std::ranges::min(strengths(model)) / E;
    for (Index c = 0; c < model.mesh.n_corners(); ++c)
        now.displacement[now.node_of_corner[c]].x() =
            strain * (model.mesh.vertices[model.mesh.triangles[c / 3][c % 3]].x() - 0.5 * length);
    EnergyLedger ledger(model, now);
    const double h = 0.8 * stepper.stable_step();
    const int stride = std::clamp(static_cast<int>(1e-3 * granite.sigma_c / (E * strain_rate * h)), 1, 20);
    double peak = 0;
    for (double mean = 0; mean >= 0.5 * peak;) {
        for (int i = 0; i < stride; ++i) {
            const StepReport report = stepper.step(now, h, next);
            REQUIRE(report.rejection == Rejection::none);
            std::swap(now, next);
            ledger.add(now, report);
        }
        double sum = 0;
        for (Index t = 0; t < model.mesh.n_triangles(); ++t) sum += model.mesh.area(t) * stress(model, now, t)[0];
        mean = sum / (length * 1e-4);
        peak = std::max(peak, mean);
    }
    CHECK(ledger.largest_residual() <= 1e-11 * ledger.largest_energy());
    return peak;
}

/// The same by a program of its own: cells are springs with half of their mass at each end, joined by edges that stick,
/// soften linearly, stay at their cohesion when they close and meet without restitution.
double peak_of(const std::vector<double>& strength, double strain_rate) {
    const std::size_t n = strength.size() + 1;
    const double cell = length / static_cast<double>(n), m = 0.5 * density * cell,
                 h = 0.8 * cell / std::sqrt(E / density), kick = h / m, stiffness = E * h / cell,
                 decay = 0.5 / granite.G_c;
    std::vector<double> left(n), right(n), stress(n, 0.98 * std::ranges::min(strength)), beta(n - 1, 1), u(n - 1, 0);
    for (std::size_t i = 0; i < n; ++i) {
        left[i] = strain_rate * (static_cast<double>(i) * cell - 0.5 * length);
        right[i] = left[i] + strain_rate * cell;
    }
    double peak = 0;
    for (double mean = 0; mean >= 0.5 * peak;) {
        for (std::size_t i = 0; i + 1 < n; ++i) {
            const double a = right[i] - kick * stress[i], b = left[i + 1] + kick * stress[i + 1];
            const double sticks = (b - a + u[i] * (1 / h)) * (0.5 / kick);  // the traction that ends the step closed
            const double traction = std::min(sticks, beta[i] * strength[i]);
            right[i] = a + kick * traction, left[i + 1] = b - kick * traction;
            if (traction == sticks) {
                u[i] = 0;
                continue;
            }
            u[i] += h * (left[i + 1] - right[i]);
            beta[i] = std::min(beta[i], std::max(0.0, 1 - u[i] * strength[i] * decay));
        }
        mean = 0;
        for (std::size_t i = 0; i < n; ++i) stress[i] += stiffness * (right[i] - left[i]), mean += stress[i];
        mean /= static_cast<double>(n);
        peak = std::max(peak, mean);
    }
    return peak;
}

/// Strengths of the edges of a bar of `n_cells` cells: the weakest of those along 20 mm has 10 MPa in the mean.
std::vector<double> random_strengths(std::mt19937_64& random, std::size_t n_cells, double modulus) {
    std::vector<double> strength(n_cells - 1);
    const double n_edges = 0.5 * static_cast<double>(n_cells);
    for (double& sigma_c : strength) {
        const double uniform = 0x1p-53 * (static_cast<double>(random() >> 11) + 0.5);
        sigma_c = granite.sigma_c / std::tgamma(1 + 1 / modulus) * std::pow(-n_edges * std::log(uniform), 1 / modulus);
    }
    return strength;
}

/// Peaks at all rates of `n` bars of 400 cells by the one-dimensional program, with its own random numbers; the same
/// ones for every modulus.
std::vector<Peaks> random_bars(int n, double modulus) {
    std::mt19937_64 random(1);
    std::vector<Peaks> found(n);
    for (Peaks& peaks : found) {
        const std::vector<double> strength = random_strengths(random, 400, modulus);
        for (std::size_t i = 0; i < rates.size(); ++i) peaks[i] = peak_of(strength, rates[i]);
    }
    return found;
}

struct Line {
    double mean, slope, deviation;  // y = mean + slope z +- deviation
};

Line regression(const std::vector<double>& z, const std::vector<double>& y) {
    const double n = static_cast<double>(z.size());
    Line line{};
    for (const double value : y) line.mean += value / n;
    for (std::size_t i = 0; i < y.size(); ++i) line.slope += z[i] * (y[i] - line.mean) / n;
    for (std::size_t i = 0; i < y.size(); ++i) line.deviation += std::pow(y[i] - line.mean - line.slope * z[i], 2) / n;
    line.deviation = std::sqrt(line.deviation);
    return line;
}

}  // namespace

TEST_CASE("E27 a chain of cells with random strength bears more the faster it expands" * doctest::test_suite("slow")) {
    describe(
        "400 cells of .1 mm in a bar of granite of 40 mm that expands uniformly (E = 60 GPa, G_c = 80 J/m2, Weibull's "
        "modulus m, weakest link of 20 mm 10 MPa): largest mean stress. Reference: a one-dimensional program with the "
        "same strengths, 4 bars for every m.");
    for (const double modulus : {5.0, 10.0, 20.0}) {
        const std::string m = "m = " + digits(modulus) + ", ";
        for (const double rate : rates) {
            double worst = 0, sum = 0, reference = 0;
            for (int seed = 1; seed <= 4; ++seed) {
                const Model model = chain(400, rate, modulus, seed);
                REQUIRE(strengths(model).size() == 399);
                const double found = peak_of(model, rate), expected = peak_of(strengths(model), rate);
                worst = std::max(worst, std::abs(found / expected - 1));
                sum += found, reference += expected;
            }
            verify(m + digits(rate) + " 1/s, mean of 4 bars in MPa", 0.25e-6 * sum, 0.25e-6 * reference, {0.01, 0.005});
            verify_small(m + digits(rate) + " 1/s, largest relative difference of a bar", worst, {0.02, 0.01});
        }
    }
}

// An earlier one-dimensional program gave ratios to the peak at 1/s that lie above the mean of many bars, all twelve.
// Stated before the bars were computed: each must lie within 2.5 standard deviations of the mean of four. Afterwards:
// what the strength of four bars at 1/s, that of their weakest links, does not explain, within 2.5 of what it leaves.
TEST_CASE("E27 means of four bars differ by the weakest links of these bars" * doctest::test_suite("slow")) {
    describe(
        "The ratio of the largest mean stress to that at 1/s, of four bars and four bars, by the one-dimensional "
        "program: the mean of 200 such groups against a table of an earlier program (one group, random numbers of its "
        "own), in standard deviations of a group. The strength at 1/s is that of the weakest of 400 edges: one "
        "deviation of it explains the four values of each m.");
    constexpr int n_groups = 200;
    struct Row {
        double modulus;
        std::array<double, 4> at;
    };
    for (const Row& row :
         {Row{5, {1.14, 1.38, 1.82, 2.26}}, Row{10, {1.11, 1.27, 1.46, 1.64}}, Row{20, {1.09, 1.16, 1.25, 1.31}}}) {
        const std::vector<Peaks> bars = random_bars(4 * n_groups, row.modulus);
        std::vector<Peaks> groups(n_groups, Peaks{});
        for (std::size_t i = 0; i < bars.size(); ++i)
            for (std::size_t r = 0; r < rates.size(); ++r) groups[i / 4][r] += 0.25 * bars[i][r];
        std::vector<double> base;
        double mean = 0, deviation = 0;
        for (const Peaks& group : groups) base.push_back(group[0]), mean += group[0] / n_groups;
        for (const double value : base) deviation += std::pow(value - mean, 2) / n_groups;
        deviation = std::sqrt(deviation);
        for (double& value : base) value = (value - mean) / deviation;
        const std::string m = "m = " + digits(row.modulus) + ", ";
        // the weakest of the edges along 40 mm has 10 MPa 2^(-1/m), and every edge opens at its strength
        verify(m + "1 1/s, mean over that of the weakest edge", mean,
               granite.sigma_c * std::pow(399. / 200, -1 / row.modulus), {0.03, 0.02});
        std::array<Line, 4> lines;
        double top = 0, bottom = 0;  // of z, by least squares
        for (std::size_t i = 0; i < 4; ++i) {
            std::vector<double> ratio;
            for (const Peaks& group : groups) ratio.push_back(group[i + 1] / group[0]);
            Line& line = lines[i] = regression(base, ratio);
            const double scatter = std::hypot(line.slope, line.deviation), rounding = 0.01 / std::sqrt(12);
            verify_near(m + digits(rates[i + 1]) + " 1/s over 1 1/s, " + digits(line.mean, 4) + " +- " +
                            digits(scatter, 2) + ", table " + digits(row.at[i]) + ": deviations",
                        (row.at[i] - line.mean) / scatter, 0, {2.5, 1.5});
            line.deviation = std::hypot(line.deviation, rounding);
            top += line.slope * (row.at[i] - line.mean) / std::pow(line.deviation, 2);
            bottom += std::pow(line.slope / line.deviation, 2);
        }
        const double z = top / bottom;
        verify_near(m + "deviation of the weakest links that explains the row", z, 0, {2.5, 1.5});
        double worst = 0;
        for (std::size_t i = 0; i < 4; ++i)
            worst = std::max(worst, std::abs(row.at[i] - lines[i].mean - lines[i].slope * z) / lines[i].deviation);
        verify_small(m + "largest deviation of the four values that it leaves", worst, {2.5, 1.5});
        if (row.modulus != 10) continue;
        // against the weakest link of 20 mm, whose mean is known, at a rate at which many edges open: the least scatter
        double at_100 = 0;
        for (const Peaks& group : groups) at_100 += group[3] / n_groups;
        verify(m + "100 1/s, mean of all bars over 10 MPa", at_100 / granite.sigma_c, 1.25, {0.05, 0.03});
    }
}

TEST_CASE("E27 the strength of a chain hardly depends on the size of its cells" * doctest::test_suite("slow")) {
    describe(
        "The bars with m = 10 at 100 1/s, cut into 400, 800 and 1600 cells with the same mean weakest link of 20 mm: "
        "largest mean stress over 10 MPa, mean of 100 bars by the one-dimensional program, against 1.25, 1.24 and 1.23 "
        "of an earlier program (four bars).");
    constexpr int n_bars = 100;
    double coarsest = 0;
    for (const auto& [n_cells, expected] : {std::pair{400, 1.25}, {800, 1.24}, {1600, 1.23}}) {
        std::mt19937_64 random(2);
        double mean = 0;
        for (int i = 0; i < n_bars; ++i) mean += peak_of(random_strengths(random, n_cells, 10), 100) / n_bars;
        mean /= granite.sigma_c;
        if (coarsest == 0) coarsest = mean;
        verify(digits(n_cells) + " cells", mean, expected, {0.05, 0.03});
        verify(digits(n_cells) + " cells over 400 cells", mean, coarsest, {0.03, 0.02});
    }
}

}  // namespace spall_test
