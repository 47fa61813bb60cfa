#pragma once
// Contacts of rigid pieces with each other, with obstacles and with the ground, and of obstacles with each other, in
// one step. Every contact is a row of one problem (nonsmooth/contact_cluster.hpp) with the rates
//
//     V = sum over the bodies of (along_N . v, along_T . v),     v = (velocity, spin),     along = (n, arm x n)
//
// Their places are those of the start of the step, so that the impulses of a contact have no resultant and no moment.
// Sources: corners of free faces (stepper/contact), corners and edges at obstacles (stepper/common), and broken points
// whose sides have not parted yet.
#include "nonsmooth/contact_cluster.hpp"
#include "nonsmooth/contact_clusters.hpp"
#include "stepper/common/obstacle_contacts.hpp"
#include "stepper/common/obstacle_motion.hpp"
#include "stepper/common/obstacle_pairs.hpp"
#include "stepper/common/step_scheme.hpp"
#include "stepper/rigid/rigid_places.hpp"

#include <array>
#include <span>

namespace knap {

class RigidContacts {
public:
    RigidContacts(const Model& model, const RigidOptions& options)
        : model_(model), options_(options), faces_(model), obstacle_contacts_(model), pairs_(model) {}

    /// Reads what changed with the pieces.
    void renew(const State& begin);
    /// Finds the contacts; wakes bodies that are hit, and those that lie on them. `bodies`: pieces, then obstacles.
    /// `added` [m/s, m/s, rad/s]: sets of what is added to the velocities of the pieces.
    void find(const RigidStep& step, const ObstacleMotion& obstacles, AddedRates added,
              std::vector<MovingBody>& bodies);
    /// The end velocities bring faces together that were out of reach when the contacts were found; those of deformable
    /// pieces are guesses, which count for nothing.
    bool misses(const RigidStep& step, const std::vector<MovingBody>& bodies) const {
        constexpr double allowed = 0.003;  // [-] of an edge, which the next step corrects
        return meets_faces() && faces_.misses(step.begin, allowed, [&](Index corner, const Vec2& x) -> Vec2 {
            if (model_.ground_at(corner) != nullptr) return Vec2::Zero();
            const MovingBody& body = bodies[piece_of(corner)];
            const Vec3 way =
                body.deformable ? Vec3(step.drift_time * body.free) : Vec3(step.drift_time * body.end + body.strike);
            return velocity_at(way, x - body.centre);
        });
    }
    /// Finds the impulses, end velocities and shifts. Returns the largest motion of faces that meet over the allowed
    /// one: a gap is linear in the turn of a piece, so what turns far counts, too, and what passes others; points that
    /// have not retired, since their fan keeps its neighbours apart and no others; and how deep is what was apart:
    /// where it separated, its law stops it at the opposite speed at most, since less would be positive work.
    LargestMotion solve(const RigidStep& step, std::vector<MovingBody>& bodies, StepReport& report);
    /// How `bodies` would move on from rest (their `before` is zero) under their loads: their `end`, in clusters with a
    /// body that is marked [0/1]. Sweeps go on while they leave errors above `goal` [-] of the speed of a cluster.
    /// [m/s] The largest error of a rate.
    double move_from_rest(const RigidStep& step, const std::vector<std::uint8_t>& marked, double goal,
                          std::vector<MovingBody>& bodies);
    /// [-] The hardest blow or lasting load on a piece that can break, over what it bears (freeze.hpp), and its place;
    /// `of_piece` [-]: likewise of each piece, and of those that it hits, whose waves are part of the blow.
    struct Blow {
        double value = 0;
        Vec2 place = Vec2::Zero();
    };
    Blow hardest_blow(const RigidStep& step, const std::vector<MovingBody>& bodies, std::vector<double>& of_piece);
    /// Of the impulses between deformable pieces and others: what acts on a corner of a deformable one, in the whole
    /// kick of its piece.
    struct CornerImpulse {
        Index piece, corner;
        Vec2 impulse;  // [N s]
    };
    void impulses_on_deformable(const std::vector<MovingBody>& bodies, std::vector<CornerImpulse>& impulses) const;
    /// Calls visit(vertex, edge, entering) (FaceContactState) for what touches or overlaps in deformable pieces.
    template <class Visit>
    void for_overlapping_deformable(const std::vector<MovingBody>& bodies, const Visit& visit) const {
        for (std::size_t i = 0; i < row_of_face_.size(); ++i)
            if (const FaceContact& c = faces_.all()[i]; c.gap <= 0 && is_deformable(c, bodies))
                visit(c.vertex[1], c.edge[0], c.vertex[0]);
    }
    /// Marks [0/1] the pieces that touch deformable ones. Whether there are any, as below.
    bool mark_touching(const std::vector<MovingBody>& bodies, std::vector<std::uint8_t>& marked) const;
    /// Marks those that overlap with deformable ones by more than `allowed` [-] of an edge, and by more than at the
    /// start of the step, at the places of the state `end`: what is deep already must not deepen step by step.
    bool mark_overlapping(const State& end, double allowed, const std::vector<MovingBody>& bodies,
                          std::vector<std::uint8_t>& marked) const;
    /// Corrects positions of what overlaps (rigid_places.hpp).
    void project(const RigidStep& step, std::vector<MovingBody>& bodies) const { correct_places(step, rows_, bodies); }
    /// Works of the contacts, and their impulses in the end state.
    void finish(const RigidStep& step, const std::vector<MovingBody>& bodies, State& end, StepReport& report) const;
    /// Calls visit(a, b, loss) for bodies that press on each other; b = -1: the ground; loss [J]: by this contact.
    template <class Visit>
    void for_pressed(const Visit& visit) const {
        for (const Row& row : rows_)
            if (row.impulse.x() > 0)
                for (int k = 0; k < row.n_terms; ++k)
                    visit(row.terms[k].body, row.n_terms > 1 ? row.terms[k == 0 ? 1 : 0].body : -1,
                          -0.5 * row.impulse.dot(row.before + row.after));
    }
    /// [N s, N s, N m s] of the contacts on a body, but of those that deformable pieces resolve themselves.
    void add_wrenches(const std::vector<MovingBody>& bodies, std::vector<Vec3>& wrench) const;
    /// Points that retired bear nothing any more.
    void release_retired(State& end) const;
    /// Broken points lie between the pieces that may retire in this step.
    bool has_points() const { return !points_.empty(); }

private:
    using Row = RigidRow;
    using Source = Row::Source;
    struct Point {  // broken, between pieces or on a support
        Index fan, place;
    };
    struct Cluster {
        double residual = 0;   // [m/s]
        double speed = 0;      // [m/s] scale of its rates
        double tolerance = 0;  // [m/s] nearer kinks of the friction are one
    };
    struct Workspace {
        ContactCluster cluster;
        std::vector<Index> body;  // per movable body of the cluster
    };

