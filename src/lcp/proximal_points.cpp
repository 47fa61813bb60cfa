// Proximal point method, for steps beyond Assumption 1: where softening outweighs inertia and stiffness, the rows of
// the capped unknowns (cohesion, which decreases with the openings that it permits) have a negative curvature, their
// sweeps diverge and so do Newton steps. Instead
//     x_next solves the problem with F + D (x - x_last),  D >= 0 on capped unknowns, large enough to outweigh the
//     curvature
// as a nonconvex function is minimised by convex ones that touch it from above (Rockafellar 1976; Hunter, Lange 2004).
// Such a step has several solutions, and the method does not choose between them: a run should take a
// smaller step instead.
// Where nothing is capped (an explicit cohesion) D is a part of the diagonal: redundant conditions, as those of the
// polygon of coupling = "norm", leave sweeps slow and Newton's matrices singular.
#include "lcp/presolve.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr int max_rounds = 40, sweeps_per_round = 20;
constexpr double first_part = 1e-3, largest_part = 1;  // [-] of the diagonal

/// D from the sums of the rows: couplings among capped unknowns, directly and through the pairs that they bound.
Eigen::VectorXd majorant(const BoxLcp& box) {
    Eigen::VectorXd D = Eigen::VectorXd::Zero(box.size());
    for (int i = 0; i < box.size(); ++i) {
        if (!box.unknowns[i].is_capped()) continue;
        for (LcpMatrix::InnerIterator entry(box.M, i); entry; ++entry)
            if (box.unknowns[entry.col()].is_capped())
                D[i] += entry.col() == i ? std::max(0.0, -entry.value()) : std::abs(entry.value());
        for (const int t : box.fed_by[i])
            for (LcpMatrix::InnerIterator entry(box.M, t); entry; ++entry)
                if (const BoxUnknown& u = box.unknowns[entry.col()];
                    u.bound_by >= 0 && box.unknowns[u.bound_by].is_capped())
                    D[i] += std::abs(box.unknowns[t].feed_factor * entry.value() * u.bound_factor);
    }
    return D;
}

/// The part falls while Newton's method solves the rounds.
LcpStatus solve_redundant(const BoxLcp& box, double tolerance, Eigen::VectorXd& x, int& count) {
    const Eigen::VectorXd diagonal = box.M.diagonal();
    BoxLcp convex = box;
    double part = first_part;
    for (int round = 0; round < max_rounds && part <= largest_part; ++round) {
        for (int i = 0; i < box.size(); ++i) convex.M.coeffRef(i, i) = (1 + part) * diagonal[i];
        convex.q = box.q - part * diagonal.cwiseProduct(x);
        Eigen::VectorXd next = x;
        const bool found = solve_box_by_newton(convex, tolerance, max_newton_steps, next, count) == LcpStatus::solved;
        part *= found ? 0.1 : 10;
        if (found) x = next;
        if (box.residual(x) <= tolerance) return LcpStatus::solved;
    }
    return LcpStatus::iteration_limit;
}

}  // namespace

LcpStatus solve_box_by_proximal_points(const BoxLcp& box, double tolerance, Eigen::VectorXd& x, int& count) {
    if (std::ranges::none_of(box.unknowns, &BoxUnknown::is_capped))
        return box.has_positive_diagonal() && x.allFinite() ? solve_redundant(box, tolerance, x, count)
                                                            : LcpStatus::stalled;
    const Eigen::VectorXd D = majorant(box);
    BoxLcp convex = box;
    for (int i = 0; i < box.size(); ++i) {
        x[i] = box.unknowns[i].is_capped() ? box.unknowns[i].upper : 0.0;
        if (D[i] > 0) convex.M.coeffRef(i, i) += D[i];
    }
    if (!convex.has_positive_diagonal()) return LcpStatus::stalled;
    const Sweeps sweeps(convex);
    const auto newton = [&](const BoxLcp& problem, double until) {  // keeps only solutions
        Eigen::VectorXd exact = x;
        if (solve_box_by_newton(problem, until, max_newton_steps, exact, count) != LcpStatus::solved) return false;
        x = exact;
        return true;
    };
    for (int round = 0; round < max_rounds; ++round) {
        convex.q = box.q - D.cwiseProduct(x);
        sweeps.run(x, sweeps_per_round);
        count += sweeps_per_round;
        newton(convex, max_residual);  // a round whose problem is not solved leads hardly nearer
        if (!x.allFinite()) return LcpStatus::stalled;
        if (newton(box, tolerance) || box.residual(x) <= tolerance) return LcpStatus::solved;
    }
    return LcpStatus::iteration_limit;
}

}  // namespace knap
