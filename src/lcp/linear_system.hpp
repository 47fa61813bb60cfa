#pragma once
// Square linear systems of the solvers, with dense or sparse factors, whichever is cheaper.
#include "lcp/problem.hpp"

#include <Eigen/LU>
#include <Eigen/SparseLU>

#include <vector>

namespace knap {

/// Rows and columns of M with these indices, which are ascending.
LcpMatrix submatrix(const LcpMatrix& M, const std::vector<int>& indices);

class LinearSystem {
public:
    /// Factors of A + diag(added). False where a pivot is zero or not finite; then `solve` must not be called.
    bool factorise(const LcpMatrix& A, const Eigen::VectorXd& added);
    Eigen::VectorXd solve(const Eigen::VectorXd& b) const;

private:
    bool is_dense_ = true;
    Eigen::PartialPivLU<Eigen::MatrixXd> dense_lu_;
    Eigen::SparseLU<Eigen::SparseMatrix<double>> sparse_lu_;
};

}  // namespace knap
