#include "mesh/snap_lines.hpp"

#include "mesh/search_grid.hpp"

#include <map>
#include <numbers>
#include <set>

namespace knap {
namespace {

constexpr int max_rounds = 60;                                    // some 5 are enough for a map of 2 000 traces
constexpr double smallest_angle = 1.05 * std::numbers::pi / 180;  // [rad] a little above the one that is refused

class SnappedLines {
public:
    SnappedLines(PlanarGraph& graph, const Shape& shape, const std::vector<Vec2>& corners)
        : nodes_(graph.nodes),
          segments_(graph.segments),
          box_(bounding_box(shape.outer.points)),
          n_cracks_(static_cast<Index>(shape.cracks.size())),
          snap_(shape.snap) {
        std::set<std::pair<double, double>> places;
        for (const Vec2& x : corners) places.emplace(x.x(), x.y());
        for (const Vec2& x : nodes_) is_corner_.push_back(places.contains({x.x(), x.y()}));
    }

    SnapCounts run() {
        for (int round = 0; round < max_rounds; ++round) {
            const bool merged = merge(), folded = fold(), bent = bend(), crossed = cross_over();
            if (!merged && !folded && !bent && !crossed && !part()) break;
        }
        const std::set<Index> after = cracks();
        for (Index i = 0; i < n_cracks_; ++i)
            if (!after.contains(i)) counts_.lost.push_back(i);
        return counts_;
    }

private:
    Index n_nodes() const { return static_cast<Index>(nodes_.size()); }
    Segment line(const GraphSegment& s) const { return {nodes_[s.from], nodes_[s.to]}; }

    std::set<Index> cracks() const {
        std::set<Index> found;
        for (const GraphSegment& s : segments_)
            if (s.crack >= 0) found.insert(s.crack);
        return found;
    }

    Index add_node(const Vec2& x) {
        nodes_.push_back(x);
        is_corner_.push_back(false);
        return n_nodes() - 1;
    }

    /// Rings and borders of regions are where the body and its materials end; only cracks are moved.
    static bool stays(const GraphSegment& s) { return s.ring >= 0 || s.region >= 0; }

    /// What meets at the nodes.
    struct Meeting {
        std::vector<Index> neighbours = {}, along_border = {};
        std::size_t degree() const { return neighbours.size(); }
        bool on_border() const { return !along_border.empty(); }
    };
    std::vector<Meeting> meetings() const {
        std::vector<Meeting> found(nodes_.size());
        for (const GraphSegment& s : segments_)
            for (const auto& [here, there] : {std::pair{s.from, s.to}, {s.to, s.from}}) {
                found[here].neighbours.push_back(there);
                if (stays(s)) found[here].along_border.push_back(there);
            }
        return found;
    }

    /// Corners of borders, points on borders, crossings, bends, ends: of two nodes the one that comes first stays.
    int rank(const std::vector<Meeting>& at, Index n) const {
        return is_corner_[n] ? 0 : at[n].on_border() ? 1 : at[n].degree() > 2 ? 2 : at[n].degree() == 2 ? 3 : 4;
    }
    std::vector<Index> by_rank(const std::vector<Meeting>& at) const {
        std::vector<Index> order;
        for (Index n = 0; n < n_nodes(); ++n)
            if (at[n].degree() > 0) order.push_back(n);
        std::ranges::stable_sort(order, {}, [&](Index n) { return rank(at, n); });
        return order;
    }

    bool merge() {
        const std::vector<Meeting> at = meetings();
        SearchGrid kept(box_, at.size());
        std::vector<Index> target(nodes_.size(), -1);
        bool changed = false;
        for (const Index n : by_rank(at)) {
            const Vec2& x = nodes_[n];
            target[n] = n;
            double nearest = snap_;
            for (const Index other : is_corner_[n] ? std::vector<Index>() : kept.near({x, x}, snap_)) {
                // a point on a border may only move along its side
                if (at[n].on_border() && std::ranges::count(at[n].along_border, other) == 0) continue;
                if (const double distance = (nodes_[other] - x).norm(); distance < nearest)
                    nearest = distance, target[n] = other;
            }
            if (target[n] == n) kept.add({x, x}, n);
            else changed = true;
        }
        if (changed) move_to(target, at);
        return changed;
    }

