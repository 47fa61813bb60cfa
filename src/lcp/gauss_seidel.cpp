// Projected Gauss-Seidel on the box form (Cottle, Pang, Stone, The Linear Complementarity Problem, 5.2; Jean 1999,
// nonsmooth contact dynamics). Presolve eliminates bounds with their multipliers, so that most rows have a diagonal
// entry and no blocks are needed.
#include "lcp/presolve.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

/// Row i of M x + q, and its entry in the column `other`.
double row_value(const BoxLcp& box, int i, const Eigen::VectorXd& x, int other, double& entry) {
    const LcpRow row = row_of(box.M, i);
    const int size = static_cast<int>(row.size());
    const int* columns = row.columns.data();
    const double* values = row.values.data();
    if (size > 0 && columns[size - 1] - columns[0] == size - 1) {  // without gaps, as in a dense matrix
        if (const int place = other - columns[0]; place >= 0 && place < size) entry = values[place];
        return box.q[i] + Eigen::Map<const Eigen::VectorXd>(values, size).dot(x.segment(columns[0], size));
    }
    double sum = box.q[i];
    for (int e = 0; e < size; ++e) {
        sum += values[e] * x[columns[e]];
        if (columns[e] == other) entry = values[e];
    }
    return sum;
}

/// Moves x_i, whose row has the value F, to the zero of its row within its bounds. Returns the step.
double relax(const BoxLcp& box, int i, double F, double diagonal, Eigen::VectorXd& x) {
    const double b = box.upper(i, x), before = x[i];
    x[i] = std::clamp(before - F / diagonal, box.lower(i, b), b);
    return x[i] - before;
}

}  // namespace

double sweep(const BoxLcp& box, Eigen::VectorXd& x, int n_sweeps) {
    struct Feeding {
        int unknown;
        double F, coupling;  // of its row to the unknown that it feeds
    };
    std::vector<Feeding> feeding;
    double largest = 0;
    for (int count = 0; count < n_sweeps; ++count) {
        largest = 0;
        for (int i = 0; i < box.size(); ++i) {
            if (box.unknowns[i].feeds >= 0) continue;  // moves together with the unknown that it feeds
            feeding.clear();
            double diagonal = 1;
            double F = row_value(box, i, x, i, diagonal);
            for (const int t : box.fed_by[i]) {
                Feeding& one = feeding.emplace_back(Feeding{t, 0, 0});
                one.F = row_value(box, t, x, i, one.coupling);
                F += box.unknowns[t].feed_factor * std::abs(one.F);
            }
            const double step = relax(box, i, F, diagonal, x);
            largest = std::max(largest, std::abs(step) * diagonal);
            for (const auto& [t, F_before, coupling] : feeding) {
                const double own = box.M.coeff(t, t);
                double unused = 0;
                const double F_t = feeding.size() == 1 ? F_before + coupling * step : row_value(box, t, x, t, unused);
                largest = std::max(largest, std::abs(relax(box, t, F_t, own, x)) * own);
            }
        }
    }
    return largest;
}

}  // namespace knap
