#include "lcp/folded_proximal_point.hpp"

#include "lcp/folded_newton.hpp"
#include "lcp/folded_sweeps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace knap {
namespace {

constexpr int sweeps_a_round = 20, newton_steps_a_round = 8;
constexpr double inner_tolerance = 1e-10;  // of a round; the last round is a Newton iteration on the problem itself

bool is_capped(const FoldedUnknown& u) { return u.slack >= 0 && !u.two_sided; }

/// D, by the sums of the rows: the couplings of capped unknowns among each other, directly and through the pairs that they bound.
Eigen::VectorXd majorant(const FoldedLcp& problem) {
    Eigen::VectorXd D = Eigen::VectorXd::Zero(problem.size());
    for (int i = 0; i < problem.size(); ++i) {
        if (!is_capped(problem.unknowns[i])) continue;
        for (LcpMatrix::InnerIterator entry(problem.M, i); entry; ++entry)
            if (is_capped(problem.unknowns[entry.col()])) D[i] += entry.col() == i ? std::max(0.0, -entry.value()) : std::abs(entry.value());
        for (const int t : problem.fed_by[i])
            for (LcpMatrix::InnerIterator entry(problem.M, t); entry; ++entry)
                if (const FoldedUnknown& u = problem.unknowns[entry.col()]; u.bound_by >= 0 && is_capped(problem.unknowns[u.bound_by]))
                    D[i] += std::abs(problem.unknowns[t].feed_factor * entry.value() * u.bound_factor);
    }
    return D;
}

double residual(const FoldedLcp& problem, const Eigen::VectorXd& x) {
    return x.allFinite() ? problem.natural_map(x, problem.value(x)).cwiseAbs().maxCoeff() : std::numeric_limits<double>::infinity();
}

}  // namespace

bool softens(const FoldedLcp& problem) {
    for (int i = 0; i < problem.size(); ++i)
        if (is_capped(problem.unknowns[i])) return true;
    return false;
}

LcpStatus solve_folded_by_proximal_points(const FoldedLcp& problem, const FoldedProximalPointOptions& options, Eigen::VectorXd& x, int& count) {
    const Eigen::VectorXd D = majorant(problem);
    FoldedLcp convex = problem;
    for (int i = 0; i < problem.size(); ++i)
        if (D[i] > 0) convex.M.coeffRef(i, i) += D[i];
    if (!has_positive_diagonal(convex)) return LcpStatus::not_applicable;
    x.setZero();
    for (int i = 0; i < problem.size(); ++i)
        if (is_capped(problem.unknowns[i])) x[i] = problem.unknowns[i].upper;  // intact
    for (int round = 0; round < options.max_rounds; ++round) {
        convex.q = problem.q - D.cwiseProduct(x);
        Eigen::VectorXd next = x;
        sweep(convex, next, sweeps_a_round);
        count += sweeps_a_round;
        Eigen::VectorXd exact = next;
        if (solve_folded_by_newton(convex, {.tolerance = inner_tolerance, .max_iterations = newton_steps_a_round}, exact, count) == LcpStatus::solved)
            next = exact;
        if (!next.allFinite()) return LcpStatus::stalled;
        x = next;
        Eigen::VectorXd end = x;  // are the states those of a solution of the problem itself?
        if (solve_folded_by_newton(problem, {.tolerance = options.tolerance, .max_iterations = newton_steps_a_round}, end, count) == LcpStatus::solved) {
            x = end;
            return LcpStatus::solved;
        }
        if (residual(problem, x) <= options.tolerance) return LcpStatus::solved;
    }
    return LcpStatus::iteration_limit;
}

}  // namespace knap
