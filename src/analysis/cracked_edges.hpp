#pragma once
// The interfaces that belong to cracks: the broken ones, and damaged ones that bridge a short gap between two broken stretches. The set only grows.
#include "analysis/crack_graph.hpp"

#include <limits>
#include <span>

namespace knap {

class CrackedEdges {
public:
    CrackedEdges(InterfaceGraph graph, Index gap_edges);

    /// Takes the status of all interfaces at a later time [s]; those that join the set now, ascending.
    std::vector<Index> add(double time, std::span<const InterfaceStatus> status);

    const InterfaceGraph& graph() const { return graph_; }
    std::span<const Index> edges_at(Index vertex) const;
    Index far_end(Index edge, Index vertex) const { return graph_.ends[edge][graph_.ends[edge][0] == vertex]; }
    double since(Index edge) const { return since_[edge]; }  // [s] first time that found it broken or a bridge; infinite before
    bool cracked(Index edge) const { return since_[edge] < never; }
    const std::vector<Index>& broken() const { return broken_; }  // ascending
    const std::vector<Index>& damaged() const { return damaged_; }  // but not broken; ascending
    bool on_precrack(Index vertex) const { return precrack_edges_[vertex] > 0; }
    bool end_of_precrack(Index vertex) const { return precrack_edges_[vertex] == 1 && !graph_.on_boundary[vertex]; }
    /// Here cracks end, and start anew.
    bool terminal(Index vertex) const { return graph_.on_boundary[vertex] || on_precrack(vertex); }

    template <class Archive>
    void serialize(Archive& archive) {
        archive(status_, since_, broken_, damaged_, set_, precrack_edges_);
    }

private:
    static constexpr double never = std::numeric_limits<double>::infinity();

    void find_precracks(std::span<const InterfaceStatus> status);
    Index representative(Index vertex);
    void join(Index edge, double time, std::vector<Index>& joined);
    bool touched(Index vertex) const;
    bool can_bridge(Index edge) const { return status_[edge] == InterfaceStatus::damaged && !cracked(edge); }
    /// How many edges led to a vertex, and the last of them.
    struct Way {
        Index n_edges, edge;
    };
    enum class Spread { on, stop, end };
    template <class Visit>
    void spread(Index start, Visit&& visit) const;
    void near(Index start, std::vector<Index>& found) const;
    void bridge(const std::vector<Index>& damaged, double time, std::vector<Index>& joined);
    void bridge_from(Index start, double time, std::vector<Index>& joined);

    InterfaceGraph graph_;
    Index gap_edges_;
    std::vector<Index> first_, around_;    // edges at each vertex
    std::vector<InterfaceStatus> status_;  // of the last time
    std::vector<double> since_;
    std::vector<Index> broken_, damaged_;
    std::vector<Index> set_;               // per vertex: union-find of what hangs together by pre-cracks and cracked edges
    std::vector<Index> precrack_edges_;    // per vertex
};

}  // namespace knap
