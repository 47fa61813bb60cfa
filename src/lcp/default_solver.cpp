#include "lcp/default_solver.hpp"

#include "lcp/fold.hpp"
#include "lcp/folded_newton.hpp"
#include "lcp/folded_sweeps.hpp"
#include "lcp/lemke.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr int most_sweeps_at_once = 5;
constexpr int n_attempts = 4;          // sweeps and Newton by turns, each with four times the sweeps of the one before
constexpr int n_covering_vectors = 3;  // of Lemke
constexpr double much = 0.3;           // of the entries of a matrix that is as good as dense

/// Sweeps that cost about as much as a linear solve, measured on problems of 100 to 4000 unknowns; on the large sparse ones a few times
/// as many, since there Newton often needs tens of solves to tell the redundant impulses apart.
double sweeps_per_solve(const FoldedLcp& folded) {
    const double n = folded.size();
    return static_cast<double>(folded.M.nonZeros()) > much * n * n ? 10 + n / 40 : std::max(2.5 * std::sqrt(n), n / 10);
}

/// Sweeps until x is a solution, or until linear solves promise to be cheaper. Returns whether x is one.
bool sweep_while_it_pays(const FoldedLcp& folded, double tolerance, double budget, Eigen::VectorXd& x, int& n_sweeps) {
    double before = 0;
    int at_once = most_sweeps_at_once;
    for (double done = 0;;) {
        const double change = sweep(folded, x, at_once);
        n_sweeps += at_once;
        done += at_once;
        if (!std::isfinite(change)) return false;
        if (change <= 10 * tolerance && folded.natural_map(x, folded.value(x)).cwiseAbs().maxCoeff() <= tolerance) return true;
        // at the present rate, how many are left
        const double left = change < before ? at_once * std::log(tolerance / change) / std::log(change / before) : 1e300;
        if ((done >= budget && left > 2 * budget) || done >= 20 * budget) return false;
        at_once = static_cast<int>(std::clamp(std::ceil(left), 1.0, static_cast<double>(most_sweeps_at_once)));
        before = change;
    }
}

}  // namespace

LcpSolution solve_by_default(const LcpProblem& problem, const DefaultSolverOptions& options) {
    const FoldedLcp folded = fold(problem);
    const int n = folded.size();
    const bool warm = options.start.size() == problem.size();
    Eigen::VectorXd x = warm ? folded.folded(options.start) : Eigen::VectorXd::Zero(n);
    int count = 0;
    const auto result = [&](LcpStatus status, const Eigen::VectorXd& at) { return lcp_solution(problem, status, folded.unfolded(at), count); };
    if (n == 0 || folded.natural_map(x, folded.value(x)).cwiseAbs().maxCoeff() <= options.tolerance) return result(LcpStatus::solved, x);
    const bool can_sweep = has_positive_diagonal(folded);
    for (int attempt = 0; attempt < n_attempts; ++attempt) {
        const double budget = std::ldexp(sweeps_per_solve(folded), 2 * attempt);
        if (can_sweep && sweep_while_it_pays(folded, options.tolerance, budget, x, count)) return result(LcpStatus::solved, x);
        Eigen::VectorXd found = x.allFinite() ? x : Eigen::VectorXd::Zero(n);
        const LcpStatus status = solve_folded_by_newton(folded, {.tolerance = options.tolerance}, found, count);
        if (status == LcpStatus::solved) return result(status, found);
        if (!can_sweep || !x.allFinite()) break;
    }
    if (problem.size() > options.largest_dense) return result(LcpStatus::stalled, x);
    LcpSolution last = solve_by_lemke(problem, {.n_covering_vectors = n_covering_vectors});
    last.iterations += count;
    return last;
}

}  // namespace knap
