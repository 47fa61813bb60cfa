#pragma once
// The problem of one fan (fan_problem.hpp) as a linear complementarity problem, for the fans whose active set cycles.
//
// Unbreakable links make clusters; V = W P + V_free between clusters. Every term  r in w sgn(V_T - k)  of a tangential
// law, w = w0 + w1 p, is a friction law of its own with P_T = sum (a - c)  (D. E. Stewart, J. C. Trinkle 1996):
//     0 <= p  perp  V_N - b >= 0,               0 <= a  perp  V_T - k + y >= 0,
//     0 <= c  perp  -(V_T - k) + y >= 0,        0 <= y  perp  w - a - c >= 0
#include "interface/fan_clusters.hpp"
#include "interface/link_state.hpp"

#include <Eigen/Core>

#include <optional>

namespace knap {

/// Keeps its memory from one problem to the next.
class FanLcp {
public:
    /// The residual of the scaled complementarity problem, and the motion, in which impulses of unbreakable links are
    /// zero. Nothing where Lemke's paths end without a solution. Reads the law of each state (of unbreakable links
    /// not). `speed` [m/s]: the scale of the problem.
    std::optional<double> solve(const FanProblem& problem, const std::vector<LinkState>& states, double speed,
                                FanMotion& motion);

private:
    /// One unknown impulse of the problem, and its row.
    struct Row {
        enum class Kind { contact, forward, backward, slack } kind;
        const FanLink* link;
        Vec2 direction;             // of the impulse
        double rate;                // [m/s] b of a contact, k of a sign
        double cohesive, friction;  // [N s], [-] w0, w1 of a sign
        double unit;                // [sqrt kg] scales impulses up and velocities down: W has a unit diagonal
    };

    double add_rows(const FanLink& link, const InterfaceLaw& law);  // returns unit^2
    double coefficient(const Row& row, const Row& column) const;

    FanClusters clusters_;  // joined by unbreakable links
    std::vector<Row> rows_;
    std::vector<double> M_, q_, z_, w_;
};

}  // namespace knap
