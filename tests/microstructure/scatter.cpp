// Random strength: distributions, the weakest link, random fields.
#include "microstructure/scatter.hpp"

#include "base/random.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace scatter_test {

using namespace knap;
using knap::tests::relative;

namespace {

const std::vector<Scatter> distributions{{.kind = Scatter::Kind::weibull, .modulus = 6},
                                         {.kind = Scatter::Kind::normal, .deviation = 0.1},
                                         {.kind = Scatter::Kind::lognormal, .deviation = 0.3},
                                         {.kind = Scatter::Kind::uniform, .deviation = 0.05}};

double hazard_of(double survival) { return -std::log(survival); }

}  // namespace

TEST_CASE("the strength factor inverts the survival function") {
    for (const Scatter& s : distributions)
        for (const double p : {1e-6, 1e-3, 0.1, 0.5, 0.9, 0.999}) {
            CAPTURE(static_cast<int>(s.kind));
            CAPTURE(p);
            CHECK(survival(s, strength_factor(s, hazard_of(p))) == relative(p, 1e-9));
        }
    for (const double z : {-6.0, -1.0, 0.0, 0.3, 5.0, 20.0})
        CHECK(normal_quantile(normal_hazard(z)) == relative(z, 1e-9));
}

TEST_CASE("strength factors have the mean 1 and the requested deviation") {
    // exact but for the integration: midpoints of equal probability
    constexpr int n = 200000;
    for (const Scatter& s : distributions) {
        CAPTURE(static_cast<int>(s.kind));
        double sum = 0, squares = 0;
        for (int i = 0; i < n; ++i) {
            const double x = strength_factor(s, hazard_of((i + 0.5) / n));
            sum += x;
            squares += x * x;
        }
        const double mean = sum / n, deviation = std::sqrt(squares / n - mean * mean);
        const double m = s.modulus,
                     weibull = std::sqrt(std::tgamma(1 + 2 / m) / std::pow(std::tgamma(1 + 1 / m), 2) - 1);
        CHECK(mean == relative(1, 1e-4));
        CHECK(deviation == relative(s.kind == Scatter::Kind::weibull ? weibull : s.deviation, 1e-3));
    }
}

TEST_CASE("a chain of n Weibull links is weaker by n^(-1/m) exactly") {
    // the weakest of n links has the sum of their hazards: min of x(h_i) = x(min h_i), and min of n exponential numbers
    // is one over n
    const Scatter s{.kind = Scatter::Kind::weibull, .modulus = 5};
    for (const double n : {2.0, 10.0, 1000.0})
        for (const double hazard : {1e-6, 0.3, 4.0})
            CHECK(strength_factor(s, hazard / n) == relative(std::pow(n, -0.2) * strength_factor(s, hazard), 1e-13));

    // and by numbers: mean strength of 4000 chains
    Random random(11, "chains");
    for (const int n : {1, 4, 16, 64}) {
        double sum = 0;
        constexpr int n_chains = 4000;
        for (int chain = 0; chain < n_chains; ++chain) {
            double weakest = 1e300;
            for (int i = 0; i < n; ++i)
                weakest = std::min(weakest, strength_factor(s, -std::log(1 - random.uniform())));
            sum += weakest;
        }
        CHECK(sum / n_chains ==
              relative(std::pow(n, -0.2), 4 * 0.23 / std::sqrt(n_chains)));  // four deviations of the mean
    }
}

TEST_CASE("the strength of a chain does not depend on its division") {
    // n pieces of length l_0/n: the survival of the chain is that of one piece of length l_0, for every distribution
    for (const Scatter& s : distributions)
        for (const double pieces : {3.0, 50.0})
            for (const double p : {0.05, 0.5, 0.95}) {
                // the weakest of n pieces survives with p when each does with p^(1/n); the hazard of a piece is drawn,
                // times l_0/l
                const double of_one = strength_factor(s, pieces * hazard_of(std::pow(p, 1 / pieces)));
                CHECK(of_one == relative(strength_factor(s, hazard_of(p)), 1e-9));
            }
}

TEST_CASE("truncated distributions stay within their limits and keep their order") {
    for (Scatter s : distributions) {
        s.lowest = 0.97;
        s.highest = 1.02;
        double last = 0;
        for (int i = 999; i > 0; --i) {
            const double x = strength_factor(s, hazard_of(i / 1000.0));
            CHECK(x >= 0.97);
            CHECK(x <= 1.02);
            CHECK(x > last);
            last = x;
        }
        const double middle = strength_factor(s, hazard_of(0.5));
        const double share = (survival(s, middle) - survival(s, 1.02)) / (survival(s, 0.97) - survival(s, 1.02));
        CHECK(share == relative(0.5, 1e-9));
    }
}

TEST_CASE("a random field has the requested correlation") {
    constexpr double L = 0.003;
    const std::vector<double> distances{0, 0.5 * L, L, 2 * L};
    std::vector<double> product(distances.size(), 0), product_y(distances.size(), 0);
    double sum = 0, fourth = 0;
    int n = 0;
    for (int seed = 0; seed < 40; ++seed) {
        Random random(seed, "field");
        const RandomField field(L, random);
        for (int i = 0; i < 100; ++i, ++n) {
            const Vec2 x(random.uniform(0, 60 * L), random.uniform(0, 60 * L));
            const double z = field(x);
            sum += z;
            fourth += z * z * z * z;
            for (std::size_t k = 0; k < distances.size(); ++k) {
                product[k] += z * field(x + Vec2(distances[k], 0));
                product_y[k] += z * field(x + Vec2(0, distances[k]));
            }
        }
    }
    for (std::size_t k = 0; k < distances.size(); ++k) {
        const double r = distances[k] / L;
        CHECK(std::abs(product[k] / n - std::exp(-r * r)) < 0.06);
        CHECK(std::abs(product_y[k] / n - std::exp(-r * r)) < 0.06);
    }
    CHECK(std::abs(sum / n) < 0.06);
    CHECK(std::abs(fourth / n - 3) < 0.4);  // as of a normal number
}

}  // namespace scatter_test
