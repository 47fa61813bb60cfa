#pragma once
// A shape as a planar straight-line graph: every crossing is a node, points nearer than the tolerance are one node,
// lines outside the body are cut off. The mesh conforms to its segments.
#include "mesh/shape.hpp"

namespace knap {

struct GraphSegment {
    Index from = -1;      // node
    Index to = -1;        // node
    Index ring = -1;      // 0 the outer ring, 1 + i hole i, -1 no ring
    Index boundary = -1;  // index into Shape::boundary_names, on rings only
    Index crack = -1;     // first crack that runs along it, -1 none
    Index region = -1;    // last region whose border it is, -1 none
};

struct PlanarGraph {
    std::vector<Vec2> nodes;  // [m]
    std::vector<GraphSegment> segments;

    Segment line(const GraphSegment& s) const { return {nodes[s.from], nodes[s.to]}; }
};

/// For a shape whose rings were checked. The end of a crack within the shape tolerance of a ring or of an earlier crack
/// is moved onto it. Region borders yield more: within `region_tolerance` [m] they are moved onto rings, cracks and
/// each other, and their shorter sides collapse, so that a border cannot force triangles far below the mesh size.
PlanarGraph planar_graph(const Shape& shape, double region_tolerance = 0);

/// The name of the last-declared part that a segment belongs to: "cracks[1]", "regions[0]", "holes[2]" or "outer".
std::string part_name(const GraphSegment& segment);

}  // namespace knap
