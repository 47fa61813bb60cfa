#pragma once
// Exact solution of the nonsmooth problem of one fan (fan_problem.hpp) by an active set over the states of its links.
//
// In a given set of states the problem is linear (linear_fan.hpp). A link that violates its law changes its state
// (link_state.hpp); without a violation the solution is exact. States are guessed from the motion before the step, so
// that almost every problem takes one linear solve. A chain that sticks all round is decided by find_self_stress
// (self_stress.hpp). Where the states cycle (friction, degenerate ties), Lemke's method finds them (fan_lcp.hpp) and
// the active set refines the result; where it fails, combinations of states are tried. Laws that are no staircases:
// curved_fan.hpp.
#include "law/self_stress.hpp"
#include "nonsmooth/curved_fan.hpp"
#include "nonsmooth/fan_lcp.hpp"
#include "nonsmooth/linear_fan.hpp"

namespace knap {

struct FanSolution {
    enum class Status {
        exact,     // by the active set
        by_lemke,  // the active set cycled; by Lemke's method
        searched,  // Lemke's method ended without a solution; by trying the states of the links that moved
        relaxed,   // no solution (large friction can wedge): solved without restitution and friction
        failed     // no solution found
    };
    Status status = Status::exact;
    bool settled = true;  // false: cohesion that falls within the step was not found (fan_cohesion.hpp)
    bool bonded = false;  // every link sticks: the fan moves as one
    int iterations = 0;   // linear solves
    double residual = 0;  // largest violation, relative to the largest impulse or speed; at least 1 if not lawful

    bool is_lawful() const { return status != Status::relaxed && status != Status::failed; }
};

/// Keeps its workspace between solves; one per thread.
class FanSolver {
public:
    /// Slips below `rest` times the largest speed come to rest in the step instead of changing sign.
    FanSolution solve(const FanProblem& problem, FanResult& result, double rest = 0);

private:
    struct Iterate {
        std::vector<LinkState> states;  // per link
        FanMotion motion;
        double violation = 0;  // relative, of all laws and the balance
    };

    FanSolution::Status find_states_by_lemke();               // of the laws, or else of relaxed laws
    bool settle_states(int correction_limit, int& n_solves);  // the active set
    bool settle_self_stress();
    int correct_states(bool only_worst);
    bool solve_by_lemke();
    bool search_states();
    bool try_combinations(const std::vector<LinkState>& stuck, const std::vector<std::size_t>& moved, bool may_open);
    void store(FanResult& result) const;

    const FanProblem* problem_ = nullptr;
    FanScales scales_;
    Iterate now_, saved_;
    LinearFan linear_;
    FanLcp lcp_;
    CurvedFan curved_;
    std::vector<HalfPlane> planes_;
};

}  // namespace knap
