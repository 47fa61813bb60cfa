// Psi is the potential of the cohesive tractions and of the driving force A of the damage.
#include "material/cohesive_law.hpp"
#include "base/random.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace cohesive_law_test {

using namespace knap;
using knap::tests::relative;
using knap::tests::within;

namespace {
const CohesiveLaw law{.sigma_c = 3, .G_c = 6, .gamma = 0.7};
}

TEST_CASE("tractions and driving force are the derivatives of the surface energy") {
    Random random(1, "law");
    const double step = 1e-5;
    for (int i = 0; i < 200; ++i) {
        const double u_N = random.uniform(0.01, 2), u_T = random.uniform(0.01, 2) * (random.uniform() < 0.5 ? -1 : 1),
                     beta = random.uniform(0.01, 0.99);
        const double by_N =
            (law.surface_energy(beta, u_N + step, u_T) - law.surface_energy(beta, u_N - step, u_T)) / (2 * step);
        const double by_T =
            (law.surface_energy(beta, u_N, u_T + step) - law.surface_energy(beta, u_N, u_T - step)) / (2 * step);
        const double by_beta =
            (law.surface_energy(beta + step, u_N, u_T) - law.surface_energy(beta - step, u_N, u_T)) / (2 * step);
        CHECK(by_N == relative(beta * law.sigma_c, 1e-8));
        CHECK(by_T == relative(std::copysign(law.gamma * beta * law.sigma_c, u_T), 1e-8));
        const double s = u_N + law.gamma * std::abs(u_T);
        CHECK(-by_beta == within(law.sigma_c * law.delta_c() * (1 - beta) - law.sigma_c * s, 1e-8));
    }
}

TEST_CASE("the cohesion that follows minimises the surface energy and never grows") {
    Random random(2, "law");
    for (int i = 0; i < 500; ++i) {
        const double u_N = random.uniform(-1, 5), u_T = random.uniform(-5, 5), beta = random.uniform();
        const double next = law.next_cohesion(beta, u_N, u_T);
        CHECK(next >= 0);
        CHECK(next <= beta);
        const double least = law.surface_energy(next, u_N, u_T);
        for (double other = 0; other <= beta; other += 0.01)
            CHECK(law.surface_energy(other, u_N, u_T) >= least - 1e-12);
    }
}

TEST_CASE("an interface breaks at its critical opening and has then spent G_c") {
    CHECK(law.delta_c() == relative(4));
    CHECK(law.surface_energy(1, 0, 0) == 0);
    CHECK(law.next_cohesion(1, 0, 0) == 1);
    CHECK(law.next_cohesion(1, -1, 0) == 1);  // pressed: penetration does not count
    CHECK(law.next_cohesion(1, 1, 0) == relative(0.75));
    CHECK(law.next_cohesion(1, 0, -2) == relative(1 - 0.7 * 2 / 4));
    CHECK(law.next_cohesion(1, 4, 0) == 0);
    CHECK(law.next_cohesion(0, 0, 0) == 0);
    CHECK(law.surface_energy(0, 17, 3) == law.G_c);
    CHECK(law.surface_energy(1, 4, 0) == relative(12));
    CHECK(CohesiveLaw{.sigma_c = 0}.delta_c() == 0);
    CHECK(!CohesiveLaw::unbreakable().breakable());
    CHECK(law.breakable());
}

}  // namespace cohesive_law_test
