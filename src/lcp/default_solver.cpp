// The solver to use where nothing is known of the problem. On the box form, sweeps find most of the states and Newton
// the rest. Where both fail, as in steps beyond Assumption 1, proximal points are tried, then every other solver on the
// whole problem, until an answer is accepted: it solves any problem that one of them solves, and a problem that none
// solves takes as long as all of them together. It never forms a dense matrix of a large problem.
#include "base/vec.hpp"
#include "lcp/infeasibility.hpp"
#include "lcp/presolve.hpp"
#include "lcp/scaling.hpp"
#include "lcp/solvers.hpp"
#include "lcp/spurious_breaking.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace knap {
namespace {

constexpr int sweeps_between_checks = 5;  // of their rate
constexpr double steady = 0.999;          // a change whose ratio to the last one is nearer to one is a drift
constexpr double dense_fraction = 0.3;    // of the entries of a matrix that counts as dense

/// Sweeps that cost about as much as a linear solve, measured on problems of 100 to 4000 unknowns; on large sparse ones
/// a few times as many, since there Newton often needs tens of solves to separate the redundant impulses.
double sweeps_per_solve(const BoxLcp& box) {
    const double n = box.size();
    return static_cast<double>(box.M.nonZeros()) > dense_fraction * n * n ? 10 + n / 40
                                                                          : std::max(2.5 * std::sqrt(n), n / 10);
}

/// Where redundant conditions contradict each other by a rounding (contacts round a vertex that still move), sweeps
/// drift along a ray by equal steps until one condition is released. This goes to the first bound at once.
void follow_ray(const BoxLcp& box, const Sweeps& sweeps, Eigen::VectorXd& x) {
    const Eigen::VectorXd from = x;
    sweeps.run(x);
    const Eigen::VectorXd step = x - from;
    double length = infinity;
    const auto limit = [&](double distance, double speed) {
        if (speed > 0 && distance > 0) length = std::min(length, distance / speed);
    };
    for (int i = 0; i < box.size(); ++i) {
        const BoxUnknown& u = box.unknowns[i];
        const double upper = box.upper(i, x), growth = u.bound_by >= 0 ? u.bound_factor * step[u.bound_by] : 0.0;
        limit(x[i] - box.lower(i, upper), -step[i] - (u.two_sided ? growth : 0.0));
        if (upper < infinity) limit(upper - x[i], step[i] - growth);
    }
    if (std::isfinite(length)) x += length * step;
}

/// Sweeps until x is a solution, or until linear solves promise to be cheaper. Returns whether x is a solution; F is
/// then its value.
bool sweep_while_it_pays(const BoxLcp& box, double tolerance, Eigen::VectorXd& x, Eigen::VectorXd& F, int& n_sweeps) {
    const Sweeps sweeps(box);
    const double budget = sweeps_per_solve(box);
    double before = 0;  // change of x at the last check
    int n_rays = 0;
    for (int done = 1;; ++done) {
        const double change = sweeps.run(x);
        ++n_sweeps;
        if (!std::isfinite(change)) return false;
        if (change <= 10 * tolerance && box.residual(x, F = box.value(x)) <= tolerance) return true;
        if (done % sweeps_between_checks != 0) continue;
        // sweeps still needed at the present rate
        const double left = change < before
                                ? sweeps_between_checks * std::log(tolerance / change) / std::log(change / before)
                                : infinity;
        if (change > steady * before && change < before / steady && n_rays < max_iterations)
            follow_ray(box, sweeps, x), ++n_sweeps, ++n_rays;
        else if ((done >= budget && left > 2 * budget) || done >= 20 * budget) return false;
        before = change;
    }
}

class Cascade {
public:
    Cascade(const LcpProblem& problem, const LcpOptions& options)
        : problem_(problem), options_(options), box_(presolve(problem)), can_sweep_(box_.has_positive_diagonal()) {}