    void move_to(const std::vector<Index>& target, const std::vector<Meeting>& at) {
        std::vector<bool> left_out(nodes_.size(), false);  // by a piece that is
        std::erase_if(segments_, [&](const GraphSegment& s) {
            if (target[s.from] != target[s.to]) return false;
            if (!stays(s)) {
                ++counts_.n_left_out, counts_.length_left_out += (nodes_[s.to] - nodes_[s.from]).norm();
                left_out[s.from] = left_out[s.to] = true;
            }
            return true;
        });
        for (Index n = 0; n < n_nodes(); ++n)
            if (target[n] >= 0 && target[n] != n && !left_out[n])
                ++(at[n].degree() == 1 ? counts_.n_joined : counts_.n_merged);
        for (GraphSegment& s : segments_) s.from = target[s.from], s.to = target[s.to];
        remove_doubles();
    }

    /// Where two lines have the same nodes, the first stays, or the border; that of a region becomes the crack, too.
    void remove_doubles() {
        std::ranges::stable_partition(segments_, stays);
        std::map<std::pair<Index, Index>, Index> crack_of;  // by the nodes; of lines that stay, the one that joins them
        std::erase_if(segments_, [&](const GraphSegment& s) {
            const auto [first, is_new] = crack_of.try_emplace(std::minmax(s.from, s.to), s.crack);
            if (!is_new && first->second < 0) first->second = s.crack;
            return !is_new;
        });
        for (GraphSegment& s : segments_)
            if (s.region >= 0) s.crack = crack_of.at(std::minmax(s.from, s.to));
    }

    /// Divides segments at nodes, in the order of their positions along the segment.
    void divide(std::map<Index, std::vector<std::pair<double, Index>>>& stops_of) {
        for (auto& [number, stops] : stops_of) {
            std::ranges::sort(stops);
            for (const auto& [position, node] : stops) {
                GraphSegment first = segments_[number];
                if (node == first.from || node == first.to) continue;
                first.to = node, segments_[number].from = node;
                segments_.push_back(first);
            }
        }
        remove_doubles();
    }

    /// In a corner of three nodes that is nearly closed, bending one line after the other through the third node would
    /// never end: the shorter line is left out.
    bool fold() {
        const std::vector<Meeting> at = meetings();
        std::vector<Index> target(nodes_.size());
        std::vector<bool> used(nodes_.size(), false);
        for (Index n = 0; n < n_nodes(); ++n) target[n] = n;
        bool changed = false;
        for (const GraphSegment& s : segments_)
            for (const auto& [end, other] : {std::pair{s.from, s.to}, {s.to, s.from}})
                for (const Index n : at[end].neighbours) {
                    const Vec2 &a = nodes_[other], &b = nodes_[end], &x = nodes_[n];
                    if (n == other || stays(s) || used[n] || used[end] || (x - b).norm() >= 1.5 * snap_) continue;
                    if (const double t = nearest_parameter(a, b, x); !(t > 0 && t < 1)) continue;
                    if (distance_to_segment(a, b, x) >= snap_) continue;
                    const bool end_stays = rank(at, end) <= rank(at, n);
                    const Index moved = end_stays ? n : end;
                    if (at[moved].on_border()) continue;
                    target[moved] = end_stays ? end : n;
                    used[n] = used[end] = changed = true;
                }
        if (changed) move_to(target, at);
        return changed;
    }

    bool bend() {
        std::vector<Meeting> at = meetings();
        SearchGrid places(box_, nodes_.size());
        for (Index n = 0; n < n_nodes(); ++n)
            if (at[n].degree() > 0) places.add({nodes_[n], nodes_[n]}, n);
        std::map<Index, std::vector<std::pair<double, Index>>> stops;
        for (Index i = 0; i < std::ssize(segments_); ++i) {
            const GraphSegment& s = segments_[i];
            const auto [a, b] = line(s);
            for (const Index n : places.near({a, b}, snap_)) {
                const Vec2 x = nodes_[n];
                const double t = nearest_parameter(a, b, x);
                if (n == s.from || n == s.to || !(t > 0 && t < 1) || !(distance_to_segment(a, b, x) < snap_)) continue;
                if (stays(s) && at[n].on_border()) continue;  // a narrow place between borders
                if (stays(s)) nodes_[n] = a + t * (b - a), at[n].along_border = {s.from, s.to};
                if (at[n].degree() == 1) ++counts_.n_joined;
                stops[i].emplace_back(t, n);
            }
        }
        divide(stops);
        return !stops.empty();
    }

