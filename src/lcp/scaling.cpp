#include "lcp/scaling.hpp"

#include "base/vec.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace knap {
namespace {

constexpr int max_scaling_sweeps = 30;  // each takes the square root of the remaining factor
constexpr double near_one = 1.5;        // largest entries between its inverse and itself are accepted

/// The largest |entry| of D M D in each row or column of that number; 0 where there is none.
Eigen::VectorXd largest_entries(const LcpMatrix& M, const Eigen::VectorXd& factor) {
    Eigen::VectorXd largest = Eigen::VectorXd::Zero(M.rows());
    for (int i = 0; i < M.outerSize(); ++i)
        for (LcpMatrix::InnerIterator entry(M, i); entry; ++entry) {
            const double size = std::abs(entry.value()) * factor[i] * factor[entry.col()];
            largest[i] = std::max(largest[i], size);
            largest[entry.col()] = std::max(largest[entry.col()], size);
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

/// The factors of rows without a diagonal entry, which are 0 at first: they start from their couplings to rows of known
/// factor, so that other units give the same scaled problem, and are balanced with their largest entries. Rows that no
/// coupling joins to a diagonal (the slip of a point whose two sides are prescribed, and its bound) start from their q.
void scale_bounds(const LcpProblem& problem, const Eigen::VectorXd& diagonal, Eigen::VectorXd& factor) {
    const LcpMatrix& M = problem.M;
    LcpMatrix of_bounds = M;  // their entries, in rows and columns
    of_bounds.prune([&](int row, int column, double) { return diagonal[row] == 0 || diagonal[column] == 0; });
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
        const Eigen::VectorXd largest = largest_entries(of_bounds, factor);
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
    const Eigen::VectorXd largest = largest_entries(M, factor);
    for (int i = 0; i < M.rows(); ++i)
        if (largest[i] > near_one) factor[i] /= std::sqrt(largest[i]);
    return factor.unaryExpr(&power_of_two);
}

}  // namespace

LcpScaling equilibrate(LcpProblem& problem) {
    LcpScaling scaling{.factor = factors(problem)};
    for (int i = 0; i < problem.M.outerSize(); ++i)
        for (LcpMatrix::InnerIterator entry(problem.M, i); entry; ++entry)
            entry.valueRef() *= scaling.factor[i] * scaling.factor[entry.col()];
    problem.q.array() *= scaling.factor.array();
    const double largest = problem.size() > 0 ? problem.q.cwiseAbs().maxCoeff() : 0.0;
    if (largest > 0) scaling.unit = power_of_two(largest);
    problem.q /= scaling.unit;
    return scaling;
}

double natural_residual(const LcpProblem& problem, const Eigen::VectorXd& z) {
    if (z.size() != problem.q.size() || !z.allFinite()) return infinity;
    if (problem.size() == 0) return 0;
    return (problem.M * z + problem.q).cwiseMin(z).cwiseAbs().maxCoeff();
}

double scaled_residual(const LcpProblem& problem, const Eigen::VectorXd& z) {
    if (z.size() != problem.q.size()) return infinity;
    LcpProblem scaled = problem;
    return natural_residual(scaled, equilibrate(scaled).scaled_z(z));
}

}  // namespace knap
