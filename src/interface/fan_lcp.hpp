#pragma once
// The problem of one fan (fan_problem.hpp) as a linear complementarity problem, for the fans whose active set cycles.
//
// Unbreakable links make clusters; V = W P + V_free between clusters. Every term  r in w sgn(V_T - k)  of a tangential law, w = w0 + w1 p,
// is a friction law of its own with P_T = sum (a - c)  (D. E. Stewart, J. C. Trinkle 1996):
//     0 <= p  perp  V_N - b >= 0,    0 <= a  perp  V_T - k + y >= 0,    0 <= c  perp  -(V_T - k) + y >= 0,    0 <= y  perp  w - a - c >= 0
#include "interface/fan_problem.hpp"
#include "interface/interface_law.hpp"

#include <Eigen/Core>

#include <vector>

namespace knap {

struct FanLcpSolution {
    bool solved = false;
    double residual = 0;         // of the complementarity problem, scaled
    std::vector<Vec2> velocity;  // [m/s] end velocity per body
    std::vector<Vec2> impulse;   // [N s] per link; zero for unbreakable ones
};

/// Keeps its memory from one problem to the next.
class FanLcp {
public:
    /// `laws`: one per link (not read for unbreakable ones). `speed` [m/s]: the scale of the problem.
    const FanLcpSolution& solve(const FanProblem& problem, const std::vector<InterfaceLaw>& laws, double speed);

private:
    /// One unknown impulse of the problem: its direction at its link, and how its own row reads.
    struct Row {
        enum class Kind { contact, forward, backward, slack } kind;
        Index link;
        double velocity;            // b of a contact, k of a sign
        double weight, of_contact;  // w0, w1 of the sign
    };

    void make_clusters();
    void make_rows(const std::vector<InterfaceLaw>& laws, double speed);
    void find_motion(const Eigen::Ref<const Eigen::VectorXd>& z);
    Index cluster_of(Index body) const { return body < 0 ? cluster_.back() : cluster_[body]; }
    const FanLink& link(int row) const { return problem_->links[rows_[row].link]; }
    Vec2 direction(int row) const;
    double response(Index i, const Vec2& a, Index j, const Vec2& impulse) const;
    double coefficient(int i, int j) const;
    double constant(int i) const;

    const FanProblem* problem_ = nullptr;
    // bodies that unbreakable links join move as one; the support is the last cluster
    std::vector<Index> cluster_;                                // per body
    std::vector<Vec2> mass_, inverse_mass_, free_velocity_;     // per cluster
    double speed_ = 0;          // [m/s sqrt kg] with the largest mass of the links
    std::vector<double> unit_;  // [sqrt kg] per link: scales impulses up and velocities down, so that W has a unit diagonal
    std::vector<Row> rows_;
    std::vector<double> M_, q_, z_, w_;
    FanLcpSolution found_;
};

}  // namespace knap
