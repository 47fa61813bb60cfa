// Semismooth Newton on the natural map min(z, M z + q), the primal-dual active set method (Hintermueller, Ito, Kunisch
// 2002; Facchinei, Pang, Finite-Dimensional Variational Inequalities, 9). Three safeguards: a proximal term for
// rank-deficient matrices, a nonmonotone line search on the Fischer-Burmeister merit (De Luca, Facchinei, Kanzow 1996),
// and a start from a few block Gauss-Seidel sweeps. It works on the whole problem: on steps beyond Assumption 1 (an
// unloaded beam, 1400 to 1600 unknowns) it finds solutions in about 1.4 s where Newton on the box form stalls and the
// interior point takes 7 s.
#include "lcp/linear_system.hpp"
#include "lcp/scaling.hpp"
#include "lcp/solvers.hpp"

#include <algorithm>
#include <array>

namespace knap {
namespace {

constexpr int max_iterations = 100;  // of each start
constexpr int n_starts = 4;          // each after four times the sweeps of the one before
constexpr int first_sweeps = 5;
constexpr double min_proximal = 1e-11, max_proximal = 1.0;
constexpr int n_halvings = 6;
constexpr int n_remembered = 6;  // merits that the line search compares with

/// Half the squared norm of the Fischer-Burmeister function z + w - sqrt(z^2 + w^2).
double merit(const Eigen::VectorXd& z, const Eigen::VectorXd& w) {
    return 0.5 * (z.array() + w.array() - (z.array().square() + w.array().square()).sqrt()).square().sum();
}

class Newton {
public:
    Newton(const LcpProblem& problem, double tolerance) : problem_(problem), tolerance_(tolerance) {}

    LcpStatus run(int limit, Eigen::VectorXd& z) {
        Eigen::VectorXd w = problem_.M * z + problem_.q;
        std::array<double, n_remembered> merits;
        merits.fill(merit(z, w));
        double proximal = min_proximal;
        for (int count = 0; count < limit; ++count) {
            if (natural_residual(problem_, z) <= tolerance_) return LcpStatus::solved;
            ++n_solves;
            Eigen::VectorXd step;
            const bool found = find_step(z, w, proximal, step);
            if (found && search(z, w, step, *std::max_element(merits.begin(), merits.end()))) {
                merits[count % n_remembered] = merit(z, w);
                proximal = std::max(min_proximal, 0.01 * proximal);
            } else if (proximal >= max_proximal) {
                return found ? LcpStatus::stalled : LcpStatus::singular;
            } else {
                proximal = std::min(max_proximal, 100 * std::max(proximal, 1e-8));
            }
        }
        return natural_residual(problem_, z) <= tolerance_ ? LcpStatus::solved : LcpStatus::iteration_limit;
    }

    int n_solves = 0;

private:
    /// (M_AA + proximal I) d_A = M_AI z_I - w_A,  d_I = -z_I  with the active set A where z > w, and I the others.
    bool find_step(const Eigen::VectorXd& z, const Eigen::VectorXd& w, double proximal, Eigen::VectorXd& step) {
        std::vector<int> active;
        step = -z;
        for (int i = 0; i < z.size(); ++i)
            if (z[i] > w[i]) active.push_back(i), step[i] = 0;
        const Eigen::VectorXd proximal_term = Eigen::VectorXd::Constant(static_cast<int>(active.size()), proximal);
        if (!system_.factorise(submatrix(problem_.M, active), proximal_term)) return false;
        const Eigen::VectorXd target = -(problem_.M * step) - w;
        step(active) = system_.solve(target(active));
        return step.allFinite();
    }

    bool search(Eigen::VectorXd& z, Eigen::VectorXd& w, const Eigen::VectorXd& step, double reference) const {
        const Eigen::VectorXd w_step = problem_.M * step;
        double length = 1;
        for (int count = 0; count <= n_halvings; ++count, length *= 0.5) {
            const Eigen::VectorXd next_z = z + length * step, next_w = w + length * w_step;
            if (!(merit(next_z, next_w) <= (1 - 1e-3 * length) * reference)) continue;
            z = next_z;
            w = problem_.M * z + problem_.q;  // anew: the sum of increments would carry their rounding
            return true;
        }
        return false;
    }

    const LcpProblem& problem_;
    double tolerance_;
    LinearSystem system_;
};

}  // namespace

LcpSolution solve_by_newton(const LcpProblem& problem, const LcpOptions& options) {
    const bool is_warm = options.start.size() == problem.size();
    const ScaledLcp scaled = equilibrated(problem);
    Newton newton(scaled.problem, options.tolerance);
    Eigen::VectorXd start = is_warm ? scaled.scaled_z(options.start) : Eigen::VectorXd::Zero(problem.size()), z;
    LcpStatus status = LcpStatus::stalled;
    for (int attempt = 0, n_sweeps = first_sweeps; attempt < (options.exhaustive ? n_starts : 1);
         ++attempt, n_sweeps *= 4) {
        if (attempt > 0 || !is_warm)
            start = solve_by_gauss_seidel(scaled.problem,
                                          {.tolerance = options.tolerance, .max_iterations = n_sweeps, .start = start})
                        .z;
        z = start;
        status = newton.run(options.max_iterations > 0 ? options.max_iterations : max_iterations, z);
        if (status == LcpStatus::solved) break;
    }
    return lcp_solution(problem, status, scaled.original_z(z), newton.n_solves);
}

}  // namespace knap
