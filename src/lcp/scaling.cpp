#include "lcp/scaling.hpp"

#include "base/vec.hpp"
#include "lcp/rows.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace knap {
namespace {

constexpr int max_scaling_sweeps = 30;  // each takes the square root of the remaining factor
constexpr double near_one = 1.5;        // largest entries between its inverse and itself are accepted

/// The largest |entry| of D M D in each row or column of that number, as far as it lies above `ignored`; otherwise
/// anything from 0 to there.
Eigen::VectorXd largest_entries(const LcpMatrix& M, const Eigen::VectorXd& factor, double ignored) {
    Eigen::VectorXd largest = Eigen::VectorXd::Zero(M.rows());
    for (int i = 0; i < M.outerSize(); ++i) {
        const auto [columns, values] = row_of(M, i);
        double largest_of_row = 0;
        for_each_run({columns, values}, [&](int first, int length) {
            const auto sizes = RowValues(values.data() + first, length).abs() * factor[i] *
                               factor.array().segment(columns[first], length);
            largest_of_row = std::max(largest_of_row, sizes.maxCoeff());
        });
        if (largest_of_row <= ignored) continue;
        for (std::size_t e = 0; e < columns.size(); ++e) {
            const double size = std::abs(values[e]) * factor[i] * factor[columns[e]];
            if (size > largest[columns[e]]) largest[columns[e]] = size;
        }
        largest[i] = std::max(largest[i], largest_of_row);
    }
    return largest;
}

/// The power of two nearest in ratio to x > 0.
double power_of_two(double x) {
    int exponent;
    const double mantissa = std::frexp(x, &exponent);  // 1/2 <= mantissa < 1
    return std::ldexp(1.0, mantissa < std::numbers::sqrt2 / 2 ? exponent - 1 : exponent);
}

/// Factors of rows without one (0) from their couplings to rows that have one, in turns.
void follow_couplings(const LcpMatrix& M, Eigen::VectorXd& factor) {
    for (bool changed = true; changed;) {
        Eigen::VectorXd coupling = Eigen::VectorXd::Zero(M.rows());
        for (int i = 0; i < M.outerSize(); ++i)
            for (LcpMatrix::InnerIterator entry(M, i); entry; ++entry) {
                const auto j = entry.col();
                coupling[i] = std::max(coupling[i], std::abs(entry.value()) * factor[j]);
                coupling[j] = std::max(coupling[j], std::abs(entry.value()) * factor[i]);
            }
        changed = false;
        for (int i = 0; i < M.rows(); ++i)
            if (factor[i] == 0 && coupling[i] > 0) factor[i] = 1 / coupling[i], changed = true;
    }
}

/// The entries in the rows and columns without a diagonal entry; most entries of M are elsewhere, and are not copied.
LcpMatrix entries_of_bounds(const LcpMatrix& M, const Eigen::VectorXd& diagonal) {
    LcpMatrix of_bounds(M.rows(), M.cols());
    const ColumnSet bounds(static_cast<int>(M.cols()), [&](int i) { return diagonal[i] == 0; });
    for (int i = 0; i < M.outerSize(); ++i) {
        of_bounds.startVec(i);
        const LcpRow row = row_of(M, i);
        const auto insert = [&](std::size_t e) { of_bounds.insertBack(i, row.columns[e]) = row.values[e]; };
        if (diagonal[i] != 0) bounds.for_each(row, insert);
        else
            for (std::size_t e = 0; e < row.size(); ++e) insert(e);
    }
    of_bounds.finalize();
    return of_bounds;
}

/// The factors of rows without a diagonal entry, which are 0 at first: they start from their couplings to rows of known
/// factor, so that other units give the same scaled problem, and are balanced with their largest entries. Rows that no
/// coupling joins to a diagonal (the slip of a point whose two sides are prescribed, and its bound) start from their q.
void scale_bounds(const LcpProblem& problem, const Eigen::VectorXd& diagonal, Eigen::VectorXd& factor) {
    const LcpMatrix& M = problem.M;
    const LcpMatrix of_bounds = entries_of_bounds(M, diagonal);
    follow_couplings(of_bounds, factor);
    if ((factor.array() == 0).any()) {
        const double largest = problem.q.cwiseProduct(factor).cwiseAbs().maxCoeff(), unit = largest > 0 ? largest : 1;
        for (int i = 0; i < M.rows(); ++i)
            if (factor[i] == 0 && problem.q[i] != 0) factor[i] = unit / std::abs(problem.q[i]);
        follow_couplings(of_bounds, factor);
    }
    for (double& f : factor)
        if (f == 0) f = 1;
    bool changed = true;
    for (int sweep = 0; changed && sweep < max_scaling_sweeps; ++sweep) {
        const Eigen::VectorXd largest = largest_entries(of_bounds, factor, 0);
        changed = false;
        for (int i = 0; i < M.rows(); ++i) {
            if (diagonal[i] != 0 || largest[i] == 0 || (largest[i] <= near_one && largest[i] >= 1 / near_one)) continue;
            factor[i] /= std::sqrt(largest[i]);
            changed = true;
        }
    }
}

Eigen::VectorXd factors(const LcpProblem& problem) {
    const LcpMatrix& M = problem.M;
    const Eigen::VectorXd diagonal = M.diagonal();
    Eigen::VectorXd factor = diagonal.unaryExpr([](double d) { return d != 0 ? 1 / std::sqrt(std::abs(d)) : 0.0; });
    if ((diagonal.array() == 0).any()) scale_bounds(problem, diagonal, factor);
    const Eigen::VectorXd largest = largest_entries(M, factor, near_one);
    for (int i = 0; i < M.rows(); ++i)
        if (largest[i] > near_one) factor[i] /= std::sqrt(largest[i]);
    return factor.unaryExpr(&power_of_two);
}

}  // namespace

