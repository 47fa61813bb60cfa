#include "lcp/folded_sweeps.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

double row_value(const FoldedLcp& problem, int i, const Eigen::VectorXd& x, double& diagonal) {
    double sum = problem.q[i];
    for (LcpMatrix::InnerIterator entry(problem.M, i); entry; ++entry) {
        sum += entry.value() * x[entry.col()];
        if (entry.col() == i) diagonal = entry.value();
    }
    return sum;
}

}  // namespace

bool has_positive_diagonal(const FoldedLcp& problem) {
    for (int i = 0; i < problem.size(); ++i)
        if (!(problem.M.coeff(i, i) > 0)) return false;
    return true;
}

double sweep(const FoldedLcp& problem, Eigen::VectorXd& x, int n_sweeps) {
    double largest = 0;
    for (int count = 0; count < n_sweeps; ++count) {
        largest = 0;
        for (int i = 0; i < problem.size(); ++i) {
            double diagonal = 1, unused = 0;
            double F = row_value(problem, i, x, diagonal);
            for (const int t : problem.fed_by[i]) F += problem.unknowns[t].feed_factor * std::abs(row_value(problem, t, x, unused));
            const double b = problem.upper(i, x), next = std::clamp(x[i] - F / diagonal, problem.lower(i, b), b);
            largest = std::max(largest, std::abs(next - x[i]) * diagonal);
            x[i] = next;
        }
    }
    return largest;
}

}  // namespace knap
