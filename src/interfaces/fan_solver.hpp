#pragma once
// Exact solution of the nonsmooth problem of one fan (fan_problem.hpp) by an active set over the states of its links.
//
// In a given set of states the problem is linear: links that stick join bodies to clusters with one velocity, closed sliding links and
// open links at a kink leave one multiplier each, and the impulses follow by walking the chain. What violates its law changes state;
// without a violation the solution is exact. States are guessed from the motion before the step, so that almost every problem takes
// one linear solve. A chain that sticks all round is decided by find_circulation (circulation.hpp). Should the states cycle (friction,
// degenerate ties), Gauss-Seidel sweeps find them, and the active set polishes what they found.
#include "interfaces/circulation.hpp"
#include "interfaces/fan_problem.hpp"
#include "interfaces/link_law.hpp"

#include <vector>

namespace knap {

struct FanSolution {
    enum class Status {
        exact,     // no law violated
        iterated,  // by Gauss-Seidel sweeps, to their tolerance
        failed     // residual above the tolerance of the sweeps
    };
    Status status = Status::exact;
    bool bound = false;    // every link sticks: the fan moves as one
    int iterations = 0;    // linear solves
    double residual = 0;   // largest violation, relative to the largest impulse (velocities: to the largest speed)
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
        int tangential_state = 0;
        TangentialLaw tangential;
        bool sticks() const { return closed && tangential.stick; }
        bool partial() const { return closed != tangential.stick; }
        Vec2 impulse = Vec2::Zero();
    };

    void set_scales(const FanProblem& problem);
    void guess(const FanProblem& problem);
    void set_state(Index link, bool closed, int tangential_state);

    bool solve_states(FanProblem& problem);
    void make_clusters(const FanProblem& problem);
    bool solve_partial(const FanProblem& problem);
    double walk_chain(const FanProblem& problem);
    bool settle_circulation(const FanProblem& problem);  // false: not admissible, and the mechanism's links changed state
    int correct_states(const FanProblem& problem, bool only_worst);
    bool sweep(FanProblem& problem);
    static double friction_part(const LinkState& state, const FanLink& link);
    void store(FanProblem& problem) const;

    Index cluster_of(Index body) const { return body < 0 ? ground_cluster_ : cluster_[body]; }
    Vec2 offset_of(Index body) const { return body < 0 ? ground_offset_ : offset_[body]; }
    Vec2 velocity_of(Index body) const { return body < 0 ? Vec2::Zero() : velocity_[body]; }
    Vec2 target(Index link) const;         // relative velocity of a link that sticks
    Vec2 known_impulse(Index link) const;  // impulse of a link that does not stick, without its multiplier

    const FanProblem* problem_ = nullptr;
    double impulse_scale_ = 0, speed_scale_ = 0, impulse_tolerance_ = 0, speed_tolerance_ = 0;
    std::vector<LinkState> links_;
    std::vector<Index> cluster_;
    std::vector<Vec2> offset_;    // velocity of a body minus that of its cluster
    std::vector<Vec2> velocity_;  // end velocity per body
    std::vector<Vec2> cluster_velocity_, cluster_inverse_mass_;
    Index ground_cluster_ = -1;
    Vec2 ground_offset_ = Vec2::Zero();
    bool sticks_all_round_ = false, consistent_ = true;
    double violation_ = 0;
    std::vector<HalfPlane> planes_;
    std::vector<Index> partial_;
};

}  // namespace knap
