#include "mesh/planar_graph.hpp"

#include <algorithm>
#include <cmath>

namespace knap {

namespace {

/// Inserts one straight piece after the other; earlier pieces keep their place, later ones are bent onto them.
class GraphBuilder {
public:
    explicit GraphBuilder(PlanarGraph& graph) : graph_(graph) {}

    /// Points of the piece that are nearer than the tolerance to earlier nodes and segments are moved onto these.
    void insert(const Segment& piece, double tolerance, const GraphSegment& labels) {
        tolerance_ = tolerance;
        const Index from = node_at(piece.a), to = node_at(piece.b);
        connect_through(from, to, labels, 0);
    }

private:
    struct Stop {
        double position;  // on the piece, 0..1
        Index node;
    };

    /// Connects two nodes through all nodes between them; a piece that was bent onto one may then come across others.
    void connect_through(Index from, Index to, const GraphSegment& labels, int n_bends) {
        if (from == to) return;
        const Vec2 p = graph_.nodes[from], q = graph_.nodes[to];
        split_crossed(p, q);
        const Vec2 low = p.cwiseMin(q).array() - tolerance_, high = p.cwiseMax(q).array() + tolerance_;
        std::vector<Stop> stops{{0.0, from}};
        for (Index n = 0; n < n_nodes(); ++n) {
            const Vec2& r = graph_.nodes[n];
            if (n == from || n == to || (r.array() < low.array()).any() || (r.array() > high.array()).any()) continue;
            const double t = nearest_parameter(p, q, r);
            if (t > 0 && t < 1 && distance_to_segment(p, q, r) <= tolerance_) stops.push_back({t, n});
        }
        std::stable_sort(stops.begin(), stops.end(),
                         [](const Stop& s, const Stop& t) { return s.position < t.position; });
        stops.push_back({1.0, to});
        constexpr int max_bends = 6;
        for (std::size_t i = 0; i + 1 < stops.size(); ++i) {
            if (stops.size() == 2 || n_bends == max_bends) connect(stops[i].node, stops[i + 1].node, labels);
            else connect_through(stops[i].node, stops[i + 1].node, labels, n_bends + 1);
        }
    }

    Index n_nodes() const { return static_cast<Index>(graph_.nodes.size()); }

    /// The node at p: an old one, a new one on the segment that p lies on, or a new free one.
    Index node_at(const Vec2& p) {
        Index nearest = -1;
        double nearest_distance = tolerance_;
        for (Index n = 0; n < n_nodes(); ++n) {
            const double distance = (graph_.nodes[n] - p).norm();
            if (distance <= nearest_distance) nearest = n, nearest_distance = distance;
        }
        if (nearest >= 0) return nearest;
        for (std::size_t s = 0; s < graph_.segments.size(); ++s) {
            const auto [a, b] = graph_.line(graph_.segments[s]);
            if (distance_to_segment(a, b, p) <= tolerance_) return split(s, a + nearest_parameter(a, b, p) * (b - a));
        }
        graph_.nodes.push_back(p);
        return n_nodes() - 1;
    }

    Index split(std::size_t s, const Vec2& p) {
        graph_.nodes.push_back(p);
        const Index middle = n_nodes() - 1;
        GraphSegment second = graph_.segments[s];
        graph_.segments[s].to = middle;
        second.from = middle;
        graph_.segments.push_back(second);
        return middle;
    }

    void split_crossed(const Vec2& p, const Vec2& q) {
        const std::size_t n_before = graph_.segments.size();
        for (std::size_t s = 0; s < n_before; ++s) {
            const auto [a, b] = graph_.line(graph_.segments[s]);
            double t;
            if (!segments_cross({a, b}, {p, q}, t)) continue;
            const Vec2 crossing = a + t * (b - a);
            if ((crossing - a).norm() > tolerance_ && (crossing - b).norm() > tolerance_) split(s, crossing);
        }
    }

    void connect(Index from, Index to, const GraphSegment& labels) {
        if (from == to) return;
        for (GraphSegment& old : graph_.segments) {
            if (!((old.from == from && old.to == to) || (old.from == to && old.to == from))) continue;
            if (old.crack < 0) old.crack = labels.crack;
            old.region = std::max(old.region, labels.region);
            return;
        }
        GraphSegment fresh = labels;
        fresh.from = from;
        fresh.to = to;
        graph_.segments.push_back(fresh);
    }

