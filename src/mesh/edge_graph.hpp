#pragma once
// The edges of a mesh as a graph: which vertices they join, and which edges end at a vertex.
#include "base/union_find.hpp"
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

/// Per triangle the number of its piece, all triangles that edges connect, in the order of the first triangles.
inline std::vector<Index> pieces_of(const Mesh& mesh) {
    UnionFind connected(mesh.triangles.size());
    for (const InteriorEdge& edge : mesh.interior_edges) connected.join(edge.triangle[0], edge.triangle[1]);
    std::vector<Index> piece;
    Index n = 0;
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        const Index first = connected.find(t);
        piece.push_back(first == t ? n++ : piece[first]);
    }
    return piece;
}

}  // namespace knap
