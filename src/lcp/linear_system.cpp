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
    std::size_t most_entries = 0, n_entries = 0;
    for (const int row : indices) most_entries += std::min<std::size_t>(row_of(M, row).size(), size);
    A.resizeNonZeros(static_cast<Eigen::Index>(most_entries) + 1);  // the last one is written to and never counted
    int* const columns_of_A = A.innerIndexPtr();
    double* const values_of_A = A.valuePtr();
    const int* const places = place.data();
    for (int k = 0; k < size; ++k) {
        const LcpRow row = row_of(M, indices[k]);
        const int* const columns = row.columns.data();
        const double* const values = row.values.data();
        for (std::size_t e = 0, n = row.size(); e < n; ++e) {  // without a branch on what may alternate
            const int column = places[columns[e]];
            columns_of_A[n_entries] = column;
            values_of_A[n_entries] = values[e];
            n_entries += column >= 0 ? 1 : 0;
        }
        A.outerIndexPtr()[k + 1] = static_cast<int>(n_entries);
    }
    A.resizeNonZeros(static_cast<Eigen::Index>(n_entries));
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
