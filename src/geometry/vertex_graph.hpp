#pragma once
// The vertices that every vertex shares an edge with.
#include "geometry/mesh.hpp"

namespace knap {

class VertexGraph {
public:
    /// `mesh` needs its edges.
    explicit VertexGraph(const Mesh& mesh);

    const Index* begin(Index vertex) const { return neighbours_.data() + begin_[vertex]; }
    const Index* end(Index vertex) const { return neighbours_.data() + begin_[vertex + 1]; }

private:
    std::vector<Index> begin_;  // per vertex, and one more
    std::vector<Index> neighbours_;
};

}  // namespace knap
