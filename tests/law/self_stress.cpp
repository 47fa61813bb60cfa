// The largest smallest slack over all self-stresses, against all supports of its dual: min sum lambda_i value_i over
// lambda >= 0 with sum lambda = 1 and sum lambda gradient = 0, which has a solution with at most three positive lambda.
#include "law/self_stress.hpp"
#include "base/random.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

namespace self_stress_test {

using namespace knap;
using knap::tests::relative;
using knap::tests::within;

namespace {

double best_slack(const std::vector<HalfPlane>& planes) {
    double best = INFINITY;
    const std::size_t n = planes.size();
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = i + 1; j < n; ++j) {
            const Vec2 &a = planes[i].gradient, &b = planes[j].gradient;
            if (std::abs(cross(a, b)) <= 1e-13 * a.norm() * b.norm() && a.dot(b) < 0)
                best =
                    std::min(best, (planes[i].value * b.norm() + planes[j].value * a.norm()) / (a.norm() + b.norm()));
            for (std::size_t k = j + 1; k < n; ++k) {
                const Vec2& c = planes[k].gradient;
                double u = cross(b, c), v = cross(c, a), w = cross(a, b);
                if (u + v + w < 0) u = -u, v = -v, w = -w;
                if (u < 0 || v < 0 || w < 0 || u + v + w <= 1e-13) continue;
                best = std::min(best, (u * planes[i].value + v * planes[j].value + w * planes[k].value) / (u + v + w));
            }
        }
    return best;
}

}  // namespace

TEST_CASE("the self-stress climbs to the largest smallest slack") {
    Random random(1, "circulation");
    int n_admissible = 0, n_not = 0;
    for (int count = 0; count < 3000; ++count) {
        const int n = 1 + static_cast<int>(random.uniform(0, 20));
        const bool lattice = count % 3 == 0;  // parallel and antiparallel gradients, equal values
        const double offset = random.uniform(-1, 1), unit = std::pow(10, random.uniform(-6, 6));
        std::vector<HalfPlane> planes;
        for (int i = 0; i < n; ++i) {
            double angle = random.uniform(0, 2 * M_PI), value = random.uniform(-1, 1) + offset;
            if (lattice) angle = std::floor(8 * random.uniform()) * M_PI / 4, value = std::round(3 * value);
            const double length = lattice ? 1 : std::pow(10, random.uniform(-1, 1));
            planes.push_back({unit * value, length * Vec2(std::cos(angle), std::sin(angle)), i, 0});
        }
        const Vec2 start = unit * Vec2(random.uniform(-1, 1), random.uniform(-1, 1));
        const SelfStress found = find_self_stress(planes, start);
        double slack = INFINITY;
        for (const HalfPlane& plane : planes) slack = std::min(slack, plane.value + plane.gradient.dot(found.c));
        CHECK(found.slack == within(slack, 1e-12 * 100 * unit));
        const double best = best_slack(planes);
        if (best > 1e-12 * unit) {
            CHECK_MESSAGE(found.slack >= -1e-11 * unit, "problem ", count);
            ++n_admissible;
        } else if (best < -1e-12 * unit) {
            CHECK_MESSAGE(found.slack == within(best, 1e-10 * unit), "problem ", count);
            REQUIRE(found.n_binding > 0);
            ++n_not;
        }
    }
    CHECK(n_admissible > 300);
    CHECK(n_not > 300);
}

TEST_CASE("the half planes that bind are the mechanism") {
    // pulled apart along x: no self-stress helps, and exactly the two that oppose each other bind
    const std::vector<HalfPlane> planes = {
        {-1, {1, 0}, 0, 0}, {-2, {-1, 0}, 1, 0}, {5, {0, 1}, 2, 0}, {5, {0, -1}, 3, 0}};
    const SelfStress found = find_self_stress(planes, Vec2(0.3, 0.1));
    CHECK(found.slack == relative(-1.5));
    REQUIRE(found.n_binding == 2);
    CHECK(std::min(found.binding[0], found.binding[1]) == 0);
    CHECK(std::max(found.binding[0], found.binding[1]) == 1);
}

}  // namespace self_stress_test
