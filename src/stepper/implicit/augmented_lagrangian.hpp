#pragma once
// All active interface points of the body at once: the equations of implicit_scheme.hpp by the method of multipliers,
// with a semismooth Newton method inside.
//
//     r(w) = H' q(w; multipliers),        multipliers <- q(w)        until they no longer change
//
// For given multipliers the points are piecewise linear springs (law/point_law.hpp), so every Newton step is one
// linear system M_hat + H' D H with a definite D, also where points are redundant round a vertex. Without friction and
// inside Assumption 1 the equations are the gradient of a convex function: a step length that zeroes the slope along
// the step makes Newton's method converge from any start. Where the loss of cohesion makes the matrix indefinite
// (NewtonMatrix), the iteration majorises. It starts from beta at the start of the step and lowers it only as far as
// the openings require, so it never breaks a point below its strength.
//
// Between Newton's steps the fans are swept one by one (FanSweep), so that the step length is not bound by the worst of
// them. With friction a primal-dual active set (find_pieces), whose multipliers follow in every Newton step, is asked
// first; multipliers that follow slowly or march are extrapolated (MultiplierSeries), the points of a few fans that
// cycle are solved in addition (LocalPoints), or their friction lags (LaggedFriction). Newton steps that return to an
// iterate end (NewtonCycle).
// (S. Hueber, G. Stadler, B. Wohlmuth, SIAM J. Sci. Comput. 30, 2008, from memory; D. Bertsekas, Constrained
// Optimization and Lagrange Multiplier Methods, 1982; B. Hermans, A. Themelis, P. Patrinos, QPALM, Math. Prog. Comp.
// 2022, for the exact line search and the proximal Newton step.)
#include "stepper/common/step_scheme.hpp"
#include "stepper/implicit/condensed_system.hpp"
#include "stepper/implicit/fan_sweep.hpp"
#include "stepper/implicit/lagged_friction.hpp"
#include "stepper/implicit/line_search.hpp"
#include "stepper/implicit/local_points.hpp"
#include "stepper/implicit/multiplier_series.hpp"
#include "stepper/implicit/newton_cycle.hpp"
#include "stepper/implicit/newton_matrix.hpp"

#include <algorithm>

namespace knap {

/// With friction Newton's method may cycle through the pieces of the laws, round after round.
enum class Effort { little, all };

/// Preliminary: tells which bonded fans open, at a part of the price. Problems of few points are solved to the end.
enum class Precision { preliminary, full };

struct SolverCounts {
    int factorisations = 0, linear_solves = 0;
    void add_to(StepReport& report) const {
        report.factorisations += factorisations, report.linear_solves += linear_solves;
    }
};

/// Unknowns of a step: rates of the nodes [m/s], and the points with their multipliers.
struct Iterate {
    std::vector<Vec2> rate;
    std::vector<ActivePoint> points;  // those of a fan in succession
};

class AugmentedLagrangian {
public:
    /// Solves for `iterate`; all references must outlive the solver.
    AugmentedLagrangian(const Model& model, const ImplicitBulk& bulk, ThetaMatrix& matrix, Iterate& iterate);

    /// The nodes, the step size or the mass have changed.
    void forget_factor() { newton_matrix_.forget(); }

    /// From an initial guess in `iterate` to the solution; false: not converged. Scale of impulses [N s]: `scale` is
    /// known beforehand, contact impulses may raise it to `largest_scale`.
    bool solve(double scale, double largest_scale, Effort effort, Precision precision);
    bool is_preliminary() const { return precision_ == Precision::preliminary; }  // of the last solution

    /// Contact impulses grew without bound in several attempts: a body is driven against itself.
    bool is_jammed() const { return n_jams_ >= max_jams; }
    Rejection rejection() const { return is_jammed() ? Rejection::jammed : Rejection::not_converged; }

    /// Of the problems that follow (free_motions.hpp); null: none.
    void use(FreeMotions* free) { system_.use(free), newton_matrix_.forget(); }
    /// The motion along them whose balance the solution lacks: its largest rate [m/s].
    double move_freely();

    void give_up_when(GiveUp condition) { given_up_ = condition; }
    const SolverCounts& counts() const { return counts_; }
    double unit() const { return unit_; }  // [N s] scale of the tolerances
    bool violates_assumption_1() { return newton_matrix_.violates_assumption_1(x_.points); }
    Index worst_node() const {  // of the largest residual, or of the contact that jams
        return is_jammed() ? jammed_node_ : std::max(Index{0}, system_.worst_node());
    }
    const std::vector<Vec2>& corner_impulse() const { return system_.corner_impulse(); }  // [N s] r(w) per corner
    /// [N s] r(w) - H' q per node: the reaction in prescribed components.
    const std::vector<Vec2>& residual_impulse() const { return system_.residual(); }
    double residual() const {  // [N s] the largest one of free components
        const Index worst = system_.worst_node();
        return worst < 0 ? 0 : system_.residual(worst);
    }

private:
    static constexpr int max_jams = 3;
    static constexpr double law_goal = 1e-13;         // of the scale: natural residual of the laws
    static constexpr double law_tolerance = 5e-11;    // likewise, where rounding prevents more
    static constexpr double preliminary_goal = 1e-4;  // of the laws and of the balance
    /// [N s] of the balance, for a scale of the impulses.
    double balance_goal(double unit) const {
        return std::max(1e-12 * unit, 4e-18 * final_augmentation_ * bulk_.largest_impulse());
    }
    enum class Pieces { found, nearly, cycling };
    Pieces find_pieces(bool friction);
    std::size_t evaluate_pieces();
    void restart_from(const Iterate& iterate);
    bool find_solution(int max_steps);
    bool find_multipliers(double goal, double first_tolerance, int max_steps);
    bool continue_penalties(double tolerance);
    bool find_rates(double tolerance, int max_steps);
    bool iterate_friction();
    void evaluate();
    void complete_and_evaluate();
    void sweep_fans();
    bool find_direction();
    double update_multipliers();
    void set_augmentation(double augmentation);

    const ImplicitBulk& bulk_;
    ThetaMatrix& matrix_;
    Iterate& x_;
    CondensedSystem system_;
    NewtonMatrix newton_matrix_;
    FanSweep fans_;
    Precision precision_ = Precision::full;
    bool sweeps_ = false;  // of the fans between Newton's steps, and the active set
    LineSearch line_search_;
    LocalPoints local_;
    LaggedFriction lag_;
    MultiplierSeries series_;
    NewtonCycle cycle_;
    Iterate completed_;                  // in find_solution
    Iterate before_, first_;             // at the start of an attempt, of the step
    double final_augmentation_ = 0;      // of the attempt
    double augmentation_ = 0;            // with which the matrix is factorised
    std::vector<Vec2> move_;             // [N s] per point, (N, T): of its multipliers
    std::vector<std::uint32_t> pieces_;  // per point, in find_pieces
    SolverCounts counts_;
    GiveUp given_up_ = nullptr;
    double unit_ = 1, largest_unit_ = 1;
    int n_jams_ = 0;  // attempts whose contact impulses grew without bound
    Index jammed_node_ = 0;
};

}  // namespace knap
