// Lemke's pivots on a condensed tableau of n (n + 2) numbers (C. E. Lemke 1965; Cottle, Pang, Stone, The Linear
// Complementarity Problem, 4.4 and 4.9). Ties are broken lexicographically, so it cannot cycle. Two tolerances make it
// reliable on degenerate and redundant problems: a pivot must not be small compared with its column, and ratios closer
// than rounding are a tie. Where the path ends on a ray, paths from other covering vectors are tried. The reference
// solver: dense; a path of k pivots costs k^2 n / 2 operations, and k is about n / 2 here.
#include "base/vec.hpp"
#include "lcp/scaling.hpp"
#include "lcp/solvers.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace knap {
namespace {

using MatrixIn = Eigen::Ref<const Eigen::MatrixXd>;
using VectorIn = Eigen::Ref<const Eigen::VectorXd>;
constexpr double golden_ratio = 0.6180339887498949;
constexpr int max_pivots_per_unknown = 50;
constexpr int n_covering_vectors = 30, n_covering_vectors_of_quick_search = 3;
constexpr int few = 96;  // unknowns whose tableau is on the stack, 75 kB twice: explicit steps allocate nothing

/// basic + T nonbasic = value. Variable i is w_i, i + n is z_i, 2n is z0. Only the columns of the nonbasic variables
/// are stored, and a pivot is only recorded: a column goes through the pivots that it missed when it is read. A path of
/// k pivots reads k columns and the value, so it costs k^2 n / 2 operations where immediate pivots take k n^2.
/// Arrays are on the stack for up to `max` unknowns, or on the heap where `max` is Eigen::Dynamic.
template <int max>
class Tableau {
public:
    static constexpr int max_columns = max == Eigen::Dynamic ? max : max + 2;
    static constexpr int max_variables = max == Eigen::Dynamic ? max : 2 * max + 1;
    using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, max>;
    using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, max, max_columns>;
    using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, max, max>;
    using List = Eigen::Array<int, Eigen::Dynamic, 1, 0, max_variables>;

    struct Path {
        LcpStatus status;
        Vector z;
        int n_pivots;
    };

    Tableau(const MatrixIn& M, const VectorIn& q)
        : M_(M), q_(q), n_(static_cast<int>(q.size())), columns_(n_, n_ + 2), pivot_columns_(n_, n_) {}

    /// Path of a problem with stiff rows, whose ratios are small and close together: those of large entries are a tie
    /// within the rounding of their values only, except in every other path. The most accurate solution of the paths.
    Path path_through_stiff_rows(int n_paths) {
        Path best{LcpStatus::ray, Vector::Zero(n_), 0};
        double smallest = infinity;
        if (n_ == 0 || q_.minCoeff() >= 0) smallest = 0, best.status = LcpStatus::solved;
        for (int attempt = 0; attempt < n_paths && smallest > max_residual; ++attempt) {
            ties_of_values_ = attempt % 2 == 0;
            const Path path = follow_path(attempt, infinity);
            if (path.status != LcpStatus::solved) continue;
            if (const double found = residual(path.z); found < smallest) smallest = found, best = path;
        }
        return best;
    }

    /// One path after the other, until one ends at a solution. M and q are of order one. A solution whose residual is
    /// above `accepted` has lost too much to rounding: its status is `stalled`.
    Path first_path_to_solution(int n_paths, double accepted) {
        Path path{LcpStatus::ray, Vector::Zero(n_), 0};
        if (n_ == 0 || q_.minCoeff() >= 0) path.status = LcpStatus::solved;
        for (int attempt = 0; attempt < n_paths && path.status != LcpStatus::solved; ++attempt) {
            const Path next = follow_path(attempt, accepted);
            path = {next.status, next.z.size() == n_ ? next.z : path.z, path.n_pivots + next.n_pivots};
        }
        return path;
    }

private:
    using Column = Eigen::Ref<Eigen::VectorXd>;

    Path follow_path(int attempt, double accepted) {
        start(attempt);
        int entering = complement(pivot(first_row(), z0()));
        for (int count = 1; count <= max_pivots_per_unknown * n_; ++count) {
            const int row = leaving_row(entering);
            if (row < 0) return {LcpStatus::ray, {}, count};
            const int left = pivot(row, entering);
            entering = complement(left);
            if (left != z0()) continue;
            Vector z = Vector::Zero(n_);
            for (int i = 0; i < n_; ++i)
                if (basic_[i] >= n_) z[basic_[i] - n_] = std::max(0.0, value(i));
            const Vector refined = refined_solution();
            const double before = residual(z), after = residual(refined);
            const LcpStatus status = std::min(before, after) <= accepted ? LcpStatus::solved : LcpStatus::stalled;
            return {status, after < before ? refined : z, count};
        }
        return {LcpStatus::iteration_limit, {}, max_pivots_per_unknown * n_};
    }

    /// With a covering vector of ones, then of other numbers of the same order.
    void start(int attempt) {
        columns_.leftCols(n_) = -M_;
        for (int i = 0; i < n_; ++i) columns_(i, n_) = -(1 + std::fmod(golden_ratio * attempt * (i + 1), 1.0));
        columns_.col(n_ + 1) = q_;
        basic_ = List::LinSpaced(n_, 0, n_ - 1);
        place_.resize(2 * n_ + 1);
        for (int i = 0; i < n_; ++i) place_[i] = -1 - i;
        for (int k = 0; k <= n_; ++k) place_[n_ + k] = k;
        n_pivots_ = 0;
        pivot_rows_.resize(n_);
        n_done_ = List::Zero(n_ + 2);
    }

    int z0() const { return 2 * n_; }
    int complement(int variable) const { return variable < n_ ? variable + n_ : variable - n_; }
    double value(int row) { return column(n_ + 1)[row]; }

