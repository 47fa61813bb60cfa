#include "lcp/linear_system.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace knap {
namespace {

constexpr int small = 60;             // unknowns up to which dense factors always pay
constexpr double max_density = 0.08;  // of a matrix whose sparse factors pay

}  // namespace

LcpMatrix submatrix(const LcpMatrix& M, const std::vector<int>& indices) {
    assert(std::ranges::is_sorted(indices));
    const int size = static_cast<int>(indices.size());
    std::vector<int> place(M.cols(), -1);
    for (int k = 0; k < size; ++k) place[indices[k]] = k;
    LcpMatrix A(size, size);
    A.reserve(M.nonZeros());
    for (int k = 0; k < size; ++k) {
        A.startVec(k);
        const auto [columns, values] = row_of(M, indices[k]);
        for (std::size_t e = 0; e < columns.size(); ++e)
            if (place[columns[e]] >= 0) A.insertBack(k, place[columns[e]]) = values[e];
    }
    A.finalize();
    return A;
}

bool LinearSystem::factorise(const LcpMatrix& matrix, const Eigen::VectorXd& added) {
    Eigen::SparseMatrix<double> A = matrix, diagonal(A.rows(), A.cols());
    diagonal.setIdentity();
    diagonal.diagonal() = added;
    A += diagonal;
    const double n = static_cast<double>(A.rows());
    is_dense_ = A.rows() <= small || static_cast<double>(A.nonZeros()) > max_density * n * n;
    if (A.rows() == 0) return true;
    if (!A.coeffs().allFinite()) return false;
    if (is_dense_) {
        dense_lu_.compute(Eigen::MatrixXd(A));
        const Eigen::ArrayXd pivots = dense_lu_.matrixLU().diagonal();
        return pivots.allFinite() && (pivots != 0).all();
    }
    sparse_lu_.compute(A);
    return sparse_lu_.info() == Eigen::Success;
}

Eigen::VectorXd LinearSystem::solve(const Eigen::VectorXd& b) const {
    if (b.size() == 0) return b;
    if (is_dense_) return dense_lu_.solve(b);
    return sparse_lu_.solve(b);
}

}  // namespace knap
