#include "lcp/default_solver.hpp"

#include "lcp/convex_qp.hpp"
#include "lcp/fold.hpp"
#include "lcp/folded_newton.hpp"
#include "lcp/folded_proximal_point.hpp"
#include "lcp/folded_sweeps.hpp"
#include "lcp/free_breaking.hpp"
#include "lcp/gauss_seidel.hpp"
#include "lcp/interior_point.hpp"
#include "lcp/lemke.hpp"
#include "lcp/newton.hpp"
#include "lcp/residual.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

namespace knap {
namespace {

constexpr int sweeps_between_looks = 5;  // at their rate
constexpr double steady = 0.999;             // a change that stays so nearly the same is a drift
constexpr int most_rays = 100;
constexpr int n_attempts = 4;          // sweeps and Newton by turns, each with four times the sweeps of the one before
constexpr int n_covering_vectors = 3;  // of Lemke
constexpr double much = 0.3;           // of the entries of a matrix that is as good as dense

/// Sweeps that cost about as much as a linear solve, measured on problems of 100 to 4000 unknowns; on the large sparse ones a few times
/// as many, since there Newton often needs tens of solves to tell the redundant impulses apart.
double sweeps_per_solve(const FoldedLcp& folded) {
    const double n = folded.size();
    return static_cast<double>(folded.M.nonZeros()) > much * n * n ? 10 + n / 40 : std::max(2.5 * std::sqrt(n), n / 10);
}

/// Where redundant conditions contradict each other a little (contacts round a vertex that still move by a rounding), the sweeps drift along a
/// ray, by the same step each, until one of them lets go: to the first bound at once.
void follow_ray(const FoldedLcp& folded, Eigen::VectorXd& x, int& n_sweeps) {
    const Eigen::VectorXd from = x;
    sweep(folded, x, 1);
    ++n_sweeps;
    const Eigen::VectorXd step = x - from;
    double length = std::numeric_limits<double>::infinity();
    const auto meets = [&](double distance, double speed) {  // where distance >= 0 shrinks
        if (speed > 0 && distance > 0) length = std::min(length, distance / speed);
    };
    for (int i = 0; i < folded.size(); ++i) {
        const FoldedUnknown& u = folded.unknowns[i];
        const double upper = folded.upper(i, x), growth = u.bound_by >= 0 ? u.bound_factor * step[u.bound_by] : 0.0;
        meets(x[i] - folded.lower(i, upper), -step[i] - (u.two_sided ? growth : 0.0));
        if (upper < std::numeric_limits<double>::infinity()) meets(upper - x[i], step[i] - growth);
    }
    if (std::isfinite(length)) x += length * step;
}

/// Sweeps until x is a solution, or until linear solves promise to be cheaper. Returns whether x is one.
bool sweep_while_it_pays(const FoldedLcp& folded, double tolerance, double budget, Eigen::VectorXd& x, int& n_sweeps) {
    double before = 0;  // change of x at the last look
    int n_rays = 0;
    for (int done = 1;; ++done) {
        const double change = sweep(folded, x, 1);
        ++n_sweeps;
        if (!std::isfinite(change)) return false;
        if (change <= 10 * tolerance && folded.natural_map(x, folded.value(x)).cwiseAbs().maxCoeff() <= tolerance) return true;
        if (done % sweeps_between_looks != 0) continue;
        // at the present rate, how many are left
        const double left = change < before ? sweeps_between_looks * std::log(tolerance / change) / std::log(change / before) : 1e300;
        if (change > steady * before && change < before / steady && n_rays < most_rays) follow_ray(folded, x, n_sweeps), ++n_rays;
        else if ((done >= budget && left > 2 * budget) || done >= 20 * budget) return false;
        before = change;
    }
}

/// What the judge says of answers: the one to return is the first that is accurate and breaks no bond freely, or else the best of all.
class Answers {
public:
    Answers(const LcpProblem& problem, double largest_residual) : problem_(problem), largest_residual_(largest_residual) {}

    /// Whether it is the one to return.
    bool take(LcpSolution solution) {
        const double residual = scaled_residual(problem_, solution.z);
        const bool accurate = residual <= largest_residual_;
        if (!layout_) layout_ = cohesive_layout(problem_);
        const bool breaks = accurate && *layout_ && free_breaking(problem_, solution.z, **layout_).n_free > 0;
        const int rank = accurate && !breaks ? 0 : accurate ? 1 : 2;
        if (accurate) solution.status = LcpStatus::solved;
        else if (solution.status == LcpStatus::solved) solution.status = LcpStatus::stalled;
        if (rank < rank_ || (rank == rank_ && residual < residual_) || best_.z.size() != problem_.size())
            best_ = std::move(solution), rank_ = rank, residual_ = residual;
        return rank == 0;
    }

