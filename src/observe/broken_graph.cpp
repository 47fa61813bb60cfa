#include "observe/broken_graph.hpp"

#include <algorithm>
#include <numeric>
#include <queue>
#include <utility>

namespace knap {

BrokenGraph::BrokenGraph(const InterfaceGraph& graph, std::span<const InterfaceStatus> status) : on_boundary_(graph.on_boundary) {
    std::vector<Index> broken, precrack;
    for (Index i = 0; i < static_cast<Index>(status.size()); ++i) {
        if (status[i] == InterfaceStatus::broken) broken.push_back(i);
        if (status[i] == InterfaceStatus::precrack) precrack.push_back(i);
    }
    if (broken.empty()) return;

    // the vertices of a pre-crack, by union-find
    std::vector<Index> set(graph.vertices.size());
    std::iota(set.begin(), set.end(), 0);
    const auto representative = [&](Index v) {
        while (set[v] != v) v = set[v] = set[set[v]];
        return v;
    };
    precrack_edges_.assign(graph.vertices.size(), 0);
    for (const Index i : precrack) {
        const auto [a, b] = graph.ends[i];
        ++precrack_edges_[a], ++precrack_edges_[b];
        set[representative(a)] = representative(b);
    }

    std::vector<Index> node_of(graph.vertices.size(), -1);  // by representative
    const auto node = [&](Index vertex) {
        const Index r = representative(vertex);
        if (node_of[r] < 0) {
            node_of[r] = n_nodes();
            nodes_.push_back({.vertex = r, .precrack = precrack_edges_[r] > 0, .boundary = graph.on_boundary[r] != 0});
        }
        return node_of[r];
    };
    for (const Index i : broken) {
        const auto [a, b] = graph.ends[i];
        const Index node_a = node(a), node_b = node(b);
        if (node_a != node_b) links_.push_back({i, {node_a, node_b}, {a, b}, graph.length[i]});
    }
    connect();
}

void BrokenGraph::connect() {
    first_.assign(nodes_.size() + 1, 0);
    for (const BrokenLink& l : links_) ++first_[l.node[0] + 1], ++first_[l.node[1] + 1];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    around_.resize(2 * links_.size());
    std::vector<Index> next(first_.begin(), first_.end() - 1);
    for (Index l = 0; l < static_cast<Index>(links_.size()); ++l) {
        for (const Index n : links_[l].node) around_[next[n]++] = l;
    }
}

std::span<const Index> BrokenGraph::links_at(Index node) const {
    return {around_.data() + first_[node], static_cast<std::size_t>(first_[node + 1] - first_[node])};
}

std::vector<Index> BrokenGraph::shortest_paths(Index root) {
    // a piece is either reached as a whole or not at all: what an earlier search left there is cleared first
    std::vector<Index> order{root};
    if (nodes_[root].distance < BrokenNode::unreached) {
        nodes_[root].distance = BrokenNode::unreached;
        for (std::size_t k = 0; k < order.size(); ++k) {
            for (const Index l : links_at(order[k])) {
                BrokenNode& other = nodes_[links_[l].far_node(order[k])];
                if (std::exchange(other.distance, BrokenNode::unreached) < BrokenNode::unreached)
                    order.push_back(links_[l].far_node(order[k]));
            }
        }
    }
    order.clear();

    using Entry = std::pair<double, Index>;  // ties by node number: the same tree in every run
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    nodes_[root].distance = 0;
    nodes_[root].parent = -1;
    queue.emplace(0.0, root);
    while (!queue.empty()) {
        const auto [distance, n] = queue.top();
        queue.pop();
        if (distance > nodes_[n].distance) continue;
        order.push_back(n);
        for (const Index l : links_at(n)) {
            const Index other = links_[l].far_node(n);
            if (distance + links_[l].length >= nodes_[other].distance) continue;
            nodes_[other].distance = distance + links_[l].length;
            nodes_[other].parent = l;
            queue.emplace(nodes_[other].distance, other);
        }
    }
    return order;
}

double BrokenGraph::loop_length(const BrokenLink& link) const {
    auto [a, b] = link.node;
    double length = link.length;
    while (a != b) {
        Index& further = nodes_[a].distance > nodes_[b].distance ? a : b;
        const BrokenLink& back = links_[nodes_[further].parent];
        length += back.length;
        further = back.far_node(further);
    }
    return length;
}

}  // namespace knap
