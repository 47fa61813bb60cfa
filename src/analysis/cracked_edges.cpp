#include "analysis/cracked_edges.hpp"

#include "mesh/edge_graph.hpp"

#include <algorithm>
#include <set>
#include <utility>

namespace knap {

CrackedEdges::CrackedEdges(InterfaceGraph graph, Index gap_edges)
    : graph_(std::move(graph)),
      gap_edges_(gap_edges),
      edges_at_(edges_at_vertices(graph_.vertices.size(), graph_.ends)),
      status_(graph_.ends.size(), InterfaceStatus::intact),
      since_(graph_.ends.size(), never),
      connected_(graph_.vertices.size()),
      n_precracks_(graph_.vertices.size(), 0) {}

void CrackedEdges::set_graph(InterfaceGraph graph) {
    graph_ = std::move(graph);
    edges_at_ = edges_at_vertices(graph_.vertices.size(), graph_.ends);
}

void CrackedEdges::renumber(InterfaceGraph graph, const Renumbering& numbers) {
    CrackedEdges next(std::move(graph), gap_edges_);
    for (std::size_t e = 0; e < status_.size(); ++e) {
        const Index now = numbers.interface[e];
        if (now < 0) continue;
        next.status_[now] = status_[e], next.since_[now] = since_[e];
        const auto [a, b] = next.graph_.ends[now];
        if (status_[e] == InterfaceStatus::precrack) ++next.n_precracks_[a], ++next.n_precracks_[b];
        if (status_[e] == InterfaceStatus::precrack || cracked(static_cast<Index>(e))) next.connected_.join(a, b);
    }
    *this = std::move(next);
}

/// Searches along damaged edges; distances are numbers of edges.
template <class GoesOn>
Search CrackedEdges::search_gaps(Index start, GoesOn goes_on) const {
    const auto length = [&](Index e) { return status_[e] == InterfaceStatus::damaged && !cracked(e) ? 1 : never; };
    return {*this, start, Search::Ties::first_found, length, goes_on};
}

std::vector<Index> CrackedEdges::add(double time, std::span<const EdgeStatus> statuses) {
    for (const auto& [e, status] : statuses) {
        if (status != InterfaceStatus::precrack || status_[e] == status) continue;
        const auto [a, b] = graph_.ends[e];
        ++n_precracks_[a], ++n_precracks_[b];
        connected_.join(a, b);
        status_[e] = status;
    }
    std::vector<Index> joined, damaged;
    for (const auto& [e, status] : statuses) {
        if (status == std::exchange(status_[e], status)) continue;
        if (status == InterfaceStatus::broken && !cracked(e)) join(e, time, joined);
        if (status == InterfaceStatus::damaged) damaged.push_back(e);
    }
    if (gap_edges_ > 0) {
        // gaps may have become short enough next to new cracked edges, and where stretches are near new damaged ones
        std::set<Index> starts;
        for (const Index e : joined) starts.insert(graph_.ends[e].begin(), graph_.ends[e].end());
        const auto collect = [&](Index vertex, double n_edges) {
            if (!may_end_stretch(vertex)) return n_edges < gap_edges_;
            starts.insert(vertex);
            return false;
        };
        for (const Index e : damaged)
            for (const Index v : graph_.ends[e]) search_gaps(v, collect);
        for (const Index v : starts) bridge_from(v, time, joined);
    }
    std::ranges::sort(joined);
    return joined;
}

void CrackedEdges::join(Index edge, double time, std::vector<Index>& joined) {
    since_[edge] = time;
    connected_.join(graph_.ends[edge][0], graph_.ends[edge][1]);
    joined.push_back(edge);
}

/// Whether a broken stretch may end here.
bool CrackedEdges::may_end_stretch(Index vertex) const {
    if (on_precrack(vertex)) return end_of_precrack(vertex);
    return std::ranges::any_of(edges_at(vertex), [&](Index e) { return cracked(e); });
}

/// Joins the shortest ways through damaged edges from the end of one broken stretch to other stretches. The search is
/// among vertices: in a wide damaged zone there are very many ways, but few vertices.
void CrackedEdges::bridge_from(Index start, double time, std::vector<Index>& joined) {
    while (may_end_stretch(start)) {
        Index target = -1;
        const auto goes_on = [&](Index vertex, double n_edges) {
            if (vertex == start) return true;
            if (target >= 0) return false;
            if (may_end_stretch(vertex)) {
                if (connected_.find(vertex) != connected_.find(start)) target = vertex;
                return false;
            }
            return !terminal(vertex) && n_edges < gap_edges_;
        };
        const Search search = search_gaps(start, goes_on);
        if (target < 0) return;
        for (const Index e : search.edges_back(*this, target)) join(e, time, joined);
    }
}

}  // namespace knap
