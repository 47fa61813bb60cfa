#pragma once
// The supports as the ground of contact between free faces: rigid polylines, fixed in space, with the ground to the
// left. A point that stands on its support is a link of its fan; general contact has whatever else comes near, and the
// body itself where it has left its place.
#include "base/vec.hpp"

#include <vector>

namespace knap {

constexpr double straight_on = 1e-6;  // sine of the angle between two edges that are straight

struct GroundVertex {
    Vec2 place;              // [m]
    Index next = -1;         // the vertex at the other end of the edge that leaves this one; -1: none does
    Index prev = -1;         // likewise of the edge that enters
    Index law = -1;          // into Model::laws: of the edge that leaves, or else of that which enters
    Index mesh_vertex = -1;  // that stood on it at the start
    bool has_face = false;   // the edge that leaves is a face; else a side of the ground, which touches nothing
    bool convex = false;     // its edges make a corner that may touch faces
};

struct Ground {
    std::vector<GroundVertex> vertices;
    std::vector<Index> of_point;  // per interface point on a support: its vertex; else -1
};

}  // namespace knap