LcpScaling scaling_of(const LcpProblem& problem) {
    LcpScaling scaling{.factor = factors(problem)};
    const double largest = problem.size() > 0 ? problem.q.cwiseProduct(scaling.factor).cwiseAbs().maxCoeff() : 0.0;
    if (largest > 0) scaling.unit = power_of_two(largest);
    return scaling;
}

LcpScaling equilibrate(LcpProblem& problem) {
    LcpScaling scaling = scaling_of(problem);
    for (int i = 0; i < problem.M.outerSize(); ++i) {
        const LcpRow row = row_of(problem.M, i);
        double* values = problem.M.valuePtr() + problem.M.outerIndexPtr()[i];
        for_each_run(row, [&](int first, int length) {
            Eigen::Map<Eigen::ArrayXd>(values + first, length) *=
                scaling.factor[i] * scaling.factor.array().segment(row.columns[first], length);
        });
    }
    problem.q = scaling.scaled_w(problem.q);
    return scaling;
}

double natural_residual(const LcpProblem& problem, const Eigen::VectorXd& z) {
    if (z.size() != problem.q.size() || !z.allFinite()) return infinity;
    if (problem.size() == 0) return 0;
    return (product(problem.M, z) + problem.q).cwiseMin(z).cwiseAbs().maxCoeff();
}

double scaled_residual(const LcpScaling& scaling, const Eigen::VectorXd& z, const Eigen::VectorXd& w) {
    if (!z.allFinite()) return infinity;
    return z.size() > 0 ? scaling.scaled_w(w).cwiseMin(scaling.scaled_z(z)).cwiseAbs().maxCoeff() : 0;
}

double scaled_residual(const LcpProblem& problem, const Eigen::VectorXd& z) {
    if (z.size() != problem.q.size()) return infinity;
    return scaled_residual(scaling_of(problem), z, product(problem.M, z) + problem.q);
}

}  // namespace knap
