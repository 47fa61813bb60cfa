#include "analysis/cracked_edges.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

namespace knap {
namespace {

/// Adds ascending numbers to ascending ones.
void insert(const std::vector<Index>& added, std::vector<Index>& to) {
    const auto middle = to.insert(to.end(), added.begin(), added.end());
    std::inplace_merge(to.begin(), middle, to.end());
}

}  // namespace

CrackedEdges::CrackedEdges(InterfaceGraph graph, Index gap_edges)
    : graph_(std::move(graph)),
      gap_edges_(gap_edges),
      first_(graph_.vertices.size() + 1, 0),
      around_(2 * graph_.ends.size()),
      since_(graph_.ends.size(), never),
      set_(graph_.vertices.size()),
      precrack_edges_(graph_.vertices.size(), 0) {
    std::iota(set_.begin(), set_.end(), 0);
    for (const auto& [a, b] : graph_.ends) ++first_[a + 1], ++first_[b + 1];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    std::vector<Index> next(first_.begin(), first_.end() - 1);
    for (Index e = 0; e < static_cast<Index>(graph_.ends.size()); ++e)
        for (const Index v : graph_.ends[e]) around_[next[v]++] = e;
}

std::span<const Index> CrackedEdges::edges_at(Index vertex) const {
    return {around_.data() + first_[vertex], static_cast<std::size_t>(first_[vertex + 1] - first_[vertex])};
}

Index CrackedEdges::representative(Index vertex) {
    while (set_[vertex] != vertex) vertex = set_[vertex] = set_[set_[vertex]];
    return vertex;
}

void CrackedEdges::find_precracks(std::span<const InterfaceStatus> status) {
    status_.assign(status.size(), InterfaceStatus::intact);
    for (std::size_t e = 0; e < status.size(); ++e) {
        if (status[e] != InterfaceStatus::precrack) continue;
        const auto [a, b] = graph_.ends[e];
        ++precrack_edges_[a], ++precrack_edges_[b];
        set_[representative(a)] = representative(b);
    }
}

std::vector<Index> CrackedEdges::add(double time, std::span<const InterfaceStatus> status) {
    if (status_.empty()) find_precracks(status);
    std::vector<Index> joined, broken, damaged;
    for (Index e = 0; e < static_cast<Index>(status.size()); ++e) {
        if (status[e] == status_[e]) continue;
        status_[e] = status[e];
        if (status[e] == InterfaceStatus::broken) broken.push_back(e);
        if (status[e] == InterfaceStatus::damaged) damaged.push_back(e);
    }
    std::erase_if(damaged_, [&](Index e) { return status_[e] != InterfaceStatus::damaged; });
    insert(broken, broken_);
    insert(damaged, damaged_);
    for (const Index e : broken)
        if (!cracked(e)) join(e, time, joined);
    if (gap_edges_ > 0) bridge(damaged, time, joined);
    std::sort(joined.begin(), joined.end());
    return joined;
}

/// Closes the gaps that the edges that cracked or were damaged now make short enough.
void CrackedEdges::bridge(const std::vector<Index>& damaged, double time, std::vector<Index>& joined) {
    std::vector<Index> starts;
    for (const Index e : joined) starts.insert(starts.end(), graph_.ends[e].begin(), graph_.ends[e].end());
    for (const Index e : damaged)
        for (const Index v : graph_.ends[e]) near(v, starts);
    std::sort(starts.begin(), starts.end());
    starts.erase(std::unique(starts.begin(), starts.end()), starts.end());
    for (const Index v : starts) bridge_from(v, time, joined);
}

void CrackedEdges::join(Index edge, double time, std::vector<Index>& joined) {
    since_[edge] = time;
    set_[representative(graph_.ends[edge][0])] = representative(graph_.ends[edge][1]);
    joined.push_back(edge);
}

/// A broken stretch may end here.
bool CrackedEdges::touched(Index vertex) const {
    if (on_precrack(vertex)) return end_of_precrack(vertex);
    const auto edges = edges_at(vertex);
    return std::any_of(edges.begin(), edges.end(), [&](Index e) { return cracked(e); });
}

/// Spreads from a vertex through damaged edges, the vertices with the fewest first, no farther than a gap may be long: in a wide damaged zone there are very many
/// ways, but few vertices. `visit` says of each vertex with the ways that led so far whether to end here, to stop or to go on.
template <class Visit>
void CrackedEdges::spread(Index start, Visit&& visit) const {
    std::map<Index, Way> ways{{start, {0, -1}}};
    std::vector<Index> order{start};
    for (std::size_t i = 0; i < order.size(); ++i) {
        const Index vertex = order[i], n_edges = ways.at(vertex).n_edges;
        const Spread next = visit(vertex, ways);
        if (next == Spread::end) return;
        if (next == Spread::stop || n_edges == gap_edges_) continue;
        for (const Index e : edges_at(vertex))
            if (can_bridge(e) && ways.try_emplace(far_end(e, vertex), Way{n_edges + 1, e}).second) order.push_back(far_end(e, vertex));
    }
}

/// The ends of broken stretches from which a gap may lead here.
void CrackedEdges::near(Index start, std::vector<Index>& found) const {
    spread(start, [&](Index vertex, const std::map<Index, Way>&) {
        if (!touched(vertex)) return Spread::on;
        found.push_back(vertex);
        return Spread::stop;
    });
}

/// Joins the shortest ways through damaged edges from the end of one broken stretch to others.
void CrackedEdges::bridge_from(Index start, double time, std::vector<Index>& joined) {
    std::vector<Index> gap;
    do {
        gap.clear();
        if (!touched(start)) return;
        spread(start, [&](Index vertex, const std::map<Index, Way>& ways) {
            if (vertex == start) return Spread::on;
            if (!touched(vertex)) return terminal(vertex) ? Spread::stop : Spread::on;
            if (representative(vertex) == representative(start)) return Spread::stop;
            for (Index v = vertex; v != start; v = far_end(gap.back(), v)) gap.push_back(ways.at(v).edge);
            return Spread::end;
        });
        for (const Index e : gap) join(e, time, joined);
    } while (!gap.empty());
}

}  // namespace knap
