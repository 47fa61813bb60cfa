#include "stepper/gmres.hpp"

#include <Eigen/Jacobi>

#include <vector>

namespace knap {

std::optional<Eigen::VectorXd> gmres(const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& product, const Eigen::VectorXd& b,
                                     int most_steps, double tolerance) {
    const double norm = b.norm();
    if (norm == 0) return b;
    // A V_k = V_k+1 H; rotations make H upper triangular as it grows, and |residual| is the last entry of g
    Eigen::MatrixXd V(b.size(), most_steps + 1), H = Eigen::MatrixXd::Zero(most_steps + 1, most_steps);
    Eigen::VectorXd g = Eigen::VectorXd::Zero(most_steps + 1);
    std::vector<Eigen::JacobiRotation<double>> rotations;
    V.col(0) = b / norm;
    g[0] = norm;
    for (int k = 0; k < most_steps; ++k) {
        Eigen::VectorXd next = product(V.col(k));
        for (int twice = 0; twice < 2; ++twice)  // once is not orthogonal to rounding
            for (int i = 0; i <= k; ++i) {
                const double along = V.col(i).dot(next);
                H(i, k) += along;
                next -= along * V.col(i);
            }
        H(k + 1, k) = next.norm();
        if (H(k + 1, k) > 0) V.col(k + 1) = next / H(k + 1, k);
        for (int i = 0; i < k; ++i) H.col(k).applyOnTheLeft(i, i + 1, rotations[i].adjoint());
        rotations.emplace_back().makeGivens(H(k, k), H(k + 1, k));
        H.col(k).applyOnTheLeft(k, k + 1, rotations[k].adjoint());
        g.applyOnTheLeft(k, k + 1, rotations[k].adjoint());
        if (!g.allFinite() || H(k, k) == 0) return std::nullopt;
        if (std::abs(g[k + 1]) > tolerance * norm) continue;
        return Eigen::VectorXd(V.leftCols(k + 1) * H.topLeftCorner(k + 1, k + 1).triangularView<Eigen::Upper>().solve(g.head(k + 1)));
    }
    return std::nullopt;
}

}  // namespace knap
