#pragma once
// The graph that cracks are read from: links are newly broken interfaces, nodes their vertices, and all vertices of one pre-crack are
// one node. With the shortest paths along it (Dijkstra 1959).
#include "observe/crack_graph.hpp"

#include <limits>
#include <span>
#include <vector>

namespace knap {

struct BrokenLink {
    Index interface;
    std::array<Index, 2> node, vertex;
    double length;  // [m]

    int side(Index n) const { return node[0] == n ? 0 : 1; }
    Index vertex_at(Index n) const { return vertex[side(n)]; }
    Index far_node(Index n) const { return node[1 - side(n)]; }
    Index far_vertex(Index n) const { return vertex[1 - side(n)]; }
};

struct BrokenNode {
    static constexpr double unreached = std::numeric_limits<double>::infinity();

    Index vertex;           // one of them, when the node is a pre-crack
    bool precrack = false;  // all vertices of one pre-crack
    bool boundary = false;
    double distance = unreached;  // [m] from the root of the last search of its piece
    Index parent = -1;            // link towards that root
};

class BrokenGraph {
public:
    BrokenGraph(const InterfaceGraph& graph, std::span<const InterfaceStatus> status);

    Index n_nodes() const { return static_cast<Index>(nodes_.size()); }
    const BrokenNode& node(Index n) const { return nodes_[n]; }
    const std::vector<BrokenLink>& links() const { return links_; }
    const BrokenLink& link(Index l) const { return links_[l]; }
    std::span<const Index> links_at(Index node) const;
    /// An end of a pre-crack inside the body.
    bool end_of_precrack(Index vertex) const { return precrack_edges_[vertex] == 1 && !on_boundary_[vertex]; }

    /// Sets distance and parent of every node of the piece of `root` and returns them, nearest first.
    std::vector<Index> shortest_paths(Index root);

    /// Length of the loop that a link outside the tree of shortest paths closes [m].
    double loop_length(const BrokenLink& link) const;

private:
    void connect();

    std::vector<BrokenNode> nodes_;
    std::vector<BrokenLink> links_;
    std::vector<Index> first_, around_;  // links at each node
    std::vector<Index> precrack_edges_;  // per vertex
    std::span<const std::uint8_t> on_boundary_;
};

}  // namespace knap
