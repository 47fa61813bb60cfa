#pragma once
// The problem of one fan (fan_problem.hpp) in given states of its links: linear, and solved without a matrix of the
// whole fan. Closed sliding links and open links at a kink leave one multiplier each between clusters: a small dense
// system. The impulses of the links that stick follow by walking along the chain; where everything sticks all round, or
// between two constraints, they are known up to one constant per component.
#include "nonsmooth/fan_clusters.hpp"
#include "nonsmooth/link_state.hpp"

#include <span>

namespace knap {

/// Keeps its workspace between solves. `start` sets the problem, which must outlive the solves.
class LinearFan {
public:
    void start(const FanProblem& problem, double speed_tolerance);

    /// False: sticking links contradict each other or a prescribed motion. `mismatch` [N s]: largest error of the
    /// momentum balance of a body whose impulses are all known.
    bool solve(const std::vector<LinkState>& states, FanMotion& motion, double& mismatch);
    /// Impulses of the unbreakable links from the motion and the other impulses; returns the mismatch [N s].
    double find_unbreakable_impulses(FanMotion& motion);
    /// Per component: the factor of the undetermined constant in the impulse of the link; 0 where the impulse is known.
    const Vec2& undetermined(Index link) const { return undetermined_[link]; }

private:
    /// An impulse x along `force` such that the relative velocity along `row`, and compliance x, is `target` [m/s].
    struct Multiplier {
        Index link;
        Vec2 row, force;
        double target;
        double compliance = 0, unit = 1;  // [1/kg]; on a ramp `unit` x is the cohesion that is borne
    };

    /// A link at one of its bodies.
    struct LinkEnd {
        Index link;
        double sign;  // +1 at the body after it
    };

    void add_ramp(Index link, const LinkState& state, FanMotion& motion);
    bool find_multipliers(const std::vector<LinkState>& states, FanMotion& motion);
    double walk_chain(FanMotion& motion);
    double walk_component(int k, FanMotion& motion);
    void spread_over_loops(int k, FanMotion& motion);

    Index n_links() const { return static_cast<Index>(problem_->links.size()); }
    Index n_bodies() const { return static_cast<Index>(problem_->bodies.size()); }
    std::span<const LinkEnd> ends_at(Index body) const {
        return {link_ends_.data() + first_end_[body], link_ends_.data() + first_end_[body + 1]};
    }
    /// [N s] the sum of the impulses that gives a body its end velocity; passes on nothing where it is prescribed.
    double required(Index b, int k, const FanMotion& motion) const {
        const FanBody& body = problem_->bodies[b];
        return (motion.velocity[b][k] - body.free_velocity[k]) / body.inverse_mass[k];
    }

    const FanProblem* problem_ = nullptr;
    double speed_tolerance_ = 0;
    FanClusters clusters_;
    std::vector<Index> first_end_;    // per body, into link_ends_
    std::vector<LinkEnd> link_ends_;  // the links of each body: along the chain, and contacts with obstacles
    std::vector<Multiplier> multipliers_;
    std::vector<std::uint8_t> known_, reached_;  // links: before the walk of the chain; by the walk so far
    std::vector<Vec2> undetermined_;
    std::vector<Index> unknown_, balance_;  // links and bodies, where several loops meet
};

}  // namespace knap
