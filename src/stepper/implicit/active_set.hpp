#pragma once
// The primal-dual active set of an implicit step: Newton's method on the laws themselves. An augmentation of the size
// of inertia and stiffness shows on which piece of its law a point is; a step solves the equations of these pieces, on
// stiff springs, with multipliers that follow at once. (Stiff springs would stop it at the first point that changes
// its piece.) Multipliers that follow slowly or march are extrapolated (MultiplierSeries), the points of a few fans
// that cycle are solved in addition (LocalPoints), or their friction lags (LaggedFriction).
// (S. Hueber, G. Stadler, B. Wohlmuth, SIAM J. Sci. Comput. 30, 2008, from memory)
#include "stepper/implicit/lagged_friction.hpp"
#include "stepper/implicit/line_search.hpp"
#include "stepper/implicit/local_points.hpp"
#include "stepper/implicit/multiplier_series.hpp"
#include "stepper/implicit/newton_iteration.hpp"

namespace knap {

class ActiveSet {
public:
    enum class Result { found, nearly, cycling };

    /// All references must outlive this.
    ActiveSet(const Model& model, ThetaMatrix& matrix, NewtonIteration& newton, LineSearch& line_search);

    /// From the present iterate; with friction it may begin once more from `first`, all friction lagging.
    Result find(bool friction, const Iterate& first);

private:
    /// What follows an iterate.
    enum class Checkpoint {
        move,      // Newton's step
        complete,  // the nodes that the condensed system left out, and one more look at the whole body
        restart,   // from the first guess, all friction lagging
        solved,
        given_up
    };

    void begin();
    void begin_anew();
    void evaluate();
    Checkpoint judge();
    Checkpoint find_direction(int i);
    void restart(const Iterate& first);
    void find_moves();
    void move();

    ThetaMatrix& matrix_;
    NewtonIteration& newton_;
    LineSearch& line_search_;
    LocalPoints local_;
    LaggedFriction lag_;
    MultiplierSeries series_;
    std::vector<std::uint32_t> pieces_;  // per point
    std::vector<Vec2> moves_;            // [N s] per point, (N, T): of its multipliers

    bool friction_ = false;
    double unit_ = 1;                         // [N s] scale of the impulses, with those of contacts
    double norm_ = 0;                         // [N s] balance
    double last_norm_ = 0;                    // [N s] one step before
    double best_ = 0;                         // [N s] the smallest one
    double whole_ = 0;                        // [N s] that of the whole body after the last completion
    double longest_move_ = 0;                 // [N s] of the multipliers in the last step
    std::size_t n_changed_ = 0, fewest_ = 0;  // points that changed their piece: now, at least
    int n_found_ = 0;                         // looks that met the tolerance; two end it
    int stalled_ = 0;                         // steps that led no nearer
    int marching_ = 0;                        // steps whose multipliers moved as the ones before
    bool completed_ = false;                  // the last step has completed the condensed system
    bool is_series_ = false;                  // the moves of the multipliers are extrapolated
    bool may_restart_ = false;
};

}  // namespace knap
