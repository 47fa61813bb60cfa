#pragma once
// Contacts that reach beyond a fan, next to the explicit bulk. Of free faces the rates are those of
// contact/face_contacts.hpp; of a corner or a point of an edge of the body, at `arm` from the origin of an obstacle
// with the velocity v and the spin w
//
//     V = (n, t) . ((1 - s) v_a + s v_b - v - w turned_left(arm))
//
// and of two obstacles the difference of their velocities. Contacts that share a fan or a free obstacle form a cluster.
// A fan whose parts stay as they are answers with the masses of its parts; the points of any other fan are solved
// together with the contacts (ContactProblem). Then each of these fans is solved by itself under the impulses
// found (vertex_solver.hpp): that is the motion that it will have, and the contacts are judged by it.
#include "nonsmooth/contact_clusters.hpp"
#include "stepper/contact/contact_row.hpp"
#include "stepper/explicit/touched_fan.hpp"

#include <span>

namespace knap {

class VertexContacts {
public:
    /// `obstacles` must outlive this.
    VertexContacts(const Model& model, const VertexSolver& solver, ObstacleStep& obstacles,
                   std::vector<Vec2>& corner_impulse)
        : model_(model), solver_(solver), obstacles_(obstacles), corner_impulse_(corner_impulse), contacts_(model) {}

    /// Finds the contacts between free faces. The fans of fans() have no end velocity before solve().
    void begin(const ExplicitStep& step, StepReport& report);
    /// Adds the contacts with obstacles that reach beyond a fan, and finds the clusters of all.
    void begin_obstacles(const ExplicitStep& step);
    std::span<const Index> fans() const { return fans_; }
    bool touches(Index fan) const { return !touched_of_fan_.empty() && touched_of_fan_[fan] >= 0; }
    std::size_t size() const { return rows_.size(); }

    /// The motion of a split fan that solve has found, if nothing can change it any more; else null: an incubation time
    /// follows.
    VertexSolver::Known* motion_of(Index rank, const ExplicitStep& step);

    /// Finds the impulses of the contacts and adds them to corner_impulse [N s]; sets `splits` [0/1] of bonded fans
    /// that do not hold them.
    void solve(const ExplicitStep& step, std::vector<std::uint8_t>& splits, std::vector<ThreadWorkspace>& workspaces,
               StepReport& report);
    /// [N s, N s, N m s] Per obstacle.
    void add_wrenches(std::vector<Vec3>& wrench) const;
    /// Works of the contacts, after the motion of all that they touch; stores their impulses in the end state, and
    /// retires points.
    void finish(const ExplicitStep& step, StepReport& report);

private:
    struct Row : ContactRow {
        double deep = infinity;  // [m] a deeper penetration is reduced by a rebound
        GivingWay gives = {};
    };
    /// On a corner; the ground, which does not move, has none.
    struct Term : CornerTerm {
        Index touched_index, place;  // place: of the corner in the touched corners of its fan
    };
    struct Cluster {
        std::span<const Index> contacts, touched, obstacles;  // obstacles: free ones
        double residual = 0;                                  // [-] of the last solution, over the speeds
        double error = 0;                                     // [m/s] of its rates
        Index worst = 0;                                      // the contact that has the residual
    };

    Index touched_index_of(Index fan);
    Index n_faces() const { return static_cast<Index>(contacts_.all().size()); }
    void add_term(const CornerTerm& term);
    void add_row(const FaceContact& contact, const ExplicitStep& step);
    void add_row(const ObstacleContact& contact, const Vec2& impulse, const ExplicitStep& step);
    void add_row(const ObstaclePairContact& contact, const ExplicitStep& step);
    void add_row(const Row& row, const State& begin);
    void settle_law(const ExplicitStep& step);
    double approach_by_forces(Index contact, const ExplicitStep& step) const;
    void find_clusters();
    void solve_cluster(Cluster& cluster, const ExplicitStep& step, std::vector<std::uint8_t>& splits,
                       ThreadWorkspace& work, StepReport& report);
    void assemble(const Cluster& cluster, const ExplicitStep& step, bool stuck_stays, ThreadWorkspace& work);
    void spread(const Cluster& cluster);
    Vec2 rate(Index contact, const State& state) const;
    Vec2 rate(Index contact) const;
    Vec2 rate_of_obstacles(Index contact) const;
    std::span<const Term> terms_of(Index contact) const {
        return {terms_.data() + first_term_[contact], terms_.data() + first_term_[contact + 1]};
    }
    std::span<const ClusterTerm> obstacle_terms_of(Index contact) const {
        return {obstacle_terms_.data() + first_obstacle_term_[contact],
                obstacle_terms_.data() + first_obstacle_term_[contact + 1]};
    }
    bool is_free(Index obstacle) const { return model_.obstacles[obstacle].is_free(); }

    const Model& model_;
    const VertexSolver& solver_;
    ObstacleStep& obstacles_;
    std::vector<Vec2>& corner_impulse_;
    FaceContacts contacts_;
    std::vector<Index> fans_;            // touched
    std::vector<TouchedFan> touched_;    // in the order of fans_; capacity for more is kept from step to step
    std::vector<Index> touched_of_fan_;  // per fan: into fans_, or -1
    std::vector<Row> rows_;              // per contact: those between free faces, then those with obstacles
    std::vector<Term> terms_;
    std::vector<ClusterTerm> obstacle_terms_;
    std::vector<std::size_t> first_term_, first_obstacle_term_;  // per contact, and the end
    std::vector<Vec3> obstacle_velocity_;  // [m/s, m/s, rad/s] per obstacle, under the present impulses
    std::vector<Index> rigid_body_;        // per free obstacle of a cluster: its number in the problem
    std::vector<std::size_t> by_corner_;   // contacts with obstacles of the step before
    std::vector<Cluster> clusters_;
    ContactClusters lists_;  // of touched fans and of free obstacles
    std::vector<StepReport> partial_;
};

}  // namespace knap
