#pragma once
// A shape as a planar straight-line graph: every crossing is a node, points nearer than the tolerance are one node,
// lines outside the body are cut off. The mesh conforms to its segments.
#include "mesh/shape.hpp"
#include "mesh/size_field.hpp"

namespace knap {

struct GraphSegment {
    Index from = -1;      // node
    Index to = -1;        // node
    Index ring = -1;      // 0 the outer ring, 1 + i hole i, -1 no ring
    Index boundary = -1;  // index into Shape::boundary_names, on rings only
    Index crack = -1;     // first crack that runs along it, -1 none
    Index region = -1;    // last region whose border it is, -1 none

    /// The last-declared part that the segment belongs to: "cracks[1]", "regions[0]", "holes[2]" or "outer".
    std::string part_name() const;
};

struct PlanarGraph {
    std::vector<Vec2> nodes;  // [m]
    std::vector<GraphSegment> segments;

    Segment line(const GraphSegment& s) const { return {nodes[s.from], nodes[s.to]}; }
};

/// What Shape::snap did.
struct SnapCounts {
    int n_joined = 0;              // ends that were moved onto another line
    int n_merged = 0;              // corners and crossings that were moved onto another one
    int n_left_out = 0;            // pieces shorter than that, which were left out
    double length_left_out = 0;    // [m] of these
    std::vector<Index> lost = {};  // cracks of which nothing is left: numbers
};

}  // namespace knap
