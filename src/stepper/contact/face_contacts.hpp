#pragma once
// Which vertex of the free boundary touches which free edge in a step, at the positions of its start.
//
// Edge a -> b of length L, material to the left, tangent t, outward normal n; vertex i at x with velocity v_i:
//
//     g = n.(x - x_a)              s = t.(x - x_a)/L                                   s is not clipped
//     V_N = n.(v_i - (1-s) v_a - s v_b) = dg/dt      V_T = t.(v_i - (1-s) v_a - s v_b) + (g/L) n.(v_b - v_a)
//     i: P = p_N n + p_T t         a: -(1-s) P - Q         b: -s P + Q                 Q = (g/L) p_T n
//
// These are the rates of invariants of position, so every pair of impulses has zero resultant and zero moment.
#include "base/placed_edge.hpp"
#include "law/row_term.hpp"
#include "stepper/contact/nearby_edges.hpp"
#include "stepper/contact/nearby_pieces.hpp"

#include <optional>

namespace knap {

/// A boundary vertex near a boundary edge, at the positions of the start of the step.
struct FaceContact {
    std::array<Index, 2> vertex;  // corners at the vertex: the end of the boundary edge that enters it, the start of
                                  // the one that leaves it (equal where one triangle has both)
    std::array<Index, 2> edge;    // corners a, b at the ends of the edge; its triangle lies to the left of a -> b
    Vec2 normal;                  // outward of the edge's triangle; tangent t = (b - a)/L = turned_left(normal)
    Index joint_law;              // of the joint from which both faces came, as in Model::laws; -1: there is none
    double length, share, gap;    // [m] L, [-] s (not clipped to [0, 1]), [m] g
    double depth;                 // [m] of the overlap: -g, or less at a convex corner
    double contact, tangential;   // [N s] impulses of the step before (0 if new), duplicates merged: the start of the
                                  // iteration

    /// Of values at the corners: that of the vertex, the mean of both, minus that of the edge.
    Vec2 jump(const auto& of_corner) const {
        return 0.5 * (of_corner(vertex[0]) + of_corner(vertex[1])) - (1 - share) * of_corner(edge[0]) -
               share * of_corner(edge[1]);
    }
    /// Calls visit(term) for the corners: the rates and impulses above. Those of the ground do not move.
    void visit_terms(const auto& visit) const {
        const Vec2 n = normal, t = turned_left(n), turn = gap / length * n;
        for (const Index corner : vertex) visit(CornerTerm{corner, 0.5 * n, 0.5 * t});
        visit(CornerTerm{edge[0], -(1 - share) * n, -(1 - share) * t - turn});
        visit(CornerTerm{edge[1], -share * n, -share * t + turn});
    }
};

/// The law is that of the pair of materials. On a support it is that of the support's interface, whatever lies on it;
/// two faces of joints keep that of the joint, so that slip beyond the points goes on with the same friction. Friction
/// over slip follows the way between the sides of the points that retired at the corners of the contact, friction over
/// pressure what the body bears behind the contact at the start of the step.
ContactLaw law_between_faces(const Model& model, const State& begin, const FaceContact& contact);

/// A contact whose step must be smaller.
struct ContactRefusal {
    enum class Reason { speed, depth };
    Reason reason;
    double value;  // [-] relative displacement in the step, or penetration, per length of the edge
    Vec2 place;    // [m]
};

/// README.md has the rules by which a pair is a contact, and which contacts are redundant: solvers cycle on them.
class FaceContacts {
public:
    explicit FaceContacts(const Model& model) : model_(model), boundary_(model) {}

    /// From the next search on contacts of the rigid pieces of the state, which do not meet themselves; null: of a
    /// deformable body.
    void set_pieces(SharedFrozenBody body) { pieces_ = std::move(body), complete_ = false; }

    /// Reads positions and velocities, State::retired and State::face_contacts. `corner_velocity` [m/s, per corner]: in
    /// place of those of the state.
    void find(const State& begin, double h, const std::vector<Vec2>* corner_velocity = nullptr);
    /// Likewise of rigid pieces; `added`: to their velocities in the step.
    void find_of_pieces(const State& begin, double h, AddedRates added);
    /// Of the last search: a pair of rigid pieces that was out of reach overlaps by more than `allowed` [-] of the edge
    /// once all has moved by moved(corner, x) [m], of the place x in the piece of a corner.
    template <class Moved>
    bool misses(const State& begin, double allowed, const Moved& moved) const {
        return std::ranges::any_of(out_of_reach_, [&](const NearbyEdge& pair) {
            const PlacedEdge& edge = placed_[pair.edge];
            const Index leaving = boundary_.edges()[pair.vertex].start;
            const Vec2 x = place_of_vertex(pair.vertex),
                       way = moved(leaving, x) - moved(boundary_.edges()[pair.edge].start, x), then = x + way;
            return edge.gap(then) < -allowed * edge.length && edge.share(then) >= 0 && edge.share(then) <= 1 &&
                   vertex(pair.vertex, begin).cone.accepts(edge.outward);
        });
    }
    /// In the order of (vertex, edge).
    std::span<const FaceContact> all() const { return contacts_; }
    /// Where the step moves a contact by more than 0.05 L (0.2 L of rigid pieces), or else where one is deeper than
    /// 0.1 L: the worst place.
    const std::optional<ContactRefusal>& refusal() const { return refusal_; }
    /// Of rigid pieces that may reach each other in the step.
    const LargestMotion& passing() const { return nearby_pieces_.passing(); }
    const FreeBoundary& boundary() const { return boundary_; }

private:
    /// A contact with what pruning reads.
    struct Found {
        FaceContact contact;
        Index vertex, edge;  // places in FreeBoundary::edges()
        double gap_at_end;   // [m] predicted with the present velocities
        double overhang;     // [m] of the vertex against the normal
        bool flat;           // the boundary hardly turns at the vertex
        bool kept;
    };
    struct Block {
        std::vector<Found> found;
        std::vector<NearbyEdge> out_of_reach;
        std::optional<ContactRefusal> refusal;
    };
    /// What all pairs of a vertex share.
    struct Vertex {
        Vec2 x, v;
        VertexCone cone;                 // rule 3
        double l_in, l_out;              // [m] of the edges that enter and leave it
        std::array<Index, 2> joint_law;  // of these edges
        std::span<const FaceContactState> before;
        bool reflex, flat;

