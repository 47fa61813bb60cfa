// Strides through rows find what plain loops find.
#include "lcp/rows.hpp"

#include "base/random.hpp"

#include <doctest/doctest.h>

namespace rows_test {

using namespace knap;

TEST_CASE("runs and sets of columns pass every entry of a row once and products keep the bits of a plain loop") {
    Random random(47, "rows");
    for (int trial = 0; trial < 200; ++trial) {
        const int n = 1 + trial % 41;
        const double share = random.uniform(0, 1), wanted = random.uniform(0, 1);
        Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(n, n);
        std::vector<bool> is_wanted;
        for (int i = 0; i < n; ++i) is_wanted.push_back(random.uniform(0, 1) < wanted);
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j)
                if ((i % 3 == 0 && j > 0) || random.uniform(0, 1) < share) dense(i, j) = random.uniform(-1, 1);
        const LcpMatrix M = dense.sparseView(0, 0);
        const ColumnSet set(n, [&](int column) { return is_wanted[column]; });
        Eigen::VectorXd x(n), sums = Eigen::VectorXd::Zero(n);
        for (double& entry : x) entry = random.uniform(-1, 1);
        for (int i = 0; i < n; ++i) {
            const LcpRow row = row_of(M, i);
            std::vector<int> in_runs, all, found, in_set;
            int n_runs = 0, n_gaps = 0;
            for_each_run(row, [&](int first, int length) {
                ++n_runs;
                for (int e = first; e < first + length; ++e) {
                    in_runs.push_back(e);
                    CHECK(row.columns[e] - row.columns[first] == e - first);
                }
            });
            set.for_each(row, [&](int e) { found.push_back(e); });
            for (int e = 0; e < static_cast<int>(row.size()); ++e) {
                all.push_back(e);
                if (is_wanted[row.columns[e]]) in_set.push_back(e);
                if (e == 0 || row.columns[e] > row.columns[e - 1] + 1) ++n_gaps;
                sums[i] += row.values[e] * x[row.columns[e]];
            }
            CHECK(in_runs == all);
            CHECK(n_runs == n_gaps);
            CHECK(found == in_set);
        }
        CHECK(product(M, x) == sums);
    }
}

}  // namespace rows_test
