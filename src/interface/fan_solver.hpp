#pragma once
// Exact solution of the nonsmooth problem of one fan (fan_problem.hpp) by an active set over the states of its links.
//
// In a given set of states the problem is linear (linear_fan.hpp). What violates its law changes state (link_state.hpp); without a
// violation the solution is exact. States are guessed from the motion before the step, so that almost every problem takes one linear
// solve. A chain that sticks all round is decided by find_self_stress (self_stress.hpp). Should the states cycle (friction, degenerate
// ties), Lemke's pivots find them (fan_lcp.hpp), and the active set polishes what they found; where they give up, states are searched.
#include "interface/fan_lcp.hpp"
#include "interface/fan_problem.hpp"
#include "interface/fan_scales.hpp"
#include "interface/linear_fan.hpp"
#include "interface/link_state.hpp"
#include "interface/self_stress.hpp"

#include <vector>

namespace knap {

struct FanSolution {
    enum class Status {
        exact,    // by the active set
        pivoted,  // the active set cycled; by Lemke's pivots
        searched,  // the pivots ended without one; by trying the states of the links that moved
        relaxed,  // the laws have no solution (large friction can wedge): solved without restitution, or else without friction
        failed    // no solution found
    };
    Status status = Status::exact;
    bool settled = true;   // false: cohesion that falls within the step was not found (fan_cohesion.hpp)
    bool bonded = false;   // every link sticks: the fan moves as one
    int iterations = 0;    // linear solves
    double residual = 0;   // largest violation, relative to the largest impulse (velocities: to the largest speed); at least 1 if relaxed
};

/// Keeps its workspace between solves; one a thread. Writes end velocities into the bodies, impulses into the links.
class FanSolver {
public:
    /// Slips below `rest` times the largest speed come to rest in the step instead of turning round.
    FanSolution solve(FanProblem& problem, double rest = 0);

private:
    void save();     // what has been found so far
    void restore();  // to it

    FanSolution::Status find_states_by_lemke();  // of the laws, or else of relaxed laws
    FanSolution::Status improve_by_lemke();      // of a solution that is not as exact as usual
    bool settle_states(int correction_limit, int& n_solves);  // the active set
    bool settle_self_stress();  // false: no constant of the undetermined impulses is admissible, and the mechanism's links changed state
    int correct_states(bool only_worst);
    bool solve_by_lemke();
    bool search_states();
    bool try_combinations(const std::vector<LinkState>& stuck, const std::vector<std::size_t>& moved, bool may_open);
    void store(FanProblem& problem) const;

    const FanProblem* problem_ = nullptr;
    FanScales scales_;
    std::vector<LinkState> states_;  // per link
    LinearFan linear_;
    FanMotion motion_;
    double violation_ = 0;  // relative, of all laws and the balance
    std::vector<LinkState> saved_states_;
    FanMotion saved_motion_;
    double saved_violation_ = 0;
    std::vector<HalfPlane> planes_;
    std::vector<InterfaceLaw> laws_;  // per link
    FanLcp lcp_;
};

}  // namespace knap
