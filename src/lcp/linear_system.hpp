#pragma once
// Square systems of the solvers, dense or sparse as it pays.
#include <Eigen/LU>
#include <Eigen/SparseLU>

namespace knap {

class LinearSystem {
public:
    /// False where a pivot is zero or not finite; then there is nothing to solve with.
    bool factorise(const Eigen::SparseMatrix<double>& A);
    Eigen::VectorXd solve(const Eigen::VectorXd& b) const;

private:
    bool dense_ = true;
    Eigen::PartialPivLU<Eigen::MatrixXd> dense_lu_;
    Eigen::SparseLU<Eigen::SparseMatrix<double>> sparse_lu_;
};

}  // namespace knap
