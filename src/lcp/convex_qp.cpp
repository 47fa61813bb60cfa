// Where the box form has a symmetric, positive semidefinite matrix and constant bounds, it is the optimum of the convex
// problem
//     min 1/2 x'M x + q'x,   lower <= x <= upper
// e.g. frictionless contact with the cohesion frozen, or mode I without contact. Projected Newton on the unknowns that
// are not held by a bound, with a search along the projected step (Bertsekas, SIAM J. Control Optim. 20, 1982): the
// objective falls in every iteration, so it cannot cycle, and a small proximal term makes rank-deficient matrices
// harmless.
#include "lcp/linear_system.hpp"
#include "lcp/presolve.hpp"
#include "lcp/solvers.hpp"

#include <Eigen/SparseCholesky>

namespace knap {
namespace {

constexpr int max_qp_iterations = 300;
constexpr double proximal = 1e-10;        // compared with a diagonal of one
constexpr double symmetry = 1e-12;        // largest difference of the scaled matrix and its transpose
constexpr double smallest_pivot = -1e-9;  // a pivot below is not due to rounding: the problem is not convex
constexpr double sufficient = 1e-4;       // part of the decrease that the slope promises
constexpr double rounding_step = 1e-9;    // of steps so small that the objective only shows its rounding
constexpr int max_qp_halvings = 40;

bool is_box_constrained(const BoxLcp& box) {
    for (const BoxUnknown& u : box.unknowns)
        if (u.bound_by >= 0 || u.feeds >= 0) return false;
    const LcpMatrix difference = box.M - LcpMatrix(box.M.transpose());
    return difference.nonZeros() == 0 || difference.coeffs().cwiseAbs().maxCoeff() <= symmetry;
}

class ProjectedNewton {
public:
    explicit ProjectedNewton(const BoxLcp& box) : box_(box), n_(box.size()), lower_(n_), upper_(n_) {
        for (int i = 0; i < n_; ++i) {
            upper_[i] = box.unknowns[i].upper;
            lower_[i] = box.lower(i, upper_[i]);
        }
    }

    LcpStatus run(double tolerance, int limit, Eigen::VectorXd& x, int& n_solves) {
        x = projected(x);
        for (int count = 0; count < limit; ++count) {
            if (box_.residual(x) <= tolerance) return LcpStatus::solved;
            const Eigen::VectorXd slope = box_.M * x + box_.q;
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

    bool is_held(int i, double x, double slope) const {
        return (x <= lower_[i] && slope >= 0) || (x >= upper_[i] && slope <= 0);
    }

    LcpStatus newton_step(const Eigen::VectorXd& x, const Eigen::VectorXd& slope, Eigen::VectorXd& step) {
        std::vector<int> free;
        for (int i = 0; i < n_; ++i)
            if (!is_held(i, x[i], slope[i])) free.push_back(i);
        Eigen::SparseMatrix<double> A = submatrix(box_.M, free), identity(A.rows(), A.cols());
        identity.setIdentity();
        factors_.compute(A + proximal * identity);
        if (factors_.info() != Eigen::Success || !factors_.vectorD().allFinite()) return LcpStatus::singular;
        if (factors_.vectorD().minCoeff() < smallest_pivot) return LcpStatus::not_applicable;
        const Eigen::VectorXd y = factors_.solve(Eigen::VectorXd(-slope(free)));
        step = Eigen::VectorXd::Zero(n_);
        step(free) = y;
        return step.allFinite() ? LcpStatus::solved : LcpStatus::singular;
    }

    /// Along the projected step until the objective decreases enough.
    bool search(Eigen::VectorXd& x, const Eigen::VectorXd& slope, const Eigen::VectorXd& step) const {
        double length = 1;
        for (int count = 0; count < max_qp_halvings; ++count, length *= 0.5) {
            const Eigen::VectorXd next = projected(x + length * step), change = next - x;
            const double promised = slope.dot(change), decrease = promised + 0.5 * change.dot(box_.M * change);
            if (decrease > sufficient * promised && change.cwiseAbs().maxCoeff() > rounding_step) continue;
            x = next;
            return !change.isZero(0);
        }
        return false;
    }

    const BoxLcp& box_;
    int n_;
    Eigen::VectorXd lower_, upper_;
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors_;
};

}  // namespace

LcpSolution solve_by_convex_qp(const LcpProblem& problem, const LcpOptions& options) {
    const BoxLcp box = presolve(problem);
    Eigen::VectorXd x = box.box_start(options.start);
    const int limit = options.max_iterations > 0 ? options.max_iterations : max_qp_iterations;
    int n_solves = 0;
    LcpStatus status = box.residual(x) <= options.tolerance ? LcpStatus::solved : LcpStatus::not_applicable;
    if (is_box_constrained(box)) status = ProjectedNewton(box).run(options.tolerance, limit, x, n_solves);
    return lcp_solution(problem, status, box.lcp_point(x), n_solves);
}

}  // namespace knap
