// The factor by blocks against a dense one, on random patterns that fill.
#include "nonsmooth/block_factor.hpp"
#include "base/random.hpp"

#include <doctest/doctest.h>
#include <Eigen/LU>

namespace block_factor_test {

using namespace knap;

TEST_CASE("a factor by blocks solves as a dense one does for several values of one pattern") {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        Random random(seed, "blocks");
        const Index n = 3 + static_cast<Index>(seed);
        BlockFactor factor;
        factor.start(n);
        std::vector<std::array<Index, 3>> blocks;  // row, column, place
        for (Index i = 0; i < n; ++i) blocks.push_back({i, i, i});
        for (Index i = 0; i < n; ++i)
            for (Index j = 0; j < i; ++j)
                if (random.uniform(0, 1) < 0.3)
                    for (const auto& [row, column] : {std::pair{i, j}, {j, i}})
                        blocks.push_back({row, column, factor.add(row, column)});
        factor.analyse();
        for (int values = 0; values < 3; ++values) {
            Eigen::MatrixXd A = Eigen::MatrixXd::Zero(2 * n, 2 * n);
            factor.clear();
            for (const auto& [row, column, place] : blocks) {
                Eigen::Matrix2d value;
                for (double& a : value.reshaped()) a = random.uniform(-1, 1);
                if (row == column) value += 2 * n * Eigen::Matrix2d::Identity();
                A.block<2, 2>(2 * row, 2 * column) = factor.block(place) = value;
            }
            Eigen::VectorXd b(2 * n);
            for (double& x : b) x = random.uniform(-1, 1);
            const Eigen::VectorXd exact = A.partialPivLu().solve(b);
            REQUIRE(factor.factorise());
            factor.solve(b);
            CHECK((b - exact).norm() <= 1e-13 * exact.norm());
        }
    }
}

TEST_CASE("a singular pivot is told") {
    BlockFactor factor;
    factor.start(1);
    factor.analyse();
    factor.clear();
    CHECK(!factor.factorise());
}

}  // namespace block_factor_test
