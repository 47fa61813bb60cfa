#pragma once
// Which free edges of rigid pieces are near which vertices of others.
//
// Boxes round the pieces, sorted along one axis, tell the pairs of pieces that may meet in a step. Each pair keeps a
// list of vertices and edges that stays complete while the pieces move little relative to each other, however fast they
// move together; where one of them is deformable it is made anew in each step. What is listed depends on the step
// alone: for_near() has a reach, by which the caller looks again.
#include "model/rigid_body.hpp"
#include "stepper/common/contact_search.hpp"
#include "stepper/contact/nearby_edges.hpp"

#include <limits>

namespace knap {

class NearbyPieces {
public:
    /// Reads the outlines. `undeformed` [m]: their corners, so that lengths do not depend on when they are read.
    void read(std::span<const FreeEdge> edges, std::span<const Vec2> undeformed, const FrozenBody& body);
    /// Finds the pairs for a step of h [s]; `added`: to the velocities in it.
    void find(std::span<const FreeEdge> edges, std::span<const CornerMotion> corners,
              std::span<const RigidPiece> pieces, AddedRates added, double h);
    /// Of a piece relative to another one that it may reach in this step.
    const LargestMotion& passing() const { return passing_; }
    /// Calls visit(vertex, edge, reach) for all that may be near (NearbyEdges) with a reach [m] of this step, and more.
    template <class Visit>
    void for_near(const Visit& visit) const {
        for (const Pair& pair : pairs_)
            for (const NearbyEdge& at : pair.near) visit(at.vertex, at.edge, pair.reach);
    }

private:
    struct Outline {
        Index first_edge = 0, last_edge = 0, first_vertex = 0, last_vertex = 0;  // in edges_, vertices_
        double longest = 0;                                                      // [m] edge
        double radius = std::numeric_limits<double>::infinity();                 // [m] about its centre
    };
    struct Box {
        Vec2 low, high;  // [m]
        double room;     // [m] that the piece may cover in a step beyond it
    };
    /// Of two pieces, or a piece and the ground; the first is the larger one, from which the motion of the other is
    /// seen.
    struct Pair {
        std::array<Index, 2> of;
        Vec2 offset = Vec2::Zero();  // [m] between their centres, when the list was made
        double turn = 0, reach = 0;  // [rad] likewise; [m] of this step
        double margin = -1;          // [m] of the list; negative: there is none
        std::vector<NearbyEdge> near;
    };
    void find_boxes(std::span<const FreeEdge> edges, std::span<const CornerMotion> corners,
                    std::span<const RigidPiece> pieces, AddedRates added, double h);
    void find_pairs();
    /// A vertex where the outline does not protrude touches nothing that its neighbours do not touch.
    void search(Pair& pair, std::span<const FreeEdge> edges, std::span<const CornerMotion> corners) const;

    std::vector<Outline> outlines_;        // per piece, then of the ground
    std::vector<Index> edges_, vertices_;  // places of free edges (a vertex: of the one that leaves it), by pieces
    std::vector<Box> boxes_;
    std::vector<Index> order_;                // of the pieces along the axis
    std::vector<std::array<Index, 2>> near_;  // pieces whose boxes overlap
    std::vector<Pair> pairs_, before_;
    LargestMotion passing_;
};

}  // namespace knap
