#pragma once
// The problem of one fan (fan_problem.hpp) in given states of its links: linear, and solved without a matrix of the whole fan.
//
// Links that stick join bodies to clusters with one velocity, up to known offsets. Closed sliding links and open links at a kink leave one
// multiplier each between clusters: a small dense system. The impulses of the links that stick follow by walking the chain; where
// everything sticks all round, or between two constraints, they are known up to one constant per component.
#include "interface/fan_problem.hpp"
#include "interface/link_state.hpp"

#include <cstdint>
#include <vector>

namespace knap {

struct FanMotion {
    std::vector<Vec2> velocity;  // [m/s] end velocity per body
    std::vector<Vec2> impulse;   // [N s] per link

    Vec2 velocity_of(Index body) const { return body < 0 ? Vec2::Zero() : velocity[body]; }
    Vec2 across(const FanLink& link) const { return velocity_of(link.after) - velocity_of(link.before); }
};

/// Keeps its workspace between solves. `begin` sets the problem, which must outlive the solves.
class LinearFan {
public:
    void begin(const FanProblem& problem, double speed_tolerance);

    /// False: what sticks contradicts itself or what is prescribed. `mismatch` [N s]: of the balance where it is met twice.
    bool solve(const std::vector<LinkState>& states, FanMotion& motion, double& mismatch);
    /// Impulses of the unbreakable links from all else; returns the mismatch [N s].
    double find_unbreakable_impulses(FanMotion& motion);
    /// Per component: by how much of the constant of the last walk the impulse is not known; 0 where it is.
    const Vec2& undetermined(Index link) const { return undetermined_[link]; }

private:
    /// Along `force`, holds the relative velocity along `row`.
    struct Multiplier {
        Index link, after, before;  // after, before: clusters
        Vec2 row, force;
        double wanted;  // [m/s]
    };

    /// A link as one of its bodies has it.
    struct LinkEnd {
        Index link;
        double sign;  // +1 on the body after it
    };

    void list_links();
    bool make_clusters(const std::vector<LinkState>& states);
    void apply_known_impulses(const std::vector<LinkState>& states, FanMotion& motion);
    bool prescribe_clusters();
    void list_multipliers(const std::vector<LinkState>& states);
    bool apply_multipliers(FanMotion& motion);
    double walk_chain(FanMotion& motion);
    double walk_component(int k, FanMotion& motion);
    void spread_over_loops(int k, FanMotion& motion);
    template <class Matrix>
    void find_least_norm(int k, FanMotion& motion) const;

    Index n_links() const { return static_cast<Index>(problem_->links.size()); }
    Index n_bodies() const { return static_cast<Index>(problem_->bodies.size()); }
    Index cluster_of(Index body) const { return body < 0 ? support_cluster_ : cluster_[body]; }
    Vec2 offset_of(Index body) const { return body < 0 ? support_offset_ : offset_[body]; }

    const FanProblem* problem_ = nullptr;
    double speed_tolerance_ = 0;
    std::vector<Index> first_end_;     // per body, into link_ends_
    std::vector<Index> place_;
    std::vector<LinkEnd> link_ends_;   // the links of each body: along the chain, and contacts with obstacles beside it
    std::vector<Index> cluster_;       // per body
    std::vector<Vec2> offset_;         // velocity of a body minus that of its cluster
    Index support_cluster_ = -1;
    Vec2 support_offset_ = Vec2::Zero();
    std::vector<Vec2> cluster_velocity_, cluster_inverse_mass_;
    std::vector<Multiplier> multipliers_;
    std::vector<std::uint8_t> known_, reached_;  // links: not by the walk of the chain; by it so far
    std::vector<Vec2> undetermined_;
    std::vector<Index> unknown_, balance_;       // links and bodies, where several loops meet
};

}  // namespace knap
