#pragma once
// Free faces of the body that meet, next to the explicit bulk. A contact between a boundary vertex and a boundary edge
// acts on up to four corners; its impulses P have no resultant force and no resultant moment:
//
//     V_N = n . (v_i - (1 - s) v_a - s v_b),                    the rate of the gap g
//     V_T = t . (v_i - (1 - s) v_a - s v_b) + (g/L) n . (v_b - v_a),      slip past the material point
//
// v_i is the mean of the two corners at the vertex. Contacts that share a fan form a cluster. A fan whose parts stay as
// they are answers with the masses of its parts; the points of any other fan are solved together with the contacts
// (contact_problem.hpp). Then each of these fans is solved by itself under the impulses found (vertex_solver.hpp): that
// is the motion that it will have, and the contacts are judged by it.
#include "stepper/contact/face_contacts.hpp"
#include "stepper/explicit/thread_workspace.hpp"

#include <span>

namespace knap {

class VertexContacts {
public:
    VertexContacts(const Model& model, const VertexSolver& solver, std::vector<Vec2>& corner_impulse)
        : model_(model), solver_(solver), corner_impulse_(corner_impulse), contacts_(model) {}

    /// Finds the contacts of the step. The fans of fans() have no end velocity before solve().
    void begin(const ExplicitStep& step, StepReport& report);
    std::span<const Index> fans() const { return fans_; }
    bool touches(Index fan) const { return !slot_of_fan_.empty() && slot_of_fan_[fan] >= 0; }
    std::size_t size() const { return contacts_.all().size(); }

    /// The motion of a split fan that solve has found, if nothing can change it any more; else null: others couple it,
    /// or an incubation time follows.
    VertexSolver::Known* motion_of(Index rank, const ExplicitStep& step);

    /// Sets aside the clusters with a fan that others couple: is_coupled(fan).
    template <class IsCoupled>
    void set_aside(const IsCoupled& is_coupled) {
        for (Cluster& cluster : clusters())
            cluster.is_aside = std::ranges::any_of(cluster.slots, [&](Index s) { return is_coupled(fans_[s]); });
    }
    /// Finds the impulses of the contacts, in the clusters that are set aside or in the others, and adds them to
    /// corner_impulse [N s]; sets `splits` [0/1] of bonded fans that do not hold them. Returns the change of the
    /// impulses [-], of the largest one.
    double solve(const ExplicitStep& step, bool aside, std::vector<std::uint8_t>& splits,
                 std::vector<ThreadWorkspace>& workspaces, StepReport& report);
    Vec2 place_of(Index contact, const State& state) const;  // [m]
    /// Works of the contacts; stores their impulses in the end state, and retires points.
    void finish(const ExplicitStep& step, StepReport& report);

private:
    /// A contact acts on a corner: V = sum of (along_N . v, along_T . v), up to four terms a contact; the ground, which
    /// does not move, has none.
    struct Term {
        Index contact, slot, place;  // place: of the corner in the touched corners of its fan
        Vec2 along_N, along_T;

        Vec2 rate(const Vec2& v) const { return {along_N.dot(v), along_T.dot(v)}; }  // [m/s] its part of V
    };
    struct TouchedFan {
        Index fan;
        bool is_soft = false;        // its points are solved with the contacts
        bool is_aside = false;       // as its cluster
        std::vector<Index> corners;  // touched
        std::vector<Index> part;     // per corner of a fan that is not soft
        std::vector<Index> body;     // per touched corner: its number in the problem
        std::vector<Vec2> velocity;  // [m/s] per touched corner, under the present impulses
        VertexSolver::Known known;   // soft: under these impulses
    };
    struct Cluster {
        std::vector<Index> contacts, slots;
        bool is_aside = false;
        double residual = 0;  // [-] of the last solution, over the speeds
    };

    std::span<Cluster> clusters() { return {clusters_.data(), n_clusters_}; }
    Index slot_of(Index fan);
    void add_terms(Index contact);
    void find_clusters();
    void solve_cluster(Cluster& cluster, const ExplicitStep& step, std::vector<std::uint8_t>& splits,
                       ThreadWorkspace& work, StepReport& report);
    void find_parts(TouchedFan& touched, const ExplicitStep& step, ThreadWorkspace& work) const;
    void soften(TouchedFan& touched, const State& begin, std::vector<std::uint8_t>& splits) const;
    bool keeps_its_parts(const TouchedFan& touched, const ExplicitStep& step, ThreadWorkspace& work,
                         StepReport& report) const;
    void solve_fan(TouchedFan& touched, const ExplicitStep& step, VertexSolver::Workspace& work) const;
    void add_parts(TouchedFan& touched, const ExplicitStep& step, ContactProblem& problem) const;
    void assemble(const Cluster& cluster, const ExplicitStep& step, bool stuck_stays, ThreadWorkspace& work);
    void spread(const Cluster& cluster);
    Vec2 rate(Index contact, const State& state) const;
    Vec2 rate(Index contact) const;
    std::span<const Term> terms_of(Index contact) const {
        return {terms_.data() + first_term_[contact], terms_.data() + first_term_[contact + 1]};
    }
    Vec2 place_of_corner(Index corner, const State& state) const;  // [m]

    const Model& model_;
    const VertexSolver& solver_;
    std::vector<Vec2>& corner_impulse_;
    FaceContacts contacts_;
    std::vector<Index> fans_;             // touched
    std::vector<TouchedFan> touched_;     // in their order; memory of more
    std::vector<Index> slot_of_fan_;      // per fan: into fans_, or -1
    std::vector<Index> cluster_of_slot_;  // of representatives
    std::vector<Term> terms_;
    std::vector<std::size_t> first_term_;  // per contact, and the end
    std::vector<Cluster> clusters_;        // memory of more
    std::size_t n_clusters_ = 0;
    std::vector<Vec2> impulse_, before_;  // [N s], [m/s] per contact: (N, T)
    std::vector<Vec2> last_impulse_;
    std::vector<double> residual_;  // [m/s] per contact: of its cluster
    std::vector<StepReport> partial_;
};

}  // namespace knap