    const LcpSolution& best() const { return best_; }

private:
    const LcpProblem& problem_;
    double largest_residual_;
    std::optional<std::optional<CohesiveLayout>> layout_;  // is asked for once
    LcpSolution best_;
    int rank_ = 3;
    double residual_ = std::numeric_limits<double>::infinity();
};

/// Every other solver on the whole problem, the quickest first.
LcpSolution solve_by_any(const LcpProblem& problem, const DefaultSolverOptions& options, Answers& answers, int count) {
    const auto newton = [&] { return solve_by_newton(problem, {.start = options.start}); };
    const auto lemke = [&] { return solve_by_lemke(problem); };
    const auto interior_point = [&] { return solve_by_interior_point(problem); };
    const auto convex_qp = [&] { return solve_by_convex_qp(problem, {.start = options.start}); };
    const auto gauss_seidel = [&] { return solve_by_gauss_seidel(problem, {.start = options.start}); };
    const bool dense = problem.size() <= options.largest_dense;
    for (const std::function<LcpSolution()>& solver : dense ? std::vector<std::function<LcpSolution()>>{newton, lemke, interior_point, convex_qp, gauss_seidel}
                                                            : std::vector<std::function<LcpSolution()>>{gauss_seidel}) {
        LcpSolution solution = solver();
        solution.iterations = count += solution.iterations;
        if (answers.take(std::move(solution))) break;
    }
    LcpSolution best = answers.best();
    best.iterations = count;
    return best;
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
    const Eigen::VectorXd start = x;
    Eigen::VectorXd best = x;
    double least = std::numeric_limits<double>::infinity();
    const auto remember = [&](const Eigen::VectorXd& at) {
        if (const double map = at.allFinite() ? folded.natural_map(at, folded.value(at)).cwiseAbs().maxCoeff() : least; map < least) least = map, best = at;
    };
    const auto newton_from = [&](Eigen::VectorXd found) {
        const LcpStatus status = solve_folded_by_newton(folded, {.tolerance = options.tolerance}, found, count);
        remember(found);
        return status == LcpStatus::solved;
    };
    const bool can_sweep = has_positive_diagonal(folded);
    Answers answers(problem, options.largest_residual);
    // Within Assumption 1 the residual of the folded problem is as strict as the judge's; beyond it the judge is asked
    const auto is_accepted = [&](const Eigen::VectorXd& at) { return can_sweep || !options.every_solver || answers.take(result(LcpStatus::solved, at)); };
    for (int attempt = 0; attempt < n_attempts; ++attempt) {
        const double budget = std::ldexp(sweeps_per_solve(folded), 2 * attempt);
        if (can_sweep && sweep_while_it_pays(folded, options.tolerance, budget, x, count)) return result(LcpStatus::solved, x);
        if (x.allFinite()) remember(x);
        if (newton_from(x.allFinite() ? x : start) && is_accepted(best)) return result(LcpStatus::solved, best);
        if (!can_sweep || !x.allFinite()) break;
        if (attempt > 0) continue;
        Eigen::VectorXd early = start;  // Newton may cycle near a degenerate solution and still find it from afar
        sweep(folded, early, 1);
        ++count;
        if (newton_from(early) && is_accepted(best)) return result(LcpStatus::solved, best);
    }
    if (softens(folded)) {
        Eigen::VectorXd found(n);
        if (solve_folded_by_proximal_points(folded, {.tolerance = options.tolerance}, found, count) == LcpStatus::solved && is_accepted(found))
            return result(LcpStatus::solved, found);
        remember(found);
    }
    if (least <= options.acceptable && is_accepted(best)) return result(LcpStatus::solved, best);
    if (options.every_solver) {
        answers.take(result(LcpStatus::stalled, best));
        return solve_by_any(problem, options, answers, count);
    }
    if (problem.size() > options.largest_dense) return result(LcpStatus::stalled, best);
    LcpSolution last = solve_by_lemke(problem, {.n_covering_vectors = n_covering_vectors});
    last.iterations += count;
    return last;
}

}  // namespace knap
