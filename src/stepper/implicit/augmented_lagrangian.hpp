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
// them. With friction an active set (active_set.hpp), whose multipliers follow in every Newton step, is asked first;
// multipliers that follow slowly or march are extrapolated (MultiplierSeries). Newton steps that return to an iterate
// end (NewtonCycle).
// (D. Bertsekas, Constrained Optimization and Lagrange Multiplier Methods, 1982; B. Hermans, A. Themelis, P. Patrinos,
// QPALM, Math. Prog. Comp. 2022, for the exact line search and the proximal Newton step.)
#include "stepper/implicit/active_set.hpp"
#include "stepper/implicit/fan_sweep.hpp"
#include "stepper/implicit/interior_point.hpp"
#include "stepper/implicit/newton_cycle.hpp"

#include <algorithm>

namespace knap {

/// With friction Newton's method may cycle through the pieces of the laws, round after round.
enum class Effort { little, all };

class AugmentedLagrangian {
public:
    /// Solves for `iterate`; all references must outlive the solver.
    AugmentedLagrangian(const Model& model, const ImplicitBulk& bulk, ThetaMatrix& matrix, Iterate& iterate);

    /// The nodes, the step size or the mass have changed.
    void forget_factor() { newton_.newton_matrix.forget(); }

    /// From an initial guess in `iterate` to the solution; false: not converged. Scale of impulses [N s]: `scale` is
    /// known beforehand, contact impulses may raise it to `largest_scale`.
    bool solve(double scale, double largest_scale, Effort effort, Precision precision);
    bool is_preliminary() const { return newton_.is_preliminary(); }  // of the last solution

    /// Contact impulses grew without bound in several attempts: a body is driven against itself.
    bool is_jammed() const { return n_jams_ >= max_jams; }
    Rejection rejection() const { return is_jammed() ? Rejection::jammed : Rejection::not_converged; }

    /// Of the problems that follow (free_motions.hpp); null: none.
    void use(FreeMotions* free) { newton_.system.use(free), newton_.newton_matrix.forget(); }
    /// The motion along them whose balance the solution lacks: its largest rate [m/s].
    double move_freely();

    /// The residual of the solution, with the impulses of its points, after the equations of the body have changed.
    void evaluate_body();

    /// One step of Newton's method from there: a solution that met its tolerance without one has an error of that size,
    /// which adds up from step to step.
    void refine();

    /// [N s] Of the balance, from now on: its equations will change.
    void set_coarse_goal(double goal) { newton_.coarse_goal = goal; }

    void give_up_when(GiveUp condition) { newton_.given_up = condition; }
    const SolverCounts& counts() const { return newton_.counts; }
    double unit() const { return newton_.unit; }  // [N s] scale of the tolerances
    bool violates_assumption_1() { return newton_.newton_matrix.violates_assumption_1(newton_.x.points); }
    Index worst_node() const {  // of the largest residual, or of the contact that jams
        return is_jammed() ? jammed_node_ : std::max(Index{0}, newton_.system.worst_node());
    }
    const std::vector<Vec2>& corner_impulse() const {
        return newton_.system.corner_impulse();
    }  // [N s] r(w) per corner
    /// [N s] r(w) - H' q per node: the reaction in prescribed components.
    const std::vector<Vec2>& residual_impulse() const { return newton_.system.residual(); }
    double residual() const { return newton_.residual(); }  // [N s] the largest one of free components

private:
    static constexpr int max_jams = 3;

    /// How an attempt ended: after some of them the next one goes on, after others nothing helps.
    enum class Outcome { solved, cycling, jammed };
    /// What the points are, which decides what is tried.
    struct Kind {
        bool friction = false, obstacles = false, faces = false, curved = false;
        bool has_pieces = false;  // the active set is tried
    };

    bool solve_with_cohesion_kept(Effort effort, Precision precision);
    void keep_cohesion(bool keeps);
    bool solve_from_first(Effort effort, Precision precision);
    bool solve_on_points_alone();
    bool solve_by_pieces();
    bool solve_from_inside();
    Outcome alternate_with_friction(Effort effort);
    bool solve_with_other_augmentations();
    bool find_pieces();
    bool attempt(int max_steps);
    void begin_again();
    bool find_solution(int max_steps);
    bool find_multipliers(double goal, double first_tolerance, int max_steps);
    bool continue_penalties(double tolerance);
    bool find_rates(double tolerance, int max_steps);
    bool iterate_friction();
    void evaluate();
    void complete_and_evaluate();
    void sweep_fans();
    double update_multipliers();

    const ImplicitBulk& bulk_;
    ThetaMatrix& matrix_;
    NewtonIteration newton_;
    FanSweep fans_;
    LineSearch line_search_;
    ActiveSet active_set_;
    InteriorPoint interior_point_;
    MultiplierSeries series_;
    NewtonCycle cycle_;
    Kind kind_;
    bool sweeps_ = false;                                    // of the fans between Newton's steps, and the active set
    ActiveSet::Result pieces_ = ActiveSet::Result::cycling;  // of its last attempt
    Iterate completed_, found_;                              // in find_solution, of the active set
    Iterate before_, first_;                                 // at the start of an attempt, of the step
    double first_unit_ = 1;                                  // [N s] scale of the impulses at the start of the step
    std::vector<Vec2> move_;                                 // [N s] per point, (N, T): of its multipliers
    int n_jams_ = 0;                                         // attempts whose contact impulses grew without bound
    Index jammed_node_ = 0;
};

}  // namespace knap
