// Infeasible primal-dual interior point method with predictor and corrector (Mehrotra 1992; S. Wright, Primal-Dual
// Interior-Point Methods, SIAM 1997, 8). Its theory holds for positive semidefinite M only; elsewhere it is a heuristic
// and may stall. It ends near the middle of a set of solutions, where the pivoting methods end at a vertex. It takes no
// warm start, which would lie at the boundary.
#include "lcp/linear_system.hpp"
#include "lcp/scaling.hpp"
#include "lcp/solvers.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr int max_interior_point_iterations = 150;
constexpr double min_step = 1e-10;
constexpr int max_crossover_steps = 10;
constexpr double crossover = 1e-6;  // residual from which Newton may finish what the ill-conditioned systems cannot

/// The longest step up to one that keeps x positive.
double longest_step(const Eigen::VectorXd& x, const Eigen::VectorXd& step) {
    double length = 1;
    for (int i = 0; i < x.size(); ++i)
        if (step[i] < 0) length = std::min(length, -part_of_longest_step * x[i] / step[i]);
    return length;
}

class CentralPath {
public:
    explicit CentralPath(const LcpProblem& problem)
        : z(Eigen::VectorXd::Ones(problem.size())), M_(problem.M), q_(problem.q), w_(z) {}

    /// One step; `solved` where it was long enough to continue.
    LcpStatus advance() {
        if (!system_.factorise(M_, w_.cwiseQuotient(z))) return LcpStatus::singular;
        const double n = static_cast<double>(z.size()), gap = z.dot(w_) / n;
        const auto [affine_z, affine_w] = direction(Eigen::VectorXd::Zero(z.size()));
        if (!affine_z.allFinite() || !affine_w.allFinite()) return LcpStatus::stalled;
        const double affine_length = std::min(longest_step(z, affine_z), longest_step(w_, affine_w));
        const double affine_gap = (z + affine_length * affine_z).dot(w_ + affine_length * affine_w) / n;
        const double centring = std::pow(std::clamp(affine_gap / gap, 1e-3, 1.0), 3);
        const auto [step_z, step_w] =
            direction(Eigen::VectorXd::Constant(z.size(), centring * gap) - affine_z.cwiseProduct(affine_w));
        if (!step_z.allFinite() || !step_w.allFinite()) return LcpStatus::stalled;
        const double length = std::min(longest_step(z, step_z), longest_step(w_, step_w));
        z += length * step_z;
        w_ += length * step_w;
        return length > min_step ? LcpStatus::solved : LcpStatus::stalled;
    }

    Eigen::VectorXd z;

private:
    /// Steps of z and w towards w = M z + q and z w = target, with the factors of M + diag(w / z).
    std::pair<Eigen::VectorXd, Eigen::VectorXd> direction(const Eigen::VectorXd& target) const {
        const Eigen::VectorXd mismatch = M_ * z + q_ - w_, lack = (target - z.cwiseProduct(w_)).cwiseQuotient(z);
        const Eigen::VectorXd step_z = system_.solve(lack - mismatch);
        return {step_z, lack - w_.cwiseProduct(step_z).cwiseQuotient(z)};
    }

    const LcpMatrix& M_;
    const Eigen::VectorXd& q_;
    Eigen::VectorXd w_;
    LinearSystem system_;
};

}  // namespace

LcpSolution solve_by_interior_point(const LcpProblem& problem, const LcpOptions& options) {
    const int n = problem.size(), limit = options.limit(max_interior_point_iterations);
    if (n == 0 || problem.q.minCoeff() >= 0)
        return lcp_solution(problem, LcpStatus::solved, Eigen::VectorXd::Zero(n), 0);
    LcpProblem scaled = problem;
    const LcpScaling scaling = equilibrate(scaled);
    CentralPath path(scaled);
    Eigen::VectorXd best = path.z;
    double residual = natural_residual(scaled, best);
    LcpStatus status = LcpStatus::solved;
    int count = 0;
    for (; residual > options.tolerance && status == LcpStatus::solved; ++count) {
        status = count < limit ? path.advance() : LcpStatus::iteration_limit;
        if (const double next = natural_residual(scaled, path.z); next < residual) residual = next, best = path.z;
    }
    const Eigen::VectorXd z = scaling.original_z(best);
    if (status != LcpStatus::solved && residual <= crossover) {
        LcpSolution end = solve_by_newton(
            problem, {.tolerance = options.tolerance, .max_iterations = max_crossover_steps, .start = z});
        end.iterations += count;
        if (end.status == LcpStatus::solved) return end;
    }
    return lcp_solution(problem, status, z, count);
}

}  // namespace knap
