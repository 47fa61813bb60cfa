#include "lcp/scaling.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr int n_sweeps = 12;  // each takes the square root of what is left: 12 bring any range of a double to order one

/// One sweep of Ruiz: factors that bring the largest entry of each row and column towards one.
Eigen::VectorXd sweep_factors(const LcpMatrix& M) {
    Eigen::VectorXd largest = Eigen::VectorXd::Zero(M.rows());
    for (int i = 0; i < M.outerSize(); ++i)
        for (LcpMatrix::InnerIterator entry(M, i); entry; ++entry) {
            const double size = std::abs(entry.value());
            largest[i] = std::max(largest[i], size);
            largest[entry.col()] = std::max(largest[entry.col()], size);
        }
    return largest.unaryExpr([](double size) { return size > 0 ? 1 / std::sqrt(size) : 1.0; });
}

}  // namespace

ScaledLcp equilibrated(const LcpProblem& problem) {
    ScaledLcp scaled{.problem = problem, .factor = Eigen::VectorXd::Ones(problem.size()), .unit = 1};
    LcpMatrix& M = scaled.problem.M;
    for (int sweep = 0; sweep < n_sweeps; ++sweep) {
        const Eigen::VectorXd factor = sweep_factors(M);
        M = factor.asDiagonal() * M * factor.asDiagonal();
        scaled.factor = scaled.factor.cwiseProduct(factor);
    }
    scaled.problem.q = scaled.factor.cwiseProduct(problem.q);
    const double largest = problem.size() > 0 ? scaled.problem.q.cwiseAbs().maxCoeff() : 0.0;
    if (largest > 0) scaled.unit = largest;
    scaled.problem.q /= scaled.unit;
    return scaled;
}

}  // namespace knap
