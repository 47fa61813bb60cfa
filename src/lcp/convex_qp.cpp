#include "lcp/convex_qp.hpp"

#include "lcp/fold.hpp"

#include <Eigen/SparseCholesky>

#include <algorithm>
#include <vector>

namespace knap {
namespace {

constexpr double proximal = 1e-10;       // beside a diagonal of one
constexpr double symmetry = 1e-12;       // of the scaled matrix
constexpr double negative = -1e-9;       // pivots below are no rounding: the problem is not convex
constexpr double sufficient = 1e-4;      // part of the fall that the slope promises
constexpr int n_halvings = 40;

bool is_box_problem(const FoldedLcp& folded) {
    for (const FoldedUnknown& u : folded.unknowns)
        if (u.bound_by >= 0 || u.feeds >= 0) return false;
    if (folded.size() == 0) return true;
    const LcpMatrix difference = folded.M - LcpMatrix(folded.M.transpose());
    return difference.nonZeros() == 0 || difference.coeffs().cwiseAbs().maxCoeff() <= symmetry;
}

class ProjectedNewton {
public:
    explicit ProjectedNewton(const FoldedLcp& folded) : folded_(folded), n_(folded.size()), lower_(n_), upper_(n_) {
        for (int i = 0; i < n_; ++i) {
            upper_[i] = folded.unknowns[i].upper;
            lower_[i] = folded.lower(i, upper_[i]);
        }
    }

    LcpStatus run(const ConvexQpOptions& options, Eigen::VectorXd& x, int& n_solves) {
        x = projected(x);
        for (int count = 0; count < options.max_iterations; ++count) {
            const Eigen::VectorXd slope = folded_.linear_part(x);
            if (folded_.natural_map(x, slope).cwiseAbs().maxCoeff() <= options.tolerance) return LcpStatus::solved;
            Eigen::VectorXd step;
            ++n_solves;
            const LcpStatus status = newton_step(x, slope, step);
            if (status != LcpStatus::solved) return status;
            if (!search(x, slope, step)) return LcpStatus::stalled;
        }
        return LcpStatus::iteration_limit;
    }

private:
    Eigen::VectorXd projected(const Eigen::VectorXd& x) const { return x.cwiseMax(lower_).cwiseMin(upper_); }

    bool held(int i, double x, double slope) const { return (x <= lower_[i] && slope >= 0) || (x >= upper_[i] && slope <= 0); }

    LcpStatus newton_step(const Eigen::VectorXd& x, const Eigen::VectorXd& slope, Eigen::VectorXd& step) {
        std::vector<int> place(n_, -1), free;
        for (int i = 0; i < n_; ++i)
            if (!held(i, x[i], slope[i])) {
                place[i] = static_cast<int>(free.size());
                free.push_back(i);
            }
        std::vector<Eigen::Triplet<double>> entries;
        Eigen::VectorXd b(free.size());
        for (const int i : free) {
            b[place[i]] = -slope[i];
            entries.emplace_back(place[i], place[i], proximal);
            for (LcpMatrix::InnerIterator entry(folded_.M, i); entry; ++entry)
                if (place[entry.col()] >= 0) entries.emplace_back(place[i], place[entry.col()], entry.value());
        }
        Eigen::SparseMatrix<double> A(b.size(), b.size());
        A.setFromTriplets(entries.begin(), entries.end());
        factors_.compute(A);
        if (factors_.info() != Eigen::Success || !factors_.vectorD().allFinite()) return LcpStatus::singular;
        if (factors_.vectorD().minCoeff() < negative) return LcpStatus::not_applicable;
        const Eigen::VectorXd solved = factors_.solve(b);
        step = Eigen::VectorXd::Zero(n_);
        for (const int i : free) step[i] = solved[place[i]];
        return step.allFinite() ? LcpStatus::solved : LcpStatus::singular;
    }

    /// Along the projected step until the objective falls enough.
    bool search(Eigen::VectorXd& x, const Eigen::VectorXd& slope, const Eigen::VectorXd& step) const {
        double length = 1;
        for (int count = 0; count < n_halvings; ++count, length *= 0.5) {
            const Eigen::VectorXd next = projected(x + length * step), change = next - x;
            const double promised = slope.dot(change), fall = promised + 0.5 * change.dot(folded_.M * change);
            const bool at_rounding = change.cwiseAbs().maxCoeff() <= 1e-9;  // where the objective says nothing any more
            if (fall > sufficient * promised && !at_rounding) continue;
            x = next;
            return !change.isZero(0);
        }
        return false;
    }

    const FoldedLcp& folded_;
    int n_;
    Eigen::VectorXd lower_, upper_;
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors_;
};

}  // namespace

LcpSolution solve_by_convex_qp(const LcpProblem& problem, const ConvexQpOptions& options) {
    const FoldedLcp folded = fold(problem);
    const bool warm = options.start.size() == problem.size();
    if (!is_box_problem(folded)) return lcp_solution(problem, LcpStatus::not_applicable, Eigen::VectorXd::Zero(problem.size()), 0);
    Eigen::VectorXd x = warm ? folded.folded(options.start) : Eigen::VectorXd::Zero(folded.size());
    int n_solves = 0;
    const LcpStatus status = folded.size() == 0 ? LcpStatus::solved : ProjectedNewton(folded).run(options, x, n_solves);
    return lcp_solution(problem, status, folded.unfolded(x), n_solves);
}

}  // namespace knap
