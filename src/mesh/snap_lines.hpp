#pragma once
// Maps of traces as they were digitised: ends that nearly meet, corners side by side, tiny pieces.
#include "mesh/planar_graph.hpp"

namespace knap {

/// Moves cracks by at most about d = Shape::snap, until no two nodes, and no node and line that do not belong together,
/// are nearer than d, and no lines meet at less than a degree. Borders, which are rings and the lines of regions, stay;
/// `corners` are their nodes without the cracks. The graph has lines inside the body only.
///
///     merge     nodes within d become one: corners of borders, points on them, crossings, bends, ends, in this order
///     fold      of a corner that is nearly closed the shorter side, up to 1.5 d, is left out
///     bend      a line that passes a node within d goes through it; a node within d of a border is moved onto it
///     cross     lines that were bent may cross others: the crossings are new nodes
///     part      of two lines that meet at less than a degree one starts at the other where they are 2 d apart
///
/// repeated until nothing changes: iterated snap rounding without a grid (D. Halperin, E. Packer, Comput. Geom. 23).
SnapCounts snap_lines(PlanarGraph& graph, const Shape& shape, const std::vector<Vec2>& corners);

}  // namespace knap
