#include "lcp/linear_system.hpp"

#include <cmath>

namespace knap {
namespace {

constexpr int small = 60;              // unknowns up to which dense always pays
constexpr double most_density = 0.08;  // of a matrix for the sparse factors to pay

bool usable(const Eigen::MatrixXd& lu) {
    for (int i = 0; i < lu.rows(); ++i)
        if (lu(i, i) == 0 || !std::isfinite(lu(i, i))) return false;
    return true;
}

}  // namespace

bool LinearSystem::factorise(const Eigen::SparseMatrix<double>& A) {
    const double n = static_cast<double>(A.rows());
    dense_ = A.rows() <= small || static_cast<double>(A.nonZeros()) > most_density * n * n;
    if (dense_) {
        if (A.rows() == 0) return true;
        dense_lu_.compute(Eigen::MatrixXd(A));
        return usable(dense_lu_.matrixLU());
    }
    sparse_lu_.compute(A);
    return sparse_lu_.info() == Eigen::Success;
}

Eigen::VectorXd LinearSystem::solve(const Eigen::VectorXd& b) const {
    if (b.size() == 0) return b;
    if (dense_) return dense_lu_.solve(b);
    return sparse_lu_.solve(b);
}

}  // namespace knap