    LcpSolution run() {
        best_x_ = box_.box_start(options_.start);
        smallest_ = box_.residual(best_x_);
        if (smallest_ <= options_.tolerance || solve_box_form())
            return accepted_ ? std::move(*accepted_) : result(LcpStatus::solved, best_x_);
        LcpSolution best = result(LcpStatus::stalled, best_x_);
        if (!options_.exhaustive) {
            if (problem_.size() > max_dense_unknowns) return best;
            best = solve_by_lemke(problem_, options_);
            best.iterations += count_;
            return best;
        }
        Rank rank = judge(best);
        for (const LcpSolver& solver : lcp_solvers().subspan(1)) {
            if (rank.is_accepted()) break;
            if (problem_.size() > solver.max_unknowns) continue;
            LcpSolution next = solver.solve(problem_, options_);
            count_ += next.iterations;
            if (const Rank rank_of_next = judge(next); rank_of_next < rank) rank = rank_of_next, best = std::move(next);
        }
        best.iterations = count_;
        if (!rank.is_accepted()) best.ray = find_infeasible_ray(problem_);
        if (best.ray.size() > 0) best.status = LcpStatus::ray;
        else if (best.status == LcpStatus::ray) best.status = LcpStatus::stalled;  // Lemke's ray alone proves nothing
        return best;
    }

private:
    struct Rank {
        bool inaccurate, spurious;
        double residual;
        bool is_accepted() const { return !inaccurate && !spurious; }
        auto operator<=>(const Rank&) const = default;
    };

    LcpSolution result(LcpStatus status, const Eigen::VectorXd& x) const {
        return lcp_solution(problem_, status, box_.lcp_point(x), count_);
    }

    /// The rank of an answer, whose status is set according to its residual. Without `with_bonds` no bond is looked at.
    Rank judge(LcpSolution& solution, bool with_bonds = true) {
        if (!scaling_) scaling_ = scaling_of(problem_);
        if (with_bonds && !layout_) layout_ = cohesive_layout(problem_);
        const double residual = scaled_residual(*scaling_, solution.z, solution.w);
        const bool inaccurate = !(residual <= max_residual);
        if (!inaccurate) solution.status = LcpStatus::solved;
        else if (solution.status == LcpStatus::solved) solution.status = LcpStatus::stalled;
        const bool spurious = !inaccurate && with_bonds && *layout_ &&
                              spurious_breaking(problem_, *scaling_, solution.z, **layout_).n_spurious > 0;
        return {inaccurate, spurious, residual};
    }

    /// The residual of the box form is not strict where sweeps diverge. Within Assumption 1 no bond breaks spuriously.
    bool is_accepted(const Eigen::VectorXd& x, const Eigen::VectorXd& F) {
        if (!options_.exhaustive) return true;
        LcpSolution solution = lcp_solution(problem_, LcpStatus::solved, box_.lcp_point(x, F), count_);
        const bool is_accepted = judge(solution, !can_sweep_).is_accepted();
        if (is_accepted) accepted_ = std::move(solution);
        return is_accepted;
    }

    void remember(const Eigen::VectorXd& x) {
        if (const double residual = box_.residual(x); residual < smallest_) smallest_ = residual, best_x_ = x;
    }

    bool newton_from(Eigen::VectorXd x) {
        const LcpStatus status = solve_box_by_newton(box_, options_.tolerance, max_newton_steps, x, count_);
        remember(x);
        return status == LcpStatus::solved && is_accepted(best_x_, box_.value(best_x_));
    }

    /// Whether best_x_ is an accepted solution.
    bool solve_box_form() {
        const Eigen::VectorXd start = best_x_;
        Eigen::VectorXd x = start, F;
        if (can_sweep_ && sweep_while_it_pays(box_, options_.tolerance, x, F, count_) && is_accepted(x, F)) {
            best_x_ = x;
            return true;
        }
        remember(x);
        if (newton_from(x.allFinite() ? x : start)) return true;
        const LcpStatus status = solve_box_by_proximal_points(box_, options_.tolerance, x, count_);
        if (status == LcpStatus::solved && is_accepted(x, box_.value(x))) {
            best_x_ = x;
            return true;
        }
        remember(x);
        return false;
    }

    const LcpProblem& problem_;
    const LcpOptions& options_;
    BoxLcp box_;
    bool can_sweep_;
    std::optional<LcpScaling> scaling_;  // what judges need is found with the first answer
    std::optional<std::optional<CohesiveLayout>> layout_;
    std::optional<LcpSolution> accepted_;
    Eigen::VectorXd best_x_;
    double smallest_ = infinity;  // residual of best_x_ in the box form
    int count_ = 0;
};

}  // namespace

LcpSolution solve_by_default(const LcpProblem& problem, const LcpOptions& options) {
    return Cascade(problem, options).run();
}

}  // namespace knap
