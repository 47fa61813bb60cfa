#pragma once
// The free boundary: closed polylines round everything that general contact may touch, with the material to the left.
//
// Free edges are the edges of the mesh boundary and both sides of every interface of which an end point is retired, or
// holds in a fan whose corners meet (Retirement::meeting).
// Round a mesh vertex they cut the fan into wedges: a free edge enters a wedge, and the next one leaves it.
// Retired and parted points (Retirement) cut the fan into contact pieces: a piece may contain wedges that
// live points still join. Retired points alone cut it into groups of pieces; where corners meet, each piece is a group,
// which does not touch the two that its points join to it.
//
// A piece is one vertex for contact with others; its entering and leaving edge are the outer ones, so that a crack that
// is closed by live points is no corner. Nothing is missed and nothing covered twice: the pair (corner, edge at the
// other side of the same point) lies within one group if the point is live (the fan owns the pair, and contact skips
// edges that end in the group of the vertex) and in two groups if it is retired. A piece without a cut or an outer
// edge surrounds its vertex and can touch nothing.
//
// The ground (model/ground.hpp) is one more body: its vertices have the numbers behind the corners. Where a point still
// stands on its support, the piece above belongs to the group of the ground, and an edge with two such points touches
// nothing.
#include "model/state.hpp"

#include <span>
#include <vector>

namespace knap {

struct FreeEdge {
    Index start, end;              // corners a, b; the number of the start corner is the number of the edge
    Index prev, next;              // places in FreeBoundary::edges() of the neighbours in the polyline
    Index piece_start;             // the contact piece at a: place of the edge that leaves it; -1: it touches nothing
    Index piece_end;               // at b
    Index group_start, group_end;  // of the pieces at a and b: edges of a group do not touch its vertices
    std::array<Index, 2> joined;   // the groups beside the one at a that points join to it (Retirement::meeting), whose
                                   // edges do not touch its vertex, either; -1: there is none
    Index entering;  // place of the edge that enters the piece which this edge leaves; -1: this edge leaves
                     // no piece, or the piece touches nothing
    Index start_place, end_place;  // of a and b in FreeBoundary::corners()
    bool passive;                  // touches nothing: it stands on its support, or is a side of the ground
    bool ground;
    bool touches;            // it leaves a vertex that may touch edges
    bool starts_on_support;  // the vertex that it leaves stands on its support
    bool reflex_wedge;       // at b, in the undeformed body: more than 180 degrees of material
    bool reflex_piece;       // at a
    Index joint_law;         // Interface::joint_law, where the face was a joint; or -1
    double depth;            // [m] largest penetration that a contact may have: 0.35 of the triangle's altitude
};

/// Empty where the model has no contact between free faces. Triangles of first order.
class FreeBoundary {
public:
    explicit FreeBoundary(const Model& model);

    /// Adds the faces of points that retired since; false where none did. An empty list stands for none. New edges
    /// follow the others, whose places stay, until sort() is called.
    bool update(std::span<const Retirement> retired);
    /// Places of the edges that the last update added or that got other neighbours or pieces by it; empty after a sort.
    std::span<const Index> changed() const { return changed_; }
    /// Lists the edges in the order of their numbers.
    void sort();
    bool is_sorted() const { return n_sorted_ == edges_.size(); }
    /// In the order of their numbers after sort().
    std::span<const FreeEdge> edges() const { return edges_; }
    /// The corners at the ends of the edges.
    std::span<const Index> corners() const { return corners_; }
    /// Those of the ground, which never move: [first, end) of them.
    std::array<std::size_t, 2> ground_corners() const { return ground_corners_; }
    /// The corner at the end of the edge with this number.
    Index end_of(Index start) const {
        const GroundVertex* ground = model_.ground_at(start);
        return ground ? number_of(ground->next) : next_in_triangle(start);
    }
    /// Two corners of the body or of the ground.
    bool are_one_vertex(Index a, Index b) const {
        const GroundVertex *ground_a = model_.ground_at(a), *ground_b = model_.ground_at(b);
        if (!ground_a && !ground_b) return model_.fan_of_corner[a] == model_.fan_of_corner[b];
        const auto of_mesh = [&](const GroundVertex* ground, Index corner) {
            return ground ? ground->mesh_vertex : model_.fans[model_.fan_of_corner[corner]].vertex;
        };
        return of_mesh(ground_a, a) == of_mesh(ground_b, b);
    }
    /// Of the edge with this number in edges(); -1 where it is not free.
    Index place_of(Index start) const {
        return model_.ground_at(start) != nullptr || is_free(start) ? place_[start] : -1;
    }

private:
    bool is_free(Index h) const {
        return twin_[h] < 0 ? !model_.has_vanished(h / 3) : frees(point_[h]) || frees(point_[h] ^ 1);
    }
    /// Faces beside this point are free for others.
    bool frees(Index point) const {
        return retired_[point] == Retirement::retired || retired_[point] == Retirement::meeting;
    }
    /// Of a vertex of the ground.
    Index number_of(Index ground) const { return model_.mesh.n_corners() + ground; }
    /// The vertex of the ground on which an end of a boundary edge stands; -1: none.
    Index ground_below(Index point) const {
        return point < 0 || retired_[point] == Retirement::retired ? -1 : model_.ground.of_point[point];
    }
    void link(const Fan& fan);
    void stand(const Fan& fan);
    void add(Index h);
    void add_ground(Index g);
    void refresh(Index h);
    void refresh_ground(Index g);
    Index place_of_corner(Index c);

    const Model& model_;
    std::vector<Retirement> retired_;
    // per half-edge, numbered by its start corner: edge k of triangle t, from corner 3 t + k
    std::vector<Index> twin_;                   // or -1
    std::vector<Index> point_;                  // at its start, or -1; that at its end is point ^ 1
    std::vector<Index> prev_;                   // the free edge that enters the wedge which this free edge leaves
    std::vector<Index> piece_;                  // of the start corner: the first corner of its contact piece, or -1
    std::vector<Index> group_;                  // of the start corner: the first corner of its group
    std::vector<std::array<Index, 2>> joined_;  // of the start corner: FreeEdge::joined
    std::vector<Index> last_;                   // per first corner of a piece: its last corner
    std::vector<std::uint8_t> reflex_wedge_, reflex_piece_;  // per edge that leaves a wedge, a piece
    std::vector<Index> place_;                               // of a free edge in edges_
    std::vector<FreeEdge> edges_;
    std::size_t n_sorted_ = 0;
    std::vector<Index> corners_;
    std::array<std::size_t, 2> ground_corners_{};
    std::vector<Index> corner_place_;  // in corners_, or -1
    std::vector<Index> changed_;
};

}  // namespace knap
