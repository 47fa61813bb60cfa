#pragma once
// The matrix of Newton's step on the pieces on which the points are, M_hat + H' D H, factorised where a piece has
// changed.
//
// The loss of cohesion enters D with its sign. Where that makes the matrix indefinite (Assumption 1 is violated), it is
// left out: the iteration then majorises.
#include "stepper/implicit/active_point.hpp"
#include "stepper/implicit/theta_matrix.hpp"

#include <cstdint>
#include <vector>

namespace knap {

class NewtonMatrix {
public:
    /// All references must outlive it.
    NewtonMatrix(const Model& model, ThetaMatrix& matrix);

    /// The nodes, the step size, the mass or the springs of the points have changed.
    void forget() { states_.clear(); }
    /// False: without softening it is indefinite, too.
    bool factorise(const std::vector<ActivePoint>& points, int& n_factorisations);
    bool is_indefinite() const { return indefinite_; }  // with softening, at the last factor
    /// What the factor has of it.
    Softening softening() const { return indefinite_ ? Softening::none : Softening::now; }
    /// Softening outweighs inertia and stiffness at the solution: Assumption 1 does not hold there.
    /// (With the descending branches of all points that lost cohesion in the step.)
    bool violates_assumption_1(const std::vector<ActivePoint>& points);

private:
    void make_tangents(const std::vector<ActivePoint>& points, Softening softening);

    ThetaMatrix& matrix_;
    std::vector<std::uint32_t> states_;  // pieces of the laws in the factor
    std::vector<PointTangent> tangents_;
    bool indefinite_ = false;
};

}  // namespace knap
