#pragma once
// The balance of all nodes, in Newton's method on the points: nodes that know no point are eliminated once, and the
// steps go on with the others alone (static condensation). Their own balance is linear, so it follows the steps without
// the body,
//
//     r(w + a d) = r(w) + a M_hat d,        M_hat d = -(residual) - H' D H d,
//
// and the eliminated nodes follow at the end. What rounding adds on the way, the next evaluation of the body removes.
// With few points nothing is eliminated, since every step then evaluates the body at little cost: 3 of 950 random
// bodies, whose contacts are nearly redundant, were not solved with the rounding of a condensed balance.
#include "stepper/implicit/active_point.hpp"
#include "stepper/implicit/free_motions.hpp"
#include "stepper/implicit/theta_matrix.hpp"

namespace knap {

class CondensedSystem {
public:
    static constexpr std::size_t min_points = 16;  // of a problem that is condensed, and whose fans are swept

    /// `rate` [m/s]: of the nodes. All references must outlive it.
    CondensedSystem(const Model& model, const ImplicitBulk& bulk, ThetaMatrix& matrix, std::vector<Vec2>& rate);

    /// Of these points, whose nodes the matrix knows.
    void begin(const std::vector<ActivePoint>& points);
    /// The same with a dense matrix on the nodes of the points alone. False: they are too many.
    bool begin_reduced(const std::vector<ActivePoint>& points);
    /// Directions with these motions, and without condensation, from the next begin() on; null: none.
    void use(FreeMotions* free) { free_ = free; }
    /// The rates of all nodes, changed along them by what their balance lacks. Returns the largest change [m/s].
    double move_freely(const std::vector<ActivePoint>& points);
    /// The rates have changed otherwise than by a step.
    void forget() { condensed_ = is_evaluated_ = false; }
    /// Only the near nodes are up to date.
    bool is_condensed() const { return condensed_; }

    /// residual() becomes what the bulk needs; the caller subtracts the impulses of the points.
    void evaluate();
    /// Newton's direction; the matrix is factorised. False: not found.
    bool find_direction(const std::vector<ActivePoint>& points);
    void step(double a);
    /// The rates of all nodes.
    void complete();

    const std::vector<Index>& near_nodes() const { return matrix_.near_nodes(); }
    /// [N s] per near node: r(w), which may change with the rates.
    std::vector<Vec2>& impulse() {
        is_evaluated_ = false;
        return impulse_;
    }
    std::vector<Vec2>& residual() { return residual_; }  // [N s] per node: r(w) - H' q
    const std::vector<Vec2>& residual() const { return residual_; }
    double residual(Index node) const { return matrix_.largest_free(residual_, node); }  // [N s]
    Index worst_node() const;  // with the largest residual of those that are up to date; -1: there is none
    const std::vector<Vec2>& direction() const { return direction_; }
    const std::vector<Vec2>& corner_impulse() const { return corner_impulse_; }  // [N s] r(w) per corner
    /// Of the bulk along the direction: d . r(w) and d . M_hat d.
    double slope() const;
    double curvature() const;

private:
    const ImplicitBulk& bulk_;
    ThetaMatrix& matrix_;
    std::vector<Vec2>& rate_;
    FreeMotions* free_ = nullptr;
    bool condensed_ = false;
    bool is_evaluated_ = false;  // r(w) of all nodes
    std::vector<PointSides> sides_;
    std::vector<ActingPoint> acting_;
    std::vector<Vec2> corner_impulse_, impulse_, residual_, right_side_, direction_, change_;
    std::vector<Vec2> condensed_at_;  // rates
    std::vector<Vec2> motion_;        // [m/s] per node, with free_
};

}  // namespace knap
