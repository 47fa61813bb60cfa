#include "observe/cracked_edges.hpp"

#include <algorithm>
#include <cmath>
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

CrackedEdges::CrackedEdges(InterfaceGraph graph, double gap_length)
    : graph_(std::move(graph)),
      gap_length_(gap_length),
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
    if (gap_length_ > 0) bridge(damaged, time, joined);
    std::sort(joined.begin(), joined.end());
    return joined;
}

/// Closes the gaps that the edges that cracked or were damaged now make short enough.
void CrackedEdges::bridge(const std::vector<Index>& damaged, double time, std::vector<Index>& joined) {
    std::vector<Index> starts;
    for (const Index e : joined) starts.insert(starts.end(), graph_.ends[e].begin(), graph_.ends[e].end());
    for (const Index e : damaged)
        for (const Index v : graph_.ends[e]) near(v, gap_length_, starts);
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

/// The ends of broken stretches from which a gap may lead here.
void CrackedEdges::near(Index vertex, double left, std::vector<Index>& found) const {
    if (touched(vertex)) return found.push_back(vertex);
    for (const Index e : edges_at(vertex))
        if (can_bridge(e) && graph_.length[e] <= left) near(far_end(e, vertex), left - graph_.length[e], found);
}

struct CrackedEdges::Gap {
    Index start;  // vertex
    std::vector<Index> way, best;
    double best_length;
};

/// Looks for the shortest way through damaged edges to another stretch; `length` of gap.way, which ends at `vertex`.
void CrackedEdges::search(Index vertex, double length, Gap& gap) {
    for (const Index e : edges_at(vertex)) {
        const double further = length + graph_.length[e];
        if (!can_bridge(e) || further >= gap.best_length) continue;
        const Index next = far_end(e, vertex);
        gap.way.push_back(e);
        if (!touched(next) && !terminal(next)) search(next, further, gap);
        if (touched(next) && representative(next) != representative(gap.start)) gap.best = gap.way, gap.best_length = further;
        gap.way.pop_back();
    }
}

void CrackedEdges::bridge_from(Index vertex, double time, std::vector<Index>& joined) {
    while (touched(vertex)) {
        Gap gap{.start = vertex, .way = {}, .best = {}, .best_length = std::nextafter(gap_length_, never)};
        search(vertex, 0, gap);
        if (gap.best.empty()) return;
        for (const Index e : gap.best) join(e, time, joined);
    }
}

}  // namespace knap
