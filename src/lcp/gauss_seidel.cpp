// Projected Gauss-Seidel on the box form (Cottle, Pang, Stone, The Linear Complementarity Problem, 5.2; Jean 1999,
// nonsmooth contact dynamics). Presolve eliminates bounds with their multipliers, so that most rows have a diagonal
// entry and no blocks are needed.
#include "lcp/presolve.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace knap {
namespace {

bool is_without_gaps(const LcpRow& row) {  // as in a dense matrix
    return row.size() > 0 && row.columns.back() - row.columns.front() == static_cast<int>(row.size()) - 1;
}

/// q_i + the sum of the entries from `first` on, which is `sum` so far.
double continued(double sum, const LcpRow& row, std::size_t first, const double* x) {
    for (std::size_t e = first; e < row.size(); ++e) sum += row.values[e] * x[row.columns[e]];
    return sum;
}

/// Row i of M x + q.
double row_value(const BoxLcp& box, int i, const Eigen::VectorXd& x) {
    const LcpRow row = row_of(box.M, i);
    if (!is_without_gaps(row)) return continued(box.q[i], row, 0, x.data());
    const auto size = static_cast<Eigen::Index>(row.size());
    return box.q[i] + Eigen::Map<const Eigen::VectorXd>(row.values.data(), size).dot(x.segment(row.columns[0], size));
}

/// Rows i and j of M x + q: the two sums do not wait for each other.
std::pair<double, double> row_values(const BoxLcp& box, int i, int j, const Eigen::VectorXd& x) {
    const LcpRow a = row_of(box.M, i), b = row_of(box.M, j);
    if (is_without_gaps(a) || is_without_gaps(b)) return {row_value(box, i, x), row_value(box, j, x)};
    const std::size_t shared = std::min(a.size(), b.size());
    const double* const values = x.data();
    double of_a = box.q[i], of_b = box.q[j];
    for (std::size_t e = 0; e < shared; ++e) {
        of_a += a.values[e] * values[a.columns[e]];
        of_b += b.values[e] * values[b.columns[e]];
    }
    return {continued(of_a, a, shared, values), continued(of_b, b, shared, values)};
}

/// Moves x_i, whose row has the value F, to the zero of its row within its bounds. Returns the step.
double relax(const BoxLcp& box, int i, double F, double diagonal, Eigen::VectorXd& x) {
    const double b = box.upper(i, x), before = x[i];
    x[i] = std::clamp(before - F / diagonal, box.lower(i, b), b);
    return x[i] - before;
}

}  // namespace

Sweeps::Sweeps(const BoxLcp& box) : box_(box), diagonal_(box.M.diagonal()), coupling_(box.size()) {
    for (int t = 0; t < box.size(); ++t)
        coupling_[t] = box.unknowns[t].feeds >= 0 ? box.M.coeff(t, box.unknowns[t].feeds) : 0;
}

double Sweeps::run_once(Eigen::VectorXd& x) const {
    double largest = 0;
    const auto move = [&](int i, double F) {
        const double step = relax(box_, i, F, diagonal_[i], x);
        largest = std::max(largest, std::abs(step) * diagonal_[i]);
        return step;
    };
    for (int i = 0; i < box_.size(); ++i) {
        if (box_.unknowns[i].feeds >= 0) continue;  // moves together with the unknown that it feeds
        const std::vector<int>& fed_by = box_.fed_by[i];
        if (fed_by.size() == 1) {
            const int t = fed_by[0];
            const auto [F, F_t] = row_values(box_, i, t, x);
            const double step = move(i, F + box_.unknowns[t].feed_factor * std::abs(F_t));
            move(t, F_t + coupling_[t] * step);
            continue;
        }
        double F = row_value(box_, i, x);
        for (const int t : fed_by) F += box_.unknowns[t].feed_factor * std::abs(row_value(box_, t, x));
        move(i, F);
        for (const int t : fed_by) move(t, row_value(box_, t, x));
    }
    return largest;
}

}  // namespace knap
