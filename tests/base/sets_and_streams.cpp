// Disjoint sets, groups, random streams, sums over blocks, zeros.
#include "base/grouped.hpp"
#include "base/parallel.hpp"
#include "base/random.hpp"
#include "base/secant.hpp"
#include "base/union_find.hpp"

#include <doctest/doctest.h>

#include <set>

namespace sets_and_streams_test {

using namespace knap;

TEST_CASE("disjoint sets: the partition is that of the joins and its names do not depend on their order") {
    Random random(1, "union_find");
    for (int trial = 0; trial < 50; ++trial) {
        const int n = 40, n_joins = trial;
        std::vector<std::pair<Index, Index>> joins;
        for (int i = 0; i < n_joins; ++i)
            joins.emplace_back(static_cast<Index>(random.bits() % n), static_cast<Index>(random.bits() % n));
        std::vector<Index> lowest(n);  // by relaxation: the lowest number that can be reached
        for (Index i = 0; i < n; ++i) lowest[i] = i;
        for (int sweep = 0; sweep < n; ++sweep)
            for (const auto& [i, j] : joins) lowest[i] = lowest[j] = std::min(lowest[i], lowest[j]);
        UnionFind forward(n), backward(n);
        int n_united = 0;
        for (const auto& [i, j] : joins) n_united += forward.join(i, j);
        for (auto it = joins.rbegin(); it != joins.rend(); ++it) backward.join(it->second, it->first);
        for (Index i = 0; i < n; ++i) {
            CHECK(forward.find(i) == lowest[i]);
            CHECK(backward.find(i) == lowest[i]);
        }
        CHECK(n - n_united == std::ssize(std::set(lowest.begin(), lowest.end())));
    }
}

TEST_CASE("groups keep the order of their values and may be empty") {
    const std::vector<std::pair<std::size_t, int>> pairs{{2, 7}, {0, 1}, {2, 5}, {2, 9}, {0, 3}};
    const Grouped<int> groups(4, [&](const auto& visit) {
        for (const auto& [group, value] : pairs) visit(group, value);
    });
    const auto in = [&](std::size_t g) { return std::vector<int>(groups[g].begin(), groups[g].end()); };
    CHECK(groups.n_groups() == 4);
    CHECK(in(0) == std::vector{1, 3});
    CHECK(in(1).empty());
    CHECK(in(2) == std::vector{7, 5, 9});
    CHECK(in(3).empty());
}

TEST_CASE("random streams: named apart and with the moments of their distributions") {
    CHECK(Random(7, "a").bits() == Random(7, "a").bits());
    CHECK(Random(7, "a").bits() != Random(7, "b").bits());
    CHECK(Random(7, "a").bits() != Random(8, "a").bits());
    // n = 200 000 numbers: the mean of a distribution of deviation s has the standard error s/447. Limits are 5 of these.
    const int n = 200000;
    Random random(3, "moments");
    double uniform = 0, normal = 0, square = 0, lognormal = 0, spread = 0;
    for (int i = 0; i < n; ++i) {
        const double u = random.uniform();
        REQUIRE((u >= 0 && u < 1));
        uniform += u / n;
        const double z = random.normal(), w = random.lognormal(0.3);
        normal += z / n, square += z * z / n, lognormal += w / n, spread += (w - 1) * (w - 1) / n;
    }
    CHECK(std::abs(uniform - 0.5) < 5 * 0.2887 / 447);
    CHECK(std::abs(normal) < 5. / 447);
    CHECK(std::abs(square - 1) < 5 * 1.4142 / 447);
    CHECK(std::abs(lognormal - 1) < 5 * 0.3 / 447);
    CHECK(std::abs(spread - 0.09) < 0.003);
}

TEST_CASE("sums over blocks have the same bits for any number of threads and every block is done once") {
    const std::size_t n = 10007;
    std::vector<double> values(n);
    Random random(5, "blocks");
    for (double& value : values) value = random.normal() * std::exp(10 * random.normal());
    const int threads_before = omp_get_max_threads();
    std::vector<double> sums;
    for (const int threads : {1, 2, 3, 4, 7}) {
        omp_set_num_threads(threads);
        std::vector<std::atomic<int>> visits(n);
        std::vector<double> partial;
        sums.push_back(sum_over_blocks<double>(n, 64, partial, [&](std::size_t i, std::size_t end, double& sum) {
            for (; i < end; ++i) ++visits[i], sum += values[i];
        }));
        CHECK(std::ranges::all_of(visits, [](const auto& count) { return count == 1; }));
    }
    omp_set_num_threads(threads_before);
    for (const double sum : sums) CHECK(sum == sums.front());
}

TEST_CASE("zero_between: a function that stalls plain regula falsi") {
    int n_evaluations = 0;
    const auto f = [&](double x) { return ++n_evaluations, std::pow(x, 9) - 0.5; };
    const double x = zero_between(0, -0.5, 2, 511.5, 1e-14, 100, f);
    CHECK(std::abs(x - std::pow(0.5, 1. / 9)) < 1e-14);
    CHECK(n_evaluations < 40);
}

}  // namespace sets_and_streams_test
