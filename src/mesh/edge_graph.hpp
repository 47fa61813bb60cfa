#pragma once
// The edges of a mesh as a graph: which vertices they join, and which edges end at a vertex.
#include "mesh/mesh.hpp"

namespace knap {

using EdgeEnds = std::vector<std::array<Index, 2>>;  // the two vertices of each edge

/// First the interior edges, then the boundary edges, in their order.
inline EdgeEnds edge_ends(const Mesh& mesh) {
    EdgeEnds ends;
    ends.reserve(mesh.interior_edges.size() + mesh.boundary_edges.size());
    for (const InteriorEdge& e : mesh.interior_edges) ends.push_back(mesh.side_vertices(e.triangle[0], e.side[0]));
    for (const BoundaryEdge& e : mesh.boundary_edges) ends.push_back(mesh.side_vertices(e.triangle, e.side));
    return ends;
}

/// Per vertex, the edges that end there, ascending.
inline Grouped<Index> edges_at_vertices(std::size_t n_vertices, const EdgeEnds& ends) {
    return {n_vertices, [&](const auto& visit) {
                for (std::size_t e = 0; e < ends.size(); ++e)
                    for (const Index v : ends[e]) visit(v, static_cast<Index>(e));
            }};
}

}  // namespace knap
