#include "stepper/implicit/gmres.hpp"

#include <cmath>

namespace knap {

bool Gmres::solve(const Product& product, const Eigen::Ref<const Eigen::VectorXd>& b, int max_steps, double tolerance) {
    const double norm = b.norm();
    const Eigen::Index n = n_ = b.size();
    if (V_.rows() < n || V_.cols() < max_steps + 1) {
        V_.resize(2 * n, max_steps + 1), next_.resize(2 * n), x_.resize(2 * n);
        rotations_.reserve(max_steps);
    }
    auto V = V_.topRows(n);
    auto next = next_.head(n), x = x_.head(n);
    x.setZero();
    if (norm == 0) return true;
    // Arnoldi: A V_k = V_k+1 H. Rotations keep H upper triangular; the last entry of g is the norm of the residual.
    H_.setZero(max_steps + 1, max_steps);
    g_.setZero(max_steps + 1);
    rotations_.clear();
    V.col(0) = b / norm;
    g_[0] = norm;
    for (int k = 0; k < max_steps; ++k) {
        product(V.col(k), next);
        for (int twice = 0; twice < 2; ++twice)  // a second pass restores orthogonality to rounding
            for (int i = 0; i <= k; ++i) {
                const double along = V.col(i).dot(next);
                H_(i, k) += along;
                next -= along * V.col(i);
            }
        H_(k + 1, k) = next.norm();
        if (H_(k + 1, k) > 0) V.col(k + 1) = next / H_(k + 1, k);
        for (int i = 0; i < k; ++i) H_.col(k).applyOnTheLeft(i, i + 1, rotations_[i].adjoint());
        rotations_.emplace_back().makeGivens(H_(k, k), H_(k + 1, k));
        H_.col(k).applyOnTheLeft(k, k + 1, rotations_[k].adjoint());
        g_.applyOnTheLeft(k, k + 1, rotations_[k].adjoint());
        if (!g_.allFinite() || H_(k, k) == 0) return false;
        if (std::abs(g_[k + 1]) > tolerance * norm) continue;
        auto y = g_.head(k + 1);
        H_.topLeftCorner(k + 1, k + 1).triangularView<Eigen::Upper>().solveInPlace(y);
        x.noalias() = V.leftCols(k + 1) * y;
        return true;
    }
    return false;
}

}  // namespace knap
