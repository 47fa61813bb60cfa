#pragma once
// A connected stretch of cracked edges that belongs to no crack yet: where a crack that is made of it would start, and how long it is.
#include "analysis/cracked_edges.hpp"

namespace knap {

struct LooseStretch {
    std::vector<Index> edges;
    CrackStart start = CrackStart::none;
    bool at_end_of_precrack = false;
    double length = 0;       // [m] of its longest way from the start, or (inside the body) from end to end, along edges
    std::vector<Index> way;  // vertices, from the start to the far end: of a stretch inside the body from its middle
    bool ends = false;       // the far end has arrived

    template <class Archive>
    void serialize(Archive& archive) { archive(edges, start, at_end_of_precrack, length, way, ends); }
};

/// The stretch that `edge` belongs to. It starts at a pre-crack, at its end rather than its side; without one at the boundary, at an end of a longest way
/// across; without either in the middle of its longest way. `node_of`: per edge, -1 where it belongs to no crack.
LooseStretch loose_stretch(const CrackedEdges& edges, std::span<const Index> node_of, Index edge);

}  // namespace knap