        /// Outward, of its edges.
        std::array<Vec2, 2> normals() const { return {-turned_left(cone.t_in), -turned_left(cone.t_out)}; }
        /// [m] How much further than the vertex its edges reach against the normal.
        double overhang(const Vec2& n) const {
            return std::max({0.0, n.dot(cone.t_in) * l_in, -n.dot(cone.t_out) * l_out});
        }
        /// [m] Of its edges from a plane, where the vertex is at `from_plane`; negative: a part of them is behind it.
        double distance(const Vec2& n, const Vec2& from_plane) const { return n.dot(from_plane) - overhang(n); }
        /// FreeEdge::joint_law of the edge that faces one with this tangent.
        Index joint_law_against(const Vec2& tangent) const {
            return joint_law[cone.t_out.dot(tangent) < cone.t_in.dot(tangent)];
        }
    };
    /// Largest of all corners: move since the search, speed.
    struct Motion {
        double squared_move = 0, squared_speed = 0;
        Motion& operator+=(const Motion& other) {
            squared_move = std::max(squared_move, other.squared_move);
            squared_speed = std::max(squared_speed, other.squared_speed);
            return *this;
        }
    };

    void read_boundary();
    bool place_corners(const State& begin, double h, const std::vector<Vec2>* corner_velocity, bool boundary_changed);
    void find_deformable(const State& begin, double h);
    void find_rigid(const State& begin, double h, bool boundary_changed);
    double added_between(Index one, Index other) const;
    void use_edges_of(std::size_t block);
    const CornerMotion& start_of(Index edge) const { return corners_[boundary_.edges()[edge].start_place]; }
    const CornerMotion& end_of(Index edge) const { return corners_[boundary_.edges()[edge].end_place]; }
    bool may_touch(const Vec2& x, Index edge, double reach) const;
    void place_edge(Index e) { placed_[e] = placed_edge(start_of(e).x, end_of(e).x); }
    Vec2 place_of_vertex(Index i) const { return 0.5 * (end_of(boundary_.edges()[i].entering).x + start_of(i).x); }
    Vertex vertex(Index i, const State& begin) const;
    void examine(const NearbyEdge& pair, const Vertex& at, const State& begin, double h, Block& block) const;
    struct Corner {
        Index first, second;  // edges, in the order of the outline
        bool is_outer;
    };
    Corner corner(Index e, bool at_end) const;
    double overrun(Index e, const Vec2& x, double gap, double share) const;
    bool belongs_to(Index e, const Vertex& at, double gap, double share, const State& begin, double h) const;
    double overlap(const FreeEdge& edge, const Vertex& at, double gap, const State& begin) const;
    bool second_is_nearer(Index first, Index second, const Vertex& at, double h) const;
    bool was_on_face(const Vertex& at, const Vec2& normal) const;
    bool meets_nearer(Index j, const Vertex& at, double gap, const State& begin) const;
    bool was_beside(const State& begin, const NearbyEdge& pair) const;
    const FaceContactState* known(std::span<const FaceContactState> of_vertex, Index edge) const;
    const FaceContactState* slid_from(Index edge, const Vertex& at) const;
    void prune();
    void prune_corners(Found& at);
    std::span<Found> of_vertex(Index i);
    bool ends_in(Index edge, Index vertex) const {
        return boundary_.edges()[edge].piece_start == vertex || boundary_.edges()[edge].piece_end == vertex;
    }

    const Model& model_;
    FreeBoundary boundary_;
    std::vector<Vec2> reference_;           // [m] undeformed, of FreeBoundary::corners()
    double longest_ = 0, total_ = 0;        // [m] lengths of free edges, undeformed
    std::size_t n_read_ = 0;                // edges in them
    std::vector<CornerMotion> corners_;     // as they are now
    double reach_ = 0;                      // [m] no contact has a larger gap
    NearbyEdges nearby_;                    // of a deformable body
    SharedFrozenBody pieces_;               // null: it is deformable
    AddedRates added_;                      // to their velocities, in this step
    NearbyPieces nearby_pieces_;            // of rigid ones
    std::vector<NearbyEdge> near_;          // likewise, in this step
    std::vector<NearbyEdge> out_of_reach_;  // of them
    bool complete_ = false;                 // what is nearby knows all edges
    std::vector<std::uint8_t> is_used_;     // per edge: in used_
    std::vector<Index> used_;               // edges near others
    std::vector<PlacedEdge> placed_;        // per edge; those in used_
    std::vector<Motion> partial_;
    std::vector<Block> blocks_;
    std::vector<Found> found_;
    std::vector<std::size_t> first_found_;  // per vertex
    std::vector<FaceContact> contacts_;
    std::optional<ContactRefusal> refusal_;
};

}  // namespace knap
