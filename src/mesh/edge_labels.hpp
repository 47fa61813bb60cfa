#pragma once
// What the edges of a mesh know besides their triangles, to carry it over to another mesh.
#include "mesh/mesh.hpp"

#include <unordered_map>

namespace knap {

struct EdgeLabel {
    Index boundary = -1;  // of a boundary edge
    Index joint = -1;
    bool cracked = false;
};

/// Calls visit(ends, label) for every boundary edge, joint and crack of a mesh.
template <class Visit>
void for_each_label(const Mesh& mesh, const Visit& visit) {
    for (const InteriorEdge& e : mesh.interior_edges)
        if (e.joint >= 0 || e.cracked)
            visit(mesh.side_vertices(e.triangle[0], e.side[0]), EdgeLabel{.joint = e.joint, .cracked = e.cracked});
    for (const BoundaryEdge& e : mesh.boundary_edges)
        visit(mesh.side_vertices(e.triangle, e.side), EdgeLabel{.boundary = e.boundary});
}

/// Labels by the two vertices of an edge.
class EdgeLabels {
public:
    void set(std::array<Index, 2> ends, const EdgeLabel& label) { of_edge_[edge_key(ends)] = label; }

    /// On a mesh whose edges were found: all of its boundary edges must have a label.
    void put_on(Mesh& mesh) const {
        for (BoundaryEdge& e : mesh.boundary_edges)
            e.boundary = of_edge_.at(edge_key(mesh.side_vertices(e.triangle, e.side))).boundary;
        for (InteriorEdge& e : mesh.interior_edges)
            if (const auto known = of_edge_.find(edge_key(mesh.side_vertices(e.triangle[0], e.side[0])));
                known != of_edge_.end())
                e.joint = known->second.joint, e.cracked = known->second.cracked;
    }

private:
    std::unordered_map<std::uint64_t, EdgeLabel> of_edge_;
};

}  // namespace knap
