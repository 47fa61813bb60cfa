// Proximal point method, for steps beyond Assumption 1: where softening outweighs inertia and stiffness, the rows of
// the capped unknowns (cohesion, which decreases with the openings it permits) have a negative curvature, sweeps have
// no zero to go to and Newton steps diverge. Instead
//     x_next solves the problem with  F + D (x - x_last),   D >= 0 on capped unknowns, large enough to outweigh that
//     curvature
// as a nonconvex function is minimised by convex ones that touch it from above (Rockafellar 1976; Hunter, Lange 2004).
// Such a step has several solutions; which one is found is not determined here, so a run should cut its step instead.
#include "lcp/box_solvers.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr int max_rounds = 40, sweeps_per_round = 20, newton_steps_per_round = 8;
constexpr double inner_tolerance = 1e-10;  // of a round; the last round is a Newton iteration on the problem itself

/// D by the sums of the rows: the couplings among capped unknowns, directly and through the pairs that they bound.
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

}  // namespace

LcpStatus solve_box_by_proximal_points(const BoxLcp& box, double tolerance, Eigen::VectorXd& x, int& count) {
    const Eigen::VectorXd D = majorant(box);
    BoxLcp convex = box;
    bool has_caps = false;
    for (int i = 0; i < box.size(); ++i) {
        x[i] = box.unknowns[i].is_capped() ? box.unknowns[i].upper : 0.0;
        has_caps = has_caps || box.unknowns[i].is_capped();
        if (D[i] > 0) convex.M.coeffRef(i, i) += D[i];
    }
    if (!has_caps || !convex.has_positive_diagonal()) return LcpStatus::not_applicable;
    for (int round = 0; round < max_rounds; ++round) {
        convex.q = box.q - D.cwiseProduct(x);
        sweep(convex, x, sweeps_per_round);
        count += sweeps_per_round;
        Eigen::VectorXd exact = x;
        if (solve_box_by_newton(convex, inner_tolerance, newton_steps_per_round, exact, count) == LcpStatus::solved)
            x = exact;
        if (!x.allFinite()) return LcpStatus::stalled;
        exact = x;  // are the states those of a solution of the problem itself?
        if (solve_box_by_newton(box, tolerance, newton_steps_per_round, exact, count) == LcpStatus::solved) {
            x = exact;
            return LcpStatus::solved;
        }
        if (box.residual(x) <= tolerance) return LcpStatus::solved;
    }
    return LcpStatus::iteration_limit;
}

}  // namespace knap
