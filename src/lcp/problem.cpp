#include "lcp/problem.hpp"

#include <algorithm>

namespace knap {

Eigen::VectorXd product(const LcpMatrix& M, const Eigen::VectorXd& x) {
    Eigen::VectorXd sums = Eigen::VectorXd::Zero(M.rows());
    if (x.isZero(0)) return sums;
    const int n = static_cast<int>(M.rows()), *starts = M.outerIndexPtr(), *columns = M.innerIndexPtr();
    const double *values = M.valuePtr(), *factors = x.data();
    const auto continued = [&](double sum, int row, int done) {
        for (int e = starts[row] + done; e < starts[row + 1]; ++e) sum += values[e] * factors[columns[e]];
        return sum;
    };
    int i = 0;
    for (; i + 4 <= n; i += 4) {  // the sums of four rows do not wait for each other
        const int a = starts[i], b = starts[i + 1], c = starts[i + 2], d = starts[i + 3];
        const int shared = std::min({b - a, c - b, d - c, starts[i + 4] - d});
        double of_a = 0, of_b = 0, of_c = 0, of_d = 0;
        for (int e = 0; e < shared; ++e) {
            of_a += values[a + e] * factors[columns[a + e]];
            of_b += values[b + e] * factors[columns[b + e]];
            of_c += values[c + e] * factors[columns[c + e]];
            of_d += values[d + e] * factors[columns[d + e]];
        }
        sums[i] = continued(of_a, i, shared);
        sums[i + 1] = continued(of_b, i + 1, shared);
        sums[i + 2] = continued(of_c, i + 2, shared);
        sums[i + 3] = continued(of_d, i + 3, shared);
    }
    for (; i < n; ++i) sums[i] = continued(0, i, 0);
    return sums;
}

}  // namespace knap