    void add_faces(const RigidStep& step, AddedRates added, const std::vector<MovingBody>& bodies);
    void add_obstacles(const RigidStep& step, const std::vector<MovingBody>& bodies);
    void add_pairs(const RigidStep& step, const std::vector<MovingBody>& bodies);
    void add_points(const RigidStep& step, const std::vector<MovingBody>& bodies);
    void keep_hull(std::size_t first);
    void add_row(Row& row, const std::vector<MovingBody>& bodies);
    /// One piece alone does not meet itself.
    bool meets_faces() const { return n_pieces_ > 1 || !model_.ground.vertices.empty(); }
    /// A contact of deformable pieces, which resolve it themselves.
    bool is_deformable(const FaceContact& c, const std::vector<MovingBody>& bodies) const;
    Index piece_of(Index corner) const { return begin_->frozen->piece_of_triangle[model_.mesh.triangle_of(corner)]; }
    Index body_of_obstacle(Index o) const { return n_pieces_ + o; }
    Vec2 place_of(Index corner) const { return knap::place_of(model_, *begin_, corner); }
    bool can_break(Index body) const;
    void wake(std::vector<MovingBody>& bodies) const;
    /// Pieces that cannot break rebound as the scenario says; others, in an impact that they bear, with R_N and R_T
    /// alone.
    ContactLaw law_for(ContactLaw law, bool breaks) const;
    void find_clusters(const std::vector<MovingBody>& bodies);
    void solve(std::size_t cluster, const RigidStep& step, const std::vector<MovingBody>& bodies, Workspace& work,
               double goal = infinity);
    /// Solves a cluster once more, from impacts without rebound, with rows as `change(row)` makes them; calls
    /// `take(number, row)` for each. The rows stay what they are.
    template <class Change, class Take>
    void solve_anew(std::size_t cluster, const RigidStep& step, const std::vector<MovingBody>& bodies, double goal,
                    const Change& change, const Take& take);
    bool mark_rigid_sides(const Row& row, const std::vector<MovingBody>& bodies,
                          std::vector<std::uint8_t>& marked) const;

    const Model& model_;
    RigidOptions options_;
    FaceContacts faces_;
    ObstacleContacts obstacle_contacts_;
    ObstaclePairs pairs_;
    const State* begin_ = nullptr;
    Index n_pieces_ = 0;
    std::vector<Point> points_;
    double weakest_ = 0;  // [m/s] smallest sigma_c/(rho c) of all pieces
    std::vector<Row> rows_;
    std::vector<Index> row_of_face_;             // per contact of faces_: its row, or -1
    std::vector<std::size_t> hull_, by_bodies_;  // rows
    std::vector<std::size_t> by_corner_;         // contacts with obstacles of the step before
    ContactClusters lists_;                      // of bodies that move
    std::vector<Cluster> clusters_;
    std::vector<Workspace> work_;
};

}  // namespace knap
