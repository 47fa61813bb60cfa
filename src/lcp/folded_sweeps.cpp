#include "lcp/folded_sweeps.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

/// Row i of M x + q, and its entry in the column `other`.
double row_value(const FoldedLcp& problem, int i, const Eigen::VectorXd& x, int other, double& entry) {
    const LcpMatrix& M = problem.M;
    const int begin = M.outerIndexPtr()[i], size = M.outerIndexPtr()[i + 1] - begin;
    const int* columns = M.innerIndexPtr() + begin;
    const double* values = M.valuePtr() + begin;
    if (size > 0 && columns[size - 1] - columns[0] == size - 1) {  // without gaps, as in a dense matrix
        if (const int place = other - columns[0]; place >= 0 && place < size) entry = values[place];
        return problem.q[i] + Eigen::Map<const Eigen::VectorXd>(values, size).dot(x.segment(columns[0], size));
    }
    double sum = problem.q[i];
    for (int e = 0; e < size; ++e) {
        sum += values[e] * x[columns[e]];
        if (columns[e] == other) entry = values[e];
    }
    return sum;
}

/// Moves x_i, whose row has the value F, to the zero of its row within its bounds. Returns the step.
double relax(const FoldedLcp& problem, int i, double F, double diagonal, Eigen::VectorXd& x) {
    const double b = problem.upper(i, x), before = x[i];
    x[i] = std::clamp(before - F / diagonal, problem.lower(i, b), b);
    return x[i] - before;
}

}  // namespace

bool has_positive_diagonal(const FoldedLcp& problem) {
    for (int i = 0; i < problem.size(); ++i)
        if (!(problem.M.coeff(i, i) > 0)) return false;
    return true;
}

double sweep(const FoldedLcp& problem, Eigen::VectorXd& x, int n_sweeps) {
    struct Feeding {
        int unknown;
        double F, coupling;  // coupling: of its row to the unknown it feeds
    };
    std::vector<Feeding> feeding;
    double largest = 0;
    for (int count = 0; count < n_sweeps; ++count) {
        largest = 0;
        for (int i = 0; i < problem.size(); ++i) {
            if (problem.unknowns[i].feeds >= 0) continue;  // moves together with the one it feeds
            feeding.clear();
            double diagonal = 1;
            double F = row_value(problem, i, x, i, diagonal);
            for (const int t : problem.fed_by[i]) {
                Feeding& one = feeding.emplace_back(Feeding{t, 0, 0});
                one.F = row_value(problem, t, x, i, one.coupling);
                F += problem.unknowns[t].feed_factor * std::abs(one.F);
            }
            const double step = relax(problem, i, F, diagonal, x);
            largest = std::max(largest, std::abs(step) * diagonal);
            for (const Feeding& one : feeding) {
                const int t = one.unknown;
                const double own = problem.M.coeff(t, t);
                double unused = 0;
                const double F_t = feeding.size() == 1 ? one.F + one.coupling * step : row_value(problem, t, x, t, unused);
                largest = std::max(largest, std::abs(relax(problem, t, F_t, own, x)) * own);
            }
        }
    }
    return largest;
}

}  // namespace knap