    PlanarGraph& graph_;
    double tolerance_ = 0;  // [m]
};

/// The last region that covers p, -1 for none.
Index region_at(const std::vector<Region>& regions, const std::vector<Box>& boxes, const Vec2& p) {
    for (Index i = static_cast<Index>(regions.size()) - 1; i >= 0; --i)
        if (boxes[i].contains(p) && contains(regions[i].points, p)) return i;
    return -1;
}

/// Drops lines outside the body, and borders that a later region covers on both sides.
void cut_off(PlanarGraph& graph, const Shape& shape, double tolerance) {
    std::vector<Box> boxes;
    for (const Region& region : shape.regions) boxes.push_back(bounding_box(region.points));
    std::erase_if(graph.segments, [&](GraphSegment& s) {
        if (s.ring >= 0) {
            s.crack = s.region = -1;
            return false;
        }
        const auto [a, b] = graph.line(s);
        const Vec2 middle = 0.5 * (a + b);
        if (!shape.contains(middle)) return true;
        if (s.region < 0) return false;
        const Vec2 aside = 4 * tolerance * turned_left(b - a).normalized();
        const Index left = region_at(shape.regions, boxes, middle + aside),
                    right = region_at(shape.regions, boxes, middle - aside);
        if (left == right && left > s.region) s.region = -1;
        return s.crack < 0 && s.region < 0;
    });
}

void drop_unused_nodes(PlanarGraph& graph) {
    std::vector<Index> number(graph.nodes.size(), -1);
    std::vector<Vec2> kept;
    const auto renumber = [&](Index& node) {
        if (number[node] < 0) {
            number[node] = static_cast<Index>(kept.size());
            kept.push_back(graph.nodes[node]);
        }
        node = number[node];
    };
    for (GraphSegment& s : graph.segments) renumber(s.from), renumber(s.to);
    graph.nodes = std::move(kept);
}

}  // namespace

PlanarGraph planar_graph(const Shape& shape, double region_tolerance) {
    PlanarGraph graph;
    const double tolerance = shape.tolerance();
    GraphBuilder builder(graph);
    const auto insert_ring = [&](const Ring& ring, Index number) {
        auto boundary = ring.boundary.begin();
        for (const Segment& s : sides_of(ring.points, true))
            builder.insert(s, tolerance, {.ring = number, .boundary = *boundary++});
    };
    insert_ring(shape.outer, 0);
    for (Index i = 0; i < std::ssize(shape.holes); ++i) insert_ring(shape.holes[i], i + 1);
    for (Index i = 0; i < std::ssize(shape.cracks); ++i)
        for (const Segment& s : sides_of(shape.cracks[i].points, false)) builder.insert(s, tolerance, {.crack = i});
    for (Index i = 0; i < std::ssize(shape.regions); ++i)
        for (const Segment& s : sides_of(shape.regions[i].points, true))
            builder.insert(s, std::max(tolerance, region_tolerance), {.region = i});
    cut_off(graph, shape, tolerance);
    drop_unused_nodes(graph);
    return graph;
}

std::string part_name(const GraphSegment& segment) {
    if (segment.crack >= 0) return "cracks[" + std::to_string(segment.crack) + "]";
    if (segment.region >= 0) return "regions[" + std::to_string(segment.region) + "]";
    return segment.ring > 0 ? "holes[" + std::to_string(segment.ring - 1) + "]" : "outer";
}

bool Shape::contains(const Vec2& p) const {
    const auto covers = [&](const Ring& ring) { return knap::contains(ring.points, p); };
    return covers(outer) && std::none_of(holes.begin(), holes.end(), covers);
}

double Shape::area() const {
    double sum = std::abs(signed_area(outer.points));
    for (const Ring& hole : holes) sum -= std::abs(signed_area(hole.points));
    return sum;
}

double Shape::tolerance() const { return 1e-6 * bounding_box(outer.points).diagonal(); }

}  // namespace knap
