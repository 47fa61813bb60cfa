#pragma once
// The problem of one fan (fan_problem.hpp) whose laws are no staircases: every link has a projection (law/row_law.hpp).
// Newton's method for the impulses, from which the velocities follow, v = v_free + M^-1 H' P:
//
//     M dv = H' dP,     (I - (1 - eps) slope) dP + r slope H dv = project(P - r V) - P     per link
//
// The impulses are eliminated link by link. eps keeps the matrix definite where links that stick are redundant, as all
// round a vertex: it leaves a part eps of their errors from step to step, and what is undetermined in their impulses
// stays near that of the last step. Where these steps do not settle, the method of multipliers comes nearer; where
// friction keeps it from that, the solution is followed while friction grows from none, then friction is bounded by the
// pressures found before (Tresca), which has a potential, and then links are swept. At last bodies that links hold
// together get one velocity, to the bit.
#include "nonsmooth/fan_clusters.hpp"
#include "nonsmooth/link_state.hpp"

#include <Eigen/Core>

namespace knap {

/// Keeps its memory from one problem to the next.
class CurvedFan {
public:
    struct Found {
        int iterations = 0;
        double residual = 0;  // of the laws, relative
        bool bonded = false;  // every link sticks
    };
    /// `scales` as of the fan solver. The search starts from FanLink::last_impulse.
    Found solve(const FanProblem& problem, const FanScales& scales, FanResult& result);

private:
    struct Row {
        NormLaw law;  // not of an unbreakable link
        bool unbreakable = false;
        double r = 0;                 // [kg] of its projection
        Vec2 impulse = Vec2::Zero();  // [N s] (N, T)
        double pressed = 0;           // [N s] the compression that a lagging friction sees
    };

    /// Of a body: of its own rate, and of those of the next body and the last one, in its row and in theirs.
    struct Block {
        Eigen::Matrix2d own = Eigen::Matrix2d::Zero(), to_next = own, from_next = own, to_last = own, from_last = own;
    };

    void start();
    NormLaw::Response respond(std::size_t i, double weight) const;
    void find_velocities();
    void apply(std::size_t i, const Vec2& impulse);
    double settle(double weight, int most, int& iterations);
    bool step(double weight);
    void approach();
    void lag_friction();
    void sweep(double worse);
    void follow_friction(bool from_minimum, int& iterations);
    void search(int& iterations);
    void get_impulses(std::vector<Vec2>& impulses) const;
    void set_impulses(const std::vector<Vec2>& impulses);
    double find_gaps(double weight);
    void find_lack(double weight);
    void add_force(std::size_t i, const Vec2& impulse);
    bool find_change();
    void join_what_sticks();
    Vec2 rate(std::size_t i) const { return rate(i, motion_); }
    Vec2 rate(std::size_t i, const FanVelocities& motion) const;
    Eigen::Matrix2d mobility(std::size_t i) const;

    const FanProblem* problem_ = nullptr;
    FanScales scales_;
    std::vector<Row> rows_;  // per link
    std::vector<RowLaw::Projection> at_;
    std::vector<Vec2> best_, impulse_;  // [N s] (N, T); (x, y)
    std::vector<std::uint8_t> known_;
    std::vector<Eigen::Matrix2d> flexible_, stiff_;  // [-], [kg] per link: dP = flexible_ gap - stiff_ dV
    std::vector<Vec2> force_;                        // [N s] per body
    std::vector<Block> blocks_;                      // [kg] likewise
    FanVelocities motion_, change_;
    FanClusters clusters_;
};

}  // namespace knap
