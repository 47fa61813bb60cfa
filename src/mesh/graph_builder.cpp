#include "mesh/graph_builder.hpp"

#include <algorithm>

namespace knap {

constexpr std::size_t max_cells = 1'000'000;
constexpr int max_crossings = 100'000;  // found in seconds

GraphBuilder::GraphBuilder(PlanarGraph& graph, const Box& box, std::size_t n_pieces)
    : graph_(graph),
      near_nodes_(box, std::min(64 * n_pieces, max_cells)),
      near_segments_(box, std::min(64 * n_pieces, max_cells)) {
    while (at_node_.size() < graph_.nodes.size()) register_node();
    const std::vector<GraphSegment> segments = std::move(graph_.segments);
    graph_.segments.clear();
    for (const GraphSegment& s : segments) graph_.segments.push_back(s), register_segment();
}

void GraphBuilder::insert(const std::vector<Segment>& pieces, double tolerance, GraphSegment labels,
                          const std::vector<Index>& boundaries) {
    tolerance_ = tolerance;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        if (!boundaries.empty()) labels.boundary = boundaries[i];
        const Index from = node_at(pieces[i].a), to = node_at(pieces[i].b);
        connect_through(from, to, labels, 0);
    }
}

/// Connects two nodes through all nodes between them; a piece that was bent onto one may then come across others.
void GraphBuilder::connect_through(Index from, Index to, const GraphSegment& labels, int n_bends) {
    if (from == to) return;
    const Vec2 p = graph_.nodes[from], q = graph_.nodes[to];
    split_crossed(p, q, labels);
    const Vec2 low = p.cwiseMin(q).array() - tolerance_, high = p.cwiseMax(q).array() + tolerance_;
    std::vector<std::pair<double, Index>> stops{{0.0, from}};  // position on the piece, 0..1, and node
    for (const Index n : near_nodes_.near({p, q}, tolerance_)) {
        const Vec2& r = graph_.nodes[n];
        if (n == from || n == to || !Box{low, high}.contains(r)) continue;
        const double t = nearest_parameter(p, q, r);
        if (t > 0 && t < 1 && distance_to_segment(p, q, r) <= tolerance_) stops.emplace_back(t, n);
    }
    std::ranges::sort(stops);
    stops.emplace_back(1.0, to);
    constexpr int max_bends = 6;
    for (std::size_t i = 0; i + 1 < stops.size(); ++i) {
        const Index here = stops[i].second, next = stops[i + 1].second;
        if (stops.size() == 2 || n_bends == max_bends) connect(here, next, labels);
        else connect_through(here, next, labels, n_bends + 1);
    }
}

void GraphBuilder::register_node() {
    const Index n = static_cast<Index>(at_node_.size());
    at_node_.emplace_back();
    near_nodes_.add({graph_.nodes[n], graph_.nodes[n]}, n);
}

/// The last one.
void GraphBuilder::register_segment() {
    const Index s = static_cast<Index>(graph_.segments.size()) - 1;
    const GraphSegment& added = graph_.segments.back();
    at_node_[added.from].push_back(s), at_node_[added.to].push_back(s);
    near_segments_.add(graph_.line(added), s);
}

Index GraphBuilder::add_node(const Vec2& p) {
    graph_.nodes.push_back(p);
    register_node();
    return static_cast<Index>(graph_.nodes.size()) - 1;
}

/// The node at p: an old one, a new one on the segment that p lies on, or a new free one.
Index GraphBuilder::node_at(const Vec2& p) {
    Index nearest = -1;
    double nearest_distance = tolerance_;
    for (const Index n : near_nodes_.near({p, p}, tolerance_)) {
        const double distance = (graph_.nodes[n] - p).norm();
        if (distance <= nearest_distance) nearest = n, nearest_distance = distance;
    }
    if (nearest >= 0) return nearest;
    for (const Index s : near_segments_.near({p, p}, tolerance_)) {
        const auto [a, b] = graph_.line(graph_.segments[s]);
        if (distance_to_segment(a, b, p) <= tolerance_) return split(s, a + nearest_parameter(a, b, p) * (b - a));
    }
    return add_node(p);
}

Index GraphBuilder::split(std::size_t s, const Vec2& p) {
    GraphSegment second = graph_.segments[s];
    graph_.segments[s].to = second.from = add_node(p);
    at_node_[second.from].push_back(static_cast<Index>(s));
    graph_.segments.push_back(second);
    const Index added = static_cast<Index>(graph_.segments.size()) - 1;
    at_node_[second.from].push_back(added), at_node_[second.to].push_back(added);
    near_segments_.cut(graph_.line(second), static_cast<Index>(s), added);
    return second.from;
}

void GraphBuilder::split_crossed(const Vec2& p, const Vec2& q, const GraphSegment& labels) {
    for (const Index s : near_segments_.near({p, q}, 0)) {
        const auto [a, b] = graph_.line(graph_.segments[s]);
        double t;
        if (!segments_cross({a, b}, {p, q}, t)) continue;
        if (++n_crossings_ > max_crossings)
            throw ShapeError(labels.part_name(), "crosses itself and other lines at more than ", max_crossings,
                             " places, more than a mesh resolves: draw fewer corners, in the order of the line");
        const Vec2 crossing = a + t * (b - a);
        if ((crossing - a).norm() > tolerance_ && (crossing - b).norm() > tolerance_) split(s, crossing);
    }
}

void GraphBuilder::connect(Index from, Index to, GraphSegment labels) {
    if (from == to) return;
    for (const Index s : at_node_[from]) {
        GraphSegment& old = graph_.segments[s];
        if (std::minmax(old.from, old.to) != std::minmax(from, to)) continue;
        if (old.crack < 0) old.crack = labels.crack;
        old.region = std::max(old.region, labels.region);
        return;
    }
    labels.from = from, labels.to = to;
    graph_.segments.push_back(labels);
    register_segment();
}

}  // namespace knap
