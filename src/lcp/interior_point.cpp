#include "lcp/interior_point.hpp"

#include "lcp/linear_system.hpp"
#include "lcp/newton.hpp"
#include "lcp/scaling.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr double kept_from_boundary = 0.995;
constexpr double least_step = 1e-10;

struct Direction {
    Eigen::VectorXd z, w;
};

/// The longest step up to one that keeps x positive.
double longest_step(const Eigen::VectorXd& x, const Eigen::VectorXd& step) {
    double length = 1;
    for (int i = 0; i < x.size(); ++i)
        if (step[i] < 0) length = std::min(length, -kept_from_boundary * x[i] / step[i]);
    return length;
}

class InteriorPoint {
public:
    explicit InteriorPoint(const LcpProblem& problem)
        : M(problem.M), q(problem.q), z(Eigen::VectorXd::Ones(q.size())), w(Eigen::VectorXd::Ones(q.size())) {}

    double gap() const { return z.dot(w) / static_cast<double>(z.size()); }

    /// The natural residual of z itself, with w = M z + q.
    double residual() const { return (M * z + q).cwiseMin(z).cwiseAbs().maxCoeff(); }

    /// M + diag(w / z)
    bool factorise() {
        Eigen::SparseMatrix<double> A = M;
        Eigen::SparseMatrix<double> diagonal(A.rows(), A.cols());
        diagonal.setIdentity();
        diagonal.diagonal() = w.cwiseQuotient(z);
        A += diagonal;
        return A.coeffs().allFinite() && system_.factorise(A);
    }

    /// Towards w = M z + q and z w = target.
    Direction direction(const Eigen::VectorXd& target) const {
        const Eigen::VectorXd mismatch = M * z + q - w, lack = (target - z.cwiseProduct(w)).cwiseQuotient(z);
        Direction step;
        step.z = system_.solve(lack - mismatch);
        step.w = lack - w.cwiseProduct(step.z).cwiseQuotient(z);
        return step;
    }

    /// False where the step is too small to go on.
    bool advance() {
        const Eigen::VectorXd zero = Eigen::VectorXd::Zero(z.size());
        const Direction affine = direction(zero);
        if (!affine.z.allFinite() || !affine.w.allFinite()) return false;
        const double length = std::min(longest_step(z, affine.z), longest_step(w, affine.w));
        const double after = (z + length * affine.z).dot(w + length * affine.w) / static_cast<double>(z.size());
        const double centring = std::pow(std::clamp(after / gap(), 1e-3, 1.0), 3);
        const Eigen::VectorXd target = Eigen::VectorXd::Constant(z.size(), centring * gap()) - affine.z.cwiseProduct(affine.w);
        const Direction step = direction(target);
        if (!step.z.allFinite() || !step.w.allFinite()) return false;
        const double taken = std::min(longest_step(z, step.z), longest_step(w, step.w));
        z += taken * step.z;
        w += taken * step.w;
        return taken > least_step;
    }

    const LcpMatrix& M;
    const Eigen::VectorXd& q;
    Eigen::VectorXd z, w;

private:
    LinearSystem system_;
};

/// Until the tolerance holds or the systems are too ill-conditioned to go on. Leaves the best z.
LcpStatus follow_central_path(const LcpProblem& problem, const InteriorPointOptions& options, Eigen::VectorXd& best, int& count) {
    InteriorPoint point(problem);
    best = point.z;
    double least = point.residual();
    for (count = 0; count < options.max_iterations; ++count) {
        if (least <= options.tolerance) return LcpStatus::solved;
        if (!point.factorise()) return LcpStatus::singular;
        if (!point.advance()) return LcpStatus::stalled;
        if (point.residual() < least) {
            least = point.residual();
            best = point.z;
        }
    }
    return least <= options.tolerance ? LcpStatus::solved : LcpStatus::iteration_limit;
}

}  // namespace

LcpSolution solve_by_interior_point(const LcpProblem& problem, const InteriorPointOptions& options) {
    const int n = problem.size();
    if (n == 0 || problem.q.minCoeff() >= 0) return lcp_solution(problem, LcpStatus::solved, Eigen::VectorXd::Zero(n), 0);
    const ScaledLcp scaled = equilibrated(problem);
    Eigen::VectorXd z;
    int count = 0;
    LcpStatus status = follow_central_path(scaled.problem, options, z, count);
    const double reached = (scaled.problem.M * z + scaled.problem.q).cwiseMin(z).cwiseAbs().maxCoeff();
    if (status != LcpStatus::solved && reached <= options.crossover) {
        const NewtonOptions last{.tolerance = options.tolerance, .max_iterations = options.max_crossover_steps, .n_starts = 1, .start = z};
        const LcpSolution polished = solve_by_newton(scaled.problem, last);
        count += polished.iterations;
        if (polished.status == LcpStatus::solved) {
            z = polished.z;
            status = LcpStatus::solved;
        }
    }
    return lcp_solution(problem, status, scaled.original_z(z), count);
}

}  // namespace knap
