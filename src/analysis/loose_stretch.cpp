#include "analysis/loose_stretch.hpp"

#include <algorithm>
#include <queue>
#include <tuple>
#include <unordered_map>
#include <utility>

namespace knap {
namespace {

struct Reached {
    double distance;  // [m]
    Index parent;     // vertex
};
using Paths = std::unordered_map<Index, Reached>;

class Stretch {
public:
    Stretch(const CrackedEdges& edges, std::span<const Index> node_of) : edges_(edges), node_of_(node_of) {}

    /// Shortest paths from `root`; `order` has the vertices, the nearest first. Nothing leads on from a terminal vertex.
    Paths paths(Index root, std::vector<Index>& order) const {
        using Entry = std::tuple<double, Index, Index>;  // distance, vertex, parent
        std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
        Paths paths;
        queue.emplace(0.0, root, -1);
        order.clear();
        while (!queue.empty()) {
            const auto [distance, vertex, parent] = queue.top();
            queue.pop();
            if (!paths.try_emplace(vertex, Reached{distance, parent}).second) continue;
            order.push_back(vertex);
            if (vertex != root && edges_.terminal(vertex)) continue;
            for (const Index e : edges_.edges_at(vertex))
                if (edges_.cracked(e) && node_of_[e] == -1) queue.emplace(distance + edges_.graph().length[e], edges_.far_end(e, vertex), vertex);
        }
        return paths;
    }

private:
    const CrackedEdges& edges_;
    std::span<const Index> node_of_;
};

std::vector<Index> way_to(Index vertex, const Paths& paths) {
    std::vector<Index> way;
    for (; vertex >= 0; vertex = paths.at(vertex).parent) way.push_back(vertex);
    std::reverse(way.begin(), way.end());
    return way;
}

}  // namespace

LooseStretch loose_stretch(const CrackedEdges& edges, std::span<const Index> node_of, Index edge) {
    const Stretch stretch(edges, node_of);
    const auto [a, b] = edges.graph().ends[edge];
    std::vector<Index> order;
    stretch.paths(edges.terminal(a) ? b : a, order);
    LooseStretch found;
    for (const Index v : order)
        for (const Index e : edges.edges_at(v))
            if (edges.cracked(e) && node_of[e] == -1 && (!edges.terminal(v) || std::find(order.begin(), order.end(), edges.far_end(e, v)) != order.end())) found.edges.push_back(e);
    std::sort(found.edges.begin(), found.edges.end());
    found.edges.erase(std::unique(found.edges.begin(), found.edges.end()), found.edges.end());

    // of several the same one as long as the stretch grows
    const auto rank = [&](Index v) { return std::tuple(!edges.end_of_precrack(v), !edges.on_precrack(v), !edges.terminal(v), v); };
    Index root = *std::min_element(order.begin(), order.end(), [&](Index m, Index n) { return rank(m) < rank(n); });
    found.at_end_of_precrack = edges.end_of_precrack(root);
    if (edges.on_precrack(root)) {
        found.start = CrackStart::precrack;
    } else if (edges.terminal(root)) {
        found.start = CrackStart::boundary;
        stretch.paths(root, order);
        root = *std::find_if(order.rbegin(), order.rend(), [&](Index v) { return edges.terminal(v); });
    } else {
        found.start = CrackStart::inside;
        const Index one_end = order.back();
        const Paths across = stretch.paths(one_end, order);
        found.length = across.at(order.back()).distance;
        const double half = 0.5 * found.length;
        root = order.back();
        while (across.at(root).distance > half) root = across.at(root).parent;
    }
    const Paths paths = stretch.paths(root, order);
    found.way = way_to(order.back(), paths);
    found.ends = edges.terminal(order.back());
    if (found.start != CrackStart::inside) found.length = paths.at(order.back()).distance;
    return found;
}

}  // namespace knap