    bool cross_over() {
        SearchGrid lines(box_, segments_.size());
        std::map<Index, std::vector<std::pair<double, Index>>> stops;
        for (Index i = 0; i < std::ssize(segments_); ++i) {
            const Segment s = line(segments_[i]);
            for (const Index j : lines.near(s, 0)) {
                const Segment other = line(segments_[j]);
                double t = 0;
                const GraphSegment &p = segments_[i], &q = segments_[j];
                const bool meet = p.from == q.from || p.from == q.to || p.to == q.from || p.to == q.to;
                if (meet || !segments_cross(s, other, t)) continue;
                const Index n = add_node(s.a + t * (s.b - s.a));
                stops[i].emplace_back(t, n);
                stops[j].emplace_back(nearest_parameter(other.a, other.b, nodes_[n]), n);
            }
            lines.add(s, i);
        }
        divide(stops);
        return !stops.empty();
    }

    struct Arm {
        double direction;  // [rad]
        Index segment;
    };

    /// One pair of lines at a time at each node.
    bool part() {
        std::vector<std::vector<Arm>> arms(nodes_.size());
        for (Index i = 0; i < std::ssize(segments_); ++i) {
            const Vec2 ahead = nodes_[segments_[i].to] - nodes_[segments_[i].from];
            arms[segments_[i].from].push_back({std::atan2(ahead.y(), ahead.x()), i});
            arms[segments_[i].to].push_back({std::atan2(-ahead.y(), -ahead.x()), i});
        }
        std::vector<bool> touched(segments_.size(), false);
        bool changed = false;
        for (Index n = 0; n < std::ssize(arms); ++n) {
            std::vector<Arm>& here = arms[n];
            std::ranges::sort(here, {}, &Arm::direction);
            for (std::size_t i = 0; i < here.size() && here.size() > 1; ++i) {
                const Arm &one = here[i], &next = here[(i + 1) % here.size()];
                double angle = next.direction - one.direction;
                if (angle < 0) angle += 2 * std::numbers::pi;
                if (angle >= smallest_angle || touched[one.segment] || touched[next.segment]) continue;
                if (!part_pair(n, one.segment, next.segment, angle)) continue;
                touched[one.segment] = touched[next.segment] = changed = true;
                break;
            }
        }
        std::erase_if(segments_, [](const GraphSegment& s) { return s.from == s.to; });
        remove_doubles();
        return changed;
    }

    bool part_pair(Index n, Index a, Index b, double angle) {
        const auto length = [&](Index s) { return (nodes_[segments_[s].to] - nodes_[segments_[s].from]).norm(); };
        const bool swap = stays(segments_[a]) || (!stays(segments_[b]) && length(b) < length(a));
        const Index moved = swap ? b : a, kept = swap ? a : b;
        if (stays(segments_[moved])) return false;
        const auto end = [&](Index s) { return segments_[s].from == n ? segments_[s].to : segments_[s].from; };
        const double t = std::min({length(moved), length(kept), 2 * snap_ / std::max(std::sin(angle), 1e-12)});
        const auto point = [&](Index s) -> Index {
            if (t > length(s) - snap_) return end(s);
            const Index made = add_node(nodes_[n] + t / length(s) * (nodes_[end(s)] - nodes_[n]));
            GraphSegment far = segments_[s];
            far.from = made, far.to = end(s);
            segments_.push_back(far);
            return made;
        };
        const Index on_kept = point(kept), on_moved = point(moved);
        segments_[kept].from = n, segments_[kept].to = on_kept;
        segments_[moved].from = on_kept, segments_[moved].to = on_moved;
        ++counts_.n_merged;
        return true;
    }

    std::vector<Vec2>& nodes_;
    std::vector<GraphSegment>& segments_;
    std::vector<bool> is_corner_;  // of a border
    Box box_;
    Index n_cracks_;  // of the shape
    double snap_;     // [m]
    SnapCounts counts_;
};

}  // namespace

SnapCounts snap_lines(PlanarGraph& graph, const Shape& shape, const std::vector<Vec2>& corners) {
    return SnappedLines(graph, shape, corners).run();
}

}  // namespace knap
