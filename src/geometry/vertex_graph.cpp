#include "geometry/vertex_graph.hpp"

namespace knap {

namespace {

template <class Visit>
void for_each_edge(const Mesh& mesh, Visit visit) {
    const auto edge = [&](Index t, Index k) { visit(mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]); };
    for (const InteriorEdge& e : mesh.interior_edges) edge(e.triangle[0], e.side[0]);
    for (const BoundaryEdge& e : mesh.boundary_edges) edge(e.triangle, e.side);
}

}  // namespace

VertexGraph::VertexGraph(const Mesh& mesh) : begin_(mesh.vertices.size() + 1, 0) {
    for_each_edge(mesh, [&](Index a, Index b) {
        ++begin_[a + 1];
        ++begin_[b + 1];
    });
    for (std::size_t v = 1; v < begin_.size(); ++v) begin_[v] += begin_[v - 1];
    neighbours_.resize(begin_.back());
    std::vector<Index> next(begin_.begin(), begin_.end() - 1);
    for_each_edge(mesh, [&](Index a, Index b) {
        neighbours_[next[a]++] = b;
        neighbours_[next[b]++] = a;
    });
}

}  // namespace knap
