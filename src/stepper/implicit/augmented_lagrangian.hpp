#pragma once
// All active interface points of the body at once: the equations of implicit_scheme.hpp by the method of multipliers with a semismooth
// Newton method inside.
//
//     bulk_impulse(w) = H' q(w; multipliers),        multipliers <- q(w)        until they stand still
//
// For given multipliers the points are piecewise linear springs (interface/point_law.hpp), so every Newton step is one linear system
// M_hat + H' D H with a definite D, also where points are redundant round a vertex. Without friction and inside Assumption 1 the equations
// are the gradient of a convex function: a step length that zeroes the slope along the step makes Newton's method converge from anywhere.
// The loss of cohesion enters D with its sign. Where that makes the matrix indefinite (Assumption 1 is violated), it is left out: then the
// iteration majorises, beta falls only as far as the openings ask for, starting from the beta of the begin; it never breaks what holds.
// (D. Bertsekas, Constrained Optimization and Lagrange Multiplier Methods, 1982; B. Hermans, A. Themelis, P. Patrinos, QPALM, Math. Prog.
// Comp. 2022, for the exact line search and the proximal Newton step.)
#include "stepper/common/step_scheme.hpp"
#include "stepper/implicit/active_point.hpp"
#include "stepper/implicit/implicit_bulk.hpp"
#include "stepper/implicit/multiplier_extrapolation.hpp"
#include "stepper/implicit/theta_matrix.hpp"

#include <vector>

namespace knap {

struct SolverCounts {
    int factorisations = 0, linear_solves = 0;
};

class AugmentedLagrangian {
public:
    enum class Status { solved, not_converged };

    AugmentedLagrangian(const Model& model, ThetaMatrix& matrix);

    /// The pattern or the values of the matrix without points have changed.
    void forget_factor() { factored_states_.clear(); }

    /// From a guess of the rates and of the multipliers to the solution. Impulses that matter [N s]: `scale` those that are known beforehand,
    /// `largest_scale` the most that contacts may make of it.
    Status solve(const ImplicitBulk& bulk, std::vector<ActivePoint>& points, std::vector<Vec2>& rate, double scale, double largest_scale);

    void give_up_when(GiveUp asked) { given_up_ = asked; }
    const SolverCounts& counts() const { return counts_; }
    double unit() const { return unit_; }  // [N s] the scale, or the largest contact impulse, unless it is jammed
    /// The softening of the solution outweighs inertia and stiffness: Assumption 1 does not hold there.
    /// (Judged with the descending branches of all points that lost cohesion in the step.)
    bool has_several_solutions(const std::vector<ActivePoint>& points);
    Index worst_node() const;  // with the largest residual: where it did not converge
    const std::vector<Vec2>& corner_impulse() const { return corner_impulse_; }  // [N s] by the bulk, at the last rates
    const std::vector<Vec2>& residual_impulse() const { return residual_; }  // [N s] per node: reactions of what is prescribed

private:
    bool approach(const ImplicitBulk& bulk, std::vector<ActivePoint>& points, std::vector<Vec2>& rate, double tolerance);
    bool settle(const ImplicitBulk& bulk, std::vector<ActivePoint>& points, std::vector<Vec2>& rate, double goal, int max_steps);
    void find_friction(const ImplicitBulk& bulk, std::vector<ActivePoint>& points, std::vector<Vec2>& rate);
    bool find_rates(const ImplicitBulk& bulk, std::vector<ActivePoint>& points, std::vector<Vec2>& rate, double tolerance,
                    int max_steps);
    void evaluate(const ImplicitBulk& bulk, std::vector<ActivePoint>& points, const std::vector<Vec2>& rate);
    double residual(Index node) const;  // [N s] of its free components
    void make_tangents(const std::vector<ActivePoint>& points, Softening softening);
    bool prepare_matrix(const std::vector<ActivePoint>& points);
    double step_length(const std::vector<ActivePoint>& points, const std::vector<Vec2>& direction, const std::vector<Vec2>& changed);
    double move_multipliers(std::vector<ActivePoint>& points) const;
    void augment(std::vector<ActivePoint>& points, double augmentation);

    ThetaMatrix& matrix_;
    std::vector<std::uint32_t> factored_states_;  // the pieces of the points for which the matrix is factorised
    double settled_augmentation_ = 0;             // of the attempt
    double augmentation_ = 0;                     // with which the matrix is factorised
    bool indefinite_ = false;
    std::vector<PointTangent> tangents_;
    std::vector<Vec2> corner_impulse_, bulk_impulse_, residual_, downhill_, direction_, changed_;
    std::vector<Vec2> turn_, last_multipliers_;  // per point
    std::vector<ActivePoint> points_before_;
    std::vector<Vec2> rate_before_;
    std::vector<ActivePoint> first_points_;
    std::vector<Vec2> first_rate_;
    MultiplierExtrapolation extrapolation_;
    SolverCounts counts_;
    GiveUp given_up_ = nullptr;
    double unit_ = 1, largest_unit_ = 1;
};

}  // namespace knap
