#pragma once
// An edge in its place, with material on its left: the frame in which all searches for contacts measure a vertex, of
// free faces, of obstacles and of obstacles with each other.
//
//               n        x
//               ^        | gap = n.(x - start)
//     start ----+--------+------ end  -> along          share = along.(x - start)/length, not clipped
//     /////////// material ///////////
#include "base/vec.hpp"

namespace knap {

struct PlacedEdge {
    Vec2 start;           // [m]
    Vec2 along, outward;  // unit vectors
    double length;        // [m]
    Vec2 end;             // [m]

    /// [m] Negative behind the edge.
    double gap(const Vec2& x) const { return outward.dot(x - start); }
    /// [m] From the start, along the edge.
    double place(const Vec2& x) const { return along.dot(x - start); }
    double share(const Vec2& x) const { return place(x) / length; }
};

inline PlacedEdge placed_edge(const Vec2& start, const Vec2& end) {
    const Vec2 way = end - start;
    const double length = way.norm();
    const Vec2 along = way / length;
    return {.start = start, .along = along, .outward = -turned_left(along), .length = length, .end = end};
}

/// The normals that planes through a vertex of a body may have which part it from other bodies.
struct VertexCone {
    static constexpr double widened = 0.26;  // sine of 15 degrees

    Vec2 t_in, t_out, outside;  // unit vectors: along the edges that enter and leave it, and out of the body

    VertexCone(const Vec2& in, const Vec2& out)
        // both parts point out of a convex vertex; the first is definite where it is sharp, the second where it is flat
        : t_in(in), t_out(out), outside((in - out - turned_left(in + out)).normalized()) {}
    /// A plane with this normal, which points to the body.
    bool accepts(const Vec2& n) const {
        return n.dot(t_in) <= widened && n.dot(t_out) >= -widened && n.dot(outside) <= widened;
    }
};

}  // namespace knap
