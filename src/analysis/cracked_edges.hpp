#pragma once
// The interfaces that belong to cracks: the broken ones, and damaged ones that bridge a short gap between two broken
// stretches. The set only grows. And shortest ways along interfaces.
#include "analysis/interface_graph.hpp"
#include "base/grouped.hpp"
#include "base/union_find.hpp"
#include "stepper/adapt/adaptation.hpp"

#include <functional>
#include <map>
#include <queue>
#include <span>
#include <tuple>

namespace knap {

struct Search;

class CrackedEdges {
public:
    static constexpr double never = infinity;

    /// `gap_edges`: the largest number of damaged interfaces in a gap that is bridged.
    CrackedEdges(InterfaceGraph graph, Index gap_edges);

    /// Takes statuses of a later time [s], in the order of the edges; the first time with all pre-cracks. Returns the
    /// edges that join the set, ascending.
    std::vector<Index> add(double time, std::span<const EdgeStatus> statuses);

    /// In place of a graph with the same numbers.
    void set_graph(InterfaceGraph graph);

    /// The graph of a refined mesh, with the new numbers of vertices and edges; edges that are gone were intact.
    void renumber(InterfaceGraph graph, const Renumbering& numbers);

    /// The clock is set back by `time` [s].
    void set_back(double time) {
        for (double& since : since_) since -= time;
    }

    const InterfaceGraph& graph() const { return graph_; }
    std::span<const Index> edges_at(Index vertex) const { return edges_at_[vertex]; }
    Index far_end(Index edge, Index vertex) const { return graph_.ends[edge][graph_.ends[edge][0] == vertex]; }
    InterfaceStatus status(Index edge) const { return status_[edge]; }  // at the last time
    std::span<const InterfaceStatus> status() const { return status_; }
    double since(Index edge) const { return since_[edge]; }  // [s] when it joined the set; else infinite
    bool cracked(Index edge) const { return since_[edge] < never; }
    bool on_precrack(Index vertex) const { return n_precracks_[vertex] > 0; }
    bool end_of_precrack(Index vertex) const { return n_precracks_[vertex] == 1 && !graph_.on_boundary[vertex]; }
    /// Cracks end and start here.
    bool terminal(Index vertex) const { return graph_.on_boundary[vertex] || on_precrack(vertex); }

    void serialize(auto& archive) { archive(status_, since_, connected_, n_precracks_); }

private:
    void join(Index edge, double time, std::vector<Index>& joined);
    bool may_end_stretch(Index vertex) const;
    template <class GoesOn>
    Search search_gaps(Index start, GoesOn goes_on) const;
    void bridge_from(Index start, double time, std::vector<Index>& joined);

    InterfaceGraph graph_;
    Index gap_edges_;
    Grouped<Index> edges_at_;              // per vertex
    std::vector<InterfaceStatus> status_;  // of the last time
    std::vector<double> since_;
    UnionFind connected_;             // vertices connected by pre-cracks and cracked edges
    std::vector<Index> n_precracks_;  // per vertex: pre-cracked edges
};

/// Shortest ways from a vertex in the graph of all interfaces (Dijkstra).
struct Search {
    enum class Ties { first_found, lowest_vertex };  // which of equally long ways is taken
    struct Way {
        double length;
        Index edge;  // its last one; -1 at the start
    };
    std::map<Index, Way> ways;  // to every vertex reached
    std::vector<Index> order;   // these vertices, the nearest first

    /// length(edge): of an edge, infinite where it may not be passed; goes_on(vertex, distance): whether ways lead
    /// beyond a vertex.
    template <class Length, class GoesOn>
    Search(const CrackedEdges& edges, Index start, Ties ties, Length length, GoesOn goes_on) {
        using Entry = std::tuple<double, Index, Index, Index>;  // distance, rank, vertex before, edge
        std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
        Index n_found = 0;
        const auto reach = [&](Index vertex, double distance, Index edge) {
            if (!ways.try_emplace(vertex, Way{distance, edge}).second) return;
            order.push_back(vertex);
            if (!goes_on(vertex, distance)) return;
            for (const Index e : edges.edges_at(vertex))
                if (const double l = length(e); l < infinity)
                    queue.emplace(distance + l, ties == Ties::first_found ? n_found++ : edges.far_end(e, vertex),
                                  vertex, e);
        };
        for (reach(start, 0, -1); !queue.empty();) {
            const auto [distance, rank, before, edge] = queue.top();
            queue.pop();
            reach(edges.far_end(edge, before), distance, edge);
        }
    }

    Index farthest() const { return order.back(); }

    /// The edges from a vertex back to the start.
    std::vector<Index> edges_back(const CrackedEdges& edges, Index vertex) const {
        std::vector<Index> way;
        for (; vertex != order.front(); vertex = edges.far_end(way.back(), vertex)) way.push_back(ways.at(vertex).edge);
        return way;
    }
};

}  // namespace knap
