#include "base/vertex_cut.hpp"

#include <limits>
#include <span>

namespace knap {
namespace {

/// Flow from source to sink. Every vertex is an arc of capacity 1 from its entry 2 v to its exit 2 v + 1.
class VertexFlow {
public:
    explicit VertexFlow(const CutGraph& graph)
        : n_(static_cast<int>(graph.at_source.size())), first_(2 * n_ + 3, 0), level_(2 * n_ + 2), next_(2 * n_ + 2) {
        struct Given {
            int from, to, capacity;
        };
        std::vector<Given> given;
        given.reserve(2 * n_ + 2 * graph.edges.size());
        for (int v = 0; v < n_; ++v) {
            given.push_back({2 * v, 2 * v + 1, 1});
            if (graph.at_source[v]) given.push_back({source(), 2 * v, endless});
            if (graph.at_sink[v]) given.push_back({2 * v + 1, sink(), endless});
        }
        for (const auto& [a, b] : graph.edges) {
            given.push_back({2 * a + 1, 2 * b, endless});
            given.push_back({2 * b + 1, 2 * a, endless});
        }
        for (const Given& arc : given) ++first_[arc.from + 1], ++first_[arc.to + 1];
        for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
        arcs_.resize(2 * given.size());
        std::vector<int> place(first_.begin(), first_.end() - 1);
        for (const Given& arc : given) {
            const int there = place[arc.from]++, back = place[arc.to]++;
            arcs_[there] = {arc.to, back, arc.capacity};
            arcs_[back] = {arc.from, there, 0};
        }
    }

    std::vector<CutSide> cut() {
        while (find_levels()) {
            next_.assign(first_.begin(), first_.end() - 1);
            while (add_path()) {
            }
        }
        std::vector<CutSide> side(n_);
        for (int v = 0; v < n_; ++v)
            side[v] = level_[2 * v] < 0 ? CutSide::sink : level_[2 * v + 1] < 0 ? CutSide::cut : CutSide::source;
        return side;
    }

private:
    static constexpr int endless = std::numeric_limits<int>::max() / 2;
    struct Arc {
        int to, reverse, capacity;
    };
    int source() const { return 2 * n_; }
    int sink() const { return 2 * n_ + 1; }
    std::span<Arc> arcs_of(int node) { return std::span(arcs_).subspan(first_[node], first_[node + 1] - first_[node]); }

    /// Numbers of arcs from the source, -1 where none leads; false: the sink is not reached.
    bool find_levels() {
        level_.assign(level_.size(), -1);
        level_[source()] = 0;
        queue_.assign(1, source());
        for (std::size_t i = 0; i < queue_.size(); ++i)
            for (const Arc& arc : arcs_of(queue_[i]))
                if (arc.capacity > 0 && level_[arc.to] < 0) {
                    level_[arc.to] = level_[queue_[i]] + 1;
                    queue_.push_back(arc.to);
                }
        return level_[sink()] >= 0;
    }

    /// One more unit along shortest paths.
    bool add_path() {
        path_.clear();
        for (int at = source(); at != sink();) {
            while (next_[at] < first_[at + 1] &&
                   (arcs_[next_[at]].capacity == 0 || level_[arcs_[next_[at]].to] != level_[at] + 1))
                ++next_[at];
            if (next_[at] < first_[at + 1]) {
                path_.push_back(next_[at]);
                at = arcs_[next_[at]].to;
            } else {
                if (path_.empty()) return false;
                at = arcs_[arcs_[path_.back()].reverse].to;
                ++next_[at];
                path_.pop_back();
            }
        }
        for (const int arc : path_) --arcs_[arc].capacity, ++arcs_[arcs_[arc].reverse].capacity;
        return true;
    }

    int n_;
    std::vector<int> first_;  // per node: into arcs_
    std::vector<Arc> arcs_;
    std::vector<int> level_, next_, queue_, path_;
};

}  // namespace

std::vector<CutSide> smallest_vertex_cut(const CutGraph& graph) { return VertexFlow(graph).cut(); }

}  // namespace knap
