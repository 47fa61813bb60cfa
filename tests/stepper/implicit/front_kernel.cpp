// Dense arithmetic of one front: against Eigen, and the same bits from every instruction set.
#include "stepper/implicit/front_kernel.hpp"

#include "base/random.hpp"

#include <doctest/doctest.h>
#include <Eigen/Cholesky>

#include <algorithm>
#include <vector>

namespace front_kernel_test {

using namespace knap;

namespace {

struct Front {
    Front(int size, int n) : size(size), n(n), A(size, size) {
        Random random(1, "front " + std::to_string(size) + " " + std::to_string(n));
        for (double& entry : A.reshaped()) entry = random.uniform() - 0.5;
        A = (A * A.transpose()).eval() + Eigen::MatrixXd::Identity(size, size);
        L.assign(size * n + front_padding, 0), schur.assign((size - n) * (size - n) + front_padding, 0);
        for (int j = 0; j < size; ++j)
            for (int i = j; i < size; ++i) (j < n ? L[i + size * j] : schur[i - n + (size - n) * (j - n)]) = A(i, j);
        for (int i = 0; i < size; ++i) x.push_back(1 + i % 7);
        x.resize(size + front_padding);
    }
    /// `block`: pivots at once, a multiple of eight, first in their own rows, and rows and columns behind them eight at
    /// once; 0: all pivots at once in all rows.
    bool solve(const FrontKernel& kernel, int block = 0) {
        const int left = size - n;
        std::vector<double> packed(n * (size + 8) + front_padding);
        for (int begin = 0, end; begin < n; begin = end) {
            end = block == 0 ? n : begin == 0 && n % block > 0 ? n % block : begin + block;
            const int at_once = block > 0 ? 8 : size, n_pivots = end - begin;
            if (!kernel.eliminate(L.data(), size, begin, end, block > 0 ? end : size)) return false;
            for (int i = end; block > 0 && i < size; i += 8)
                kernel.eliminate_further_rows(L.data(), size, begin, end, i, std::min(size, i + 8));
            for (int i = end; i < size; i += at_once)
                kernel.pack(L.data(), size, begin, end, i, std::min(size, i + at_once), &packed[n_pivots * (i - end)]);
            for (int j = 0; j < n - end; j += at_once)
                kernel.subtract_products(packed.data(), n_pivots, &L[end * (size + 1)], size, size - end, j,
                                         std::min(n - end, j + at_once));
            for (int j = 0; j < left; j += at_once)
                kernel.subtract_products(&packed[n_pivots * (n - end)], n_pivots, schur.data(), left, left, j,
                                         std::min(left, j + at_once));
        }
        kernel.substitute(L.data(), size, n, x.data());
        kernel.substitute_back(L.data(), size, n, x.data());
        return true;
    }
    /// The lower halves and the solution.
    std::vector<double> numbers() const {
        std::vector<double> all(x.begin(), x.begin() + size);
        for (int j = 0; j < size; ++j)
            for (int i = j; i < size; ++i) all.push_back(j < n ? L[i + size * j] : schur[i - n + (size - n) * (j - n)]);
        return all;
    }

    int size, n;
    Eigen::MatrixXd A;
    std::vector<double> L, schur, x;
};

}  // namespace

TEST_CASE("a front is eliminated and substituted as by dense algebra and with the same bits by every kernel") {
    for (int size = 1; size <= 41; ++size)
        for (int n = 1; n <= size; n += size < 14 ? 1 : 5) {
            Front front(size, n);
            const std::vector<double> x = front.x;
            REQUIRE(front.solve(baseline_front_kernel()));
            const int left = size - n;
            const Eigen::MatrixXd A = front.A.topLeftCorner(n, n), B = front.A.bottomLeftCorner(left, n),
                                  S = front.A.bottomRightCorner(left, left) - B * A.llt().solve(B.transpose());
            double error = 0;
            for (int j = 0; j < left; ++j)
                for (int i = j; i < left; ++i) error = std::max(error, std::abs(front.schur[i + left * j] - S(i, j)));
            // what is left of the right-hand side, and A x_1 = b_1 - B' b_2' for what was left
            const Eigen::Map<const Eigen::VectorXd> b(x.data(), size), y(front.x.data(), size);
            const Eigen::VectorXd b_2 = b.tail(left) - B * A.llt().solve(b.head(n));
            const Eigen::VectorXd x_1 = A.llt().solve(b.head(n) - B.transpose() * b_2);
            if (left > 0) error = std::max(error, (y.tail(left) - b_2).cwiseAbs().maxCoeff());
            error = std::max(error, (y.head(n) - x_1).cwiseAbs().maxCoeff());
            CHECK(error < 1e-9);
            Front in_blocks(size, n);
            REQUIRE(in_blocks.solve(baseline_front_kernel(), 8));
            CHECK(in_blocks.numbers() == front.numbers());
#ifdef __x86_64__
            if (!__builtin_cpu_supports("avx2")) continue;
            Front again(size, n);
            REQUIRE(again.solve(avx2_front_kernel()));
            CHECK(again.numbers() == front.numbers());
#endif
        }
}

TEST_CASE("a front that is not positive definite is refused") {
    for (int at = 0; at < 9; ++at)
        for (const double wrong : {0.0, -1.0, std::nan("")}) {
            Front front(12, 9);
            front.L[at + 12 * at] = wrong;
            Front in_blocks = front;
            CHECK(!front.solve(baseline_front_kernel()));
            CHECK(!in_blocks.solve(baseline_front_kernel(), 8));
        }
}

}  // namespace front_kernel_test
