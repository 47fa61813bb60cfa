#pragma once
// Exact solution of the nonsmooth problem of one fan (fan_problem.hpp) by an active set over the states of its links.
//
// In a given set of states the problem is linear: links that stick join bodies to clusters with one velocity, closed sliding links and
// open links at a kink leave one multiplier each, and the impulses follow by walking the chain. What violates its law changes state;
// without a violation the solution is exact. States are guessed from the motion before the step, so that almost every problem takes
// one linear solve. A chain that sticks all round is decided by find_circulation (circulation.hpp). Should the states cycle (friction,
// degenerate ties), Lemke's pivots find them (fan_lcp.hpp), and the active set polishes what they found.
#include "interfaces/circulation.hpp"
#include "interfaces/fan_problem.hpp"
#include "interfaces/link_law.hpp"

#include <cstdint>
#include <vector>

namespace knap {

struct FanSolution {
    enum class Status {
        exact,    // by the active set
        pivoted,  // the active set cycled; by Lemke's pivots
        relaxed,  // the laws have no solution (large friction can wedge): solved without restitution, or else without friction
        failed    // no solution found
    };
    Status status = Status::exact;
    bool bound = false;    // every link sticks: the fan moves as one
    int iterations = 0;    // linear solves
    double residual = 0;   // largest violation, relative to the largest impulse (velocities: to the largest speed); at least 1 if relaxed
};

/// Keeps its workspace between solves; one a thread. Writes end velocities into the bodies, impulses into the links.
class FanSolver {
public:
    FanSolution solve(FanProblem& problem);

private:
    struct LinkState {
        LinkLaw law;
        bool closed = false;
        bool imposed = false;  // both sides fully prescribed: nothing to decide
        bool known = false;    // its impulse does not come from the walk of the chain
        int tangential_state = 0;
        TangentialLaw tangential;
        bool holds() const { return closed && tangential.stick; }
        bool sticks() const { return holds() && !imposed; }
        bool partial() const { return closed != tangential.stick && !imposed; }
        Vec2 impulse = Vec2::Zero();
        Vec2 loose = Vec2::Zero();  // [0/1] per component: the impulse is known up to the constant c
    };

    void set_scales(const FanProblem& problem);
    void guess(const FanProblem& problem);
    void set_state(Index link, bool closed, int tangential_state);

    bool solve_states(FanProblem& problem);
    void make_clusters(const FanProblem& problem);
    bool solve_partial(const FanProblem& problem);
    void find_neighbours(const FanProblem& problem);
    double walk_chain(const FanProblem& problem);
    bool settle_circulation(const FanProblem& problem);  // false: not admissible, and the mechanism's links changed state
    int correct_states(const FanProblem& problem, bool only_worst);
    bool solve_by_pivots(const FanProblem& problem);
    bool solve_relaxed(const FanProblem& problem);
    bool settle_states(FanProblem& problem, int most_corrections, int& n_solves);  // the active set
    static double friction_part(const LinkState& state, const FanLink& link);
    void store(FanProblem& problem) const;

    Index cluster_of(Index body) const { return body < 0 ? ground_cluster_ : cluster_[body]; }
    Vec2 offset_of(Index body) const { return body < 0 ? ground_offset_ : offset_[body]; }
    Vec2 velocity_of(Index body) const { return body < 0 ? Vec2::Zero() : velocity_[body]; }
    Vec2 target(Index link) const;         // relative velocity of a link that sticks
    Vec2 known_impulse(Index link) const;  // impulse of a link that does not stick, without its multiplier

    const FanProblem* problem_ = nullptr;
    double impulse_unit_ = 1, speed_unit_ = 1, impulse_tolerance_ = 0, speed_tolerance_ = 0;
    std::vector<LinkState> links_;
    std::vector<Index> cluster_;
    std::vector<Vec2> offset_;    // velocity of a body minus that of its cluster
    std::vector<Vec2> velocity_;  // end velocity per body
    std::vector<Vec2> cluster_velocity_, cluster_inverse_mass_;
    Index ground_cluster_ = -1;
    Vec2 ground_offset_ = Vec2::Zero();
    std::vector<Index> left_, right_;    // the links of a body, or -1
    std::vector<std::uint8_t> reached_;  // links in the walk of the chain
    bool consistent_ = true;
    double violation_ = 0;
    std::vector<HalfPlane> planes_;
    std::vector<Index> partial_;
};

}  // namespace knap
