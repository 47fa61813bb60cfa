#include "lcp/lemke.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <vector>

namespace knap {
namespace {

constexpr double pivot_tolerance = 1e-11;  // of the largest entry of the entering column
constexpr double tie_tolerance = 1e-12;
constexpr int most_pivots = 50;  // per unknown
constexpr int n_attempts = 30;   // from a ray another covering vector often leads to a solution
constexpr double golden_ratio = 0.6180339887498949;

/// [ w | z | z0 | right-hand side ], one row a basic variable; variable i + n is z_i, 2n is z0.
class Tableau {
public:
    Tableau(const Eigen::MatrixXd& M, const Eigen::VectorXd& q, const Eigen::VectorXd& cover)
        : n_(static_cast<int>(q.size())), rows_(n_, 2 * n_ + 2), basic_(n_) {
        rows_.leftCols(n_).setIdentity();
        rows_.middleCols(n_, n_) = -M;
        rows_.col(2 * n_) = -cover;
        rows_.col(2 * n_ + 1) = q;
        for (int i = 0; i < n_; ++i) basic_[i] = i;
    }

    int z0() const { return 2 * n_; }
    int complement(int variable) const { return variable < n_ ? variable + n_ : variable - n_; }
    const std::vector<int>& basic() const { return basic_; }
    double value(int row) const { return rows_(row, 2 * n_ + 1); }

    /// The row that limits the entering variable first, or -1: none does.
    int leaving_row(int entering) const {
        const double least = pivot_tolerance * std::max(1.0, rows_.col(entering).cwiseAbs().maxCoeff());
        int best = -1;
        for (int i = 0; i < n_; ++i)
            if (rows_(i, entering) > least && (best < 0 || comes_before(i, best, entering))) best = i;
        return best;
    }

    /// Where z0 enters, so large that nothing stays negative.
    int first_row() const {
        int row = 0;
        for (int i = 1; i < n_; ++i)
            if (value(i) / rows_(i, z0()) > value(row) / rows_(row, z0())) row = i;
        return row;
    }

    int pivot(int row, int entering) {
        rows_.row(row) /= rows_(row, entering);
        for (int i = 0; i < n_; ++i)
            if (i != row && rows_(i, entering) != 0) rows_.row(i) -= rows_(i, entering) * rows_.row(row);
        const int left = basic_[row];
        basic_[row] = entering;
        return left;
    }

private:
    /// Lexicographic ratio test over the right-hand side and then the columns of the inverse basis; z0 leaves whenever it can.
    bool comes_before(int a, int b, int entering) const {
        const double pa = rows_(a, entering), pb = rows_(b, entering);
        const double difference = value(a) / pa - value(b) / pb;
        if (std::abs(difference) > tie_tolerance) return difference < 0;
        if (basic_[a] == z0() || basic_[b] == z0()) return basic_[a] == z0();
        for (int k = 0; k < n_; ++k) {
            const double next = rows_(a, k) / pa - rows_(b, k) / pb;
            if (std::abs(next) > tie_tolerance) return next < 0;
        }
        return false;
    }

    int n_;
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows_;
    std::vector<int> basic_;
};

/// z of the basis that the pivots found, from M and q themselves: without the rounding of the pivots.
Eigen::VectorXd solved_anew(const Eigen::MatrixXd& M, const Eigen::VectorXd& q, const std::vector<int>& basic) {
    const int n = static_cast<int>(q.size());
    std::vector<int> active;
    for (const int variable : basic)
        if (variable >= n && variable < 2 * n) active.push_back(variable - n);
    Eigen::VectorXd z = Eigen::VectorXd::Zero(n);
    if (active.empty()) return z;
    const Eigen::MatrixXd A = M(active, active);
    z(active) = A.fullPivLu().solve(-q(active));
    return z;
}

double residual(const Eigen::MatrixXd& M, const Eigen::VectorXd& q, const Eigen::VectorXd& z) {
    return (M * z + q).cwiseMin(z).cwiseAbs().maxCoeff();
}

/// Covering vector of an attempt: ones, then other numbers of the same order.
Eigen::VectorXd covering_vector(int n, int attempt) {
    Eigen::VectorXd cover(n);
    for (int i = 0; i < n; ++i) cover[i] = 1 + std::fmod(golden_ratio * attempt * (i + 1), 1.0);
    return cover;
}

/// z, or empty where the pivots end on a ray.
Eigen::VectorXd follow_path(const Eigen::MatrixXd& M, const Eigen::VectorXd& q, const Eigen::VectorXd& cover) {
    const int n = static_cast<int>(q.size());
    Tableau tableau(M, q, cover);
    int entering = tableau.complement(tableau.pivot(tableau.first_row(), tableau.z0()));
    for (int count = 0; count < most_pivots * n; ++count) {
        const int row = tableau.leaving_row(entering);
        if (row < 0) return {};
        const int left = tableau.pivot(row, entering);
        if (left == tableau.z0()) {
            Eigen::VectorXd z = Eigen::VectorXd::Zero(n);
            for (int i = 0; i < n; ++i)
                if (tableau.basic()[i] >= n) z[tableau.basic()[i] - n] = std::max(0.0, tableau.value(i));
            const Eigen::VectorXd anew = solved_anew(M, q, tableau.basic());
            return residual(M, q, anew) < residual(M, q, z) ? anew : z;
        }
        entering = tableau.complement(left);
    }
    return {};
}

}  // namespace

Eigen::VectorXd solve_lcp_by_lemke(const Eigen::MatrixXd& M, const Eigen::VectorXd& q) {
    const int n = static_cast<int>(q.size());
    if (n == 0 || q.minCoeff() >= 0) return Eigen::VectorXd::Zero(n);
    for (int attempt = 0; attempt < n_attempts; ++attempt) {
        const Eigen::VectorXd z = follow_path(M, q, covering_vector(n, attempt));
        if (z.size() == n) return z;
    }
    return {};
}

}  // namespace knap