    /// Where z0 enters, so large that nothing stays negative.
    int first_row() {
        const auto cover = column(place_[z0()]), value = column(n_ + 1);
        int row = 0;
        for (int i = 1; i < n_; ++i)
            if (value[i] / cover[i] > value[row] / cover[row]) row = i;
        return row;
    }

    /// The row that limits the entering variable first, or -1 where none does.
    int leaving_row(int entering) {
        const auto entries = column(place_[entering]);
        const double smallest = pivot_tolerance * std::max(1.0, entries.cwiseAbs().maxCoeff());
        int best = -1;
        for (int i = 0; i < n_; ++i)
            if (entries[i] > smallest && (best < 0 || comes_before(i, best, entries))) best = i;
        return best;
    }

    /// Exchanges the entering variable and the basic one of the row, which is returned.
    int pivot(int row, int entering) {
        const int place = place_[entering], leaving = basic_[row];
        if (n_pivots_ == n_) carry_out_pivots();
        auto entries = column(place);
        pivot_columns_.col(n_pivots_) = entries;
        pivot_rows_[n_pivots_++] = row;
        const double inverse = 1 / entries[row];
        entries *= -inverse;
        entries[row] = inverse;
        n_done_[place] = n_pivots_;
        basic_[row] = entering;
        place_[entering] = -1 - row;
        place_[leaving] = place;
        return leaving;
    }

    /// The column with all pivots carried out.
    Column column(int place) {
        auto entries = columns_.col(place);
        for (int& k = n_done_[place]; k < n_pivots_; ++k) {
            const int row = pivot_rows_[k];
            const double at_row = entries[row] / pivot_columns_(row, k);
            if (at_row == 0) continue;
            entries -= at_row * pivot_columns_.col(k);
            entries[row] = at_row;
        }
        return entries;
    }

    void carry_out_pivots() {
        for (int place = 0; place < n_ + 2; ++place) column(place);
        n_pivots_ = 0;
        n_done_.setZero();
    }

    /// Lexicographic ratio test over the right-hand side and then the columns of the inverse basis; z0 leaves whenever
    /// it can.
    bool comes_before(int a, int b, const Column& entering) {
        const auto value = column(n_ + 1);
        const double difference = value[a] / entering[a] - value[b] / entering[b];
        const double large = ties_of_values_ ? std::max(1.0, std::min(entering[a], entering[b])) : 1;
        if (std::abs(difference) > relative_tolerance / large) return difference < 0;
        if (basic_[a] == z0() || basic_[b] == z0()) return basic_[a] == z0();
        for (int k = 0; k < n_; ++k) {
            const double next = of_inverse(a, k) / entering[a] - of_inverse(b, k) / entering[b];
            if (std::abs(next) > relative_tolerance / large) return next < 0;
        }
        return false;
    }

    /// Entry of the inverse basis: the column of w_k, a unit vector where w_k is basic.
    double of_inverse(int row, int k) {
        return place_[k] >= 0 ? column(place_[k])[row] : (place_[k] == -1 - row ? 1.0 : 0.0);
    }

    /// z of the basis, from M and q themselves: without the rounding of the pivots.
    Vector refined_solution() const {
        List active(n_);
        int n_active = 0;
        for (const int variable : basic_)
            if (variable >= n_ && variable < 2 * n_) active[n_active++] = variable - n_;
        active.conservativeResize(n_active);
        Vector z = Vector::Zero(n_);
        if (n_active == 0) return z;
        const Square A = M_(active, active);
        const Vector b = -q_(active);
        const Eigen::PartialPivLU<Square> lu(A);
        Vector x = lu.solve(b);
        const Vector left = b - A * x;
        x += lu.solve(left);
        z(active) = x;
        return z;
    }

    double residual(const Vector& z) const {
        if (!z.allFinite()) return infinity;
        Vector w = M_ * z;
        w += q_;
        return w.cwiseMin(z).cwiseAbs().maxCoeff();
    }

    const MatrixIn& M_;
    const VectorIn& q_;
    int n_;
    bool ties_of_values_ = false;
    Matrix columns_;  // of the nonbasic variables, then the value
    List basic_;
    List place_;            // column of a nonbasic variable; -1 - row of a basic one
    int n_pivots_ = 0;      // recorded
    List pivot_rows_;       // of the recorded pivots
    Matrix pivot_columns_;  // their entering columns
    List n_done_;           // pivots that each column has gone through
};

}  // namespace

LcpSolution solve_by_lemke(const LcpProblem& problem, const LcpOptions& options) {
    LcpProblem scaled = problem;
    const LcpScaling scaling = equilibrate(scaled);
    const Eigen::MatrixXd dense(scaled.M);
    const MatrixIn M(dense);
    const VectorIn q(scaled.q);
    const int n_paths = options.exhaustive ? n_covering_vectors : n_covering_vectors_of_quick_search;
    const auto path = Tableau<Eigen::Dynamic>(M, q).first_path_to_solution(n_paths, max_residual);
    return lcp_solution(problem, path.status, scaling.original_z(path.z), path.n_pivots);
}

bool solve_lcp_by_lemke(const MatrixIn& M, const VectorIn& q, Eigen::Ref<Eigen::VectorXd> z, bool stiff) {
    const auto follow = [&]<int max>() {
        Tableau<max> tableau(M, q);
        const auto path = stiff ? tableau.path_through_stiff_rows(n_covering_vectors)
                                : tableau.first_path_to_solution(n_covering_vectors, infinity);
        z = path.z;
        return path.status == LcpStatus::solved;
    };
    return q.size() <= few ? follow.template operator()<few>() : follow.template operator()<Eigen::Dynamic>();
}

}  // namespace knap
