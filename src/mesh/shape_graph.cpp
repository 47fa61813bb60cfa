#include "mesh/shape_graph.hpp"

#include "mesh/graph_builder.hpp"
#include "mesh/snap_lines.hpp"

#include <algorithm>

namespace knap {
namespace {

/// The last region with a material that covers p, -1 for none.
Index region_at(const std::vector<Region>& regions, const std::vector<Box>& boxes, const Vec2& p) {
    for (Index i = static_cast<Index>(regions.size()) - 1; i >= 0; --i)
        if (!regions[i].only_line && boxes[i].contains(p) && contains(regions[i].points, p)) return i;
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
        if (number[node] < 0) number[node] = static_cast<Index>(kept.size()), kept.push_back(graph.nodes[node]);
        node = number[node];
    };
    for (GraphSegment& s : graph.segments) renumber(s.from), renumber(s.to);
    graph.nodes = std::move(kept);
}

/// Number of points of all lines of a shape.
std::size_t n_points_of(const Shape& shape) {
    std::size_t n = shape.outer.points.size();
    for (const Ring& hole : shape.holes) n += hole.points.size();
    for (const Crack& crack : shape.cracks) n += crack.points.size();
    for (const Region& region : shape.regions) n += region.points.size();
    return n;
}

}  // namespace

PlanarGraph planar_graph(const Shape& shape, double region_tolerance, SnapCounts* counts) {
    PlanarGraph graph;
    const double tolerance = shape.tolerance();
    const Box box = bounding_box(shape.outer.points);
    const std::size_t n_points = n_points_of(shape);
    const bool snaps = shape.snap > tolerance;
    GraphBuilder builder(graph, box, n_points);
    const auto insert_regions = [&] {
        for (Index i = 0; i < std::ssize(shape.regions); ++i)
            builder.insert(sides_of(shape.regions[i].points, true), std::max(tolerance, region_tolerance),
                           {.region = i});
    };
    builder.insert(sides_of(shape.outer.points, true), tolerance, {.ring = 0}, shape.outer.boundary);
    for (Index i = 0; i < std::ssize(shape.holes); ++i)
        builder.insert(sides_of(shape.holes[i].points, true), tolerance, {.ring = i + 1}, shape.holes[i].boundary);
    if (snaps) insert_regions();  // they stay where they are, and the cracks are moved onto them
    const std::vector<Vec2> corners = graph.nodes;
    for (Index i = 0; i < std::ssize(shape.cracks); ++i)
        builder.insert(sides_of(shape.cracks[i].points, false), tolerance, {.crack = i});
    if (!snaps) insert_regions();
    const auto keep_inside = [&] {
        cut_off(graph, shape, tolerance);
        drop_unused_nodes(graph);
    };
    keep_inside();
    if (!snaps) return graph;
    const SnapCounts found = snap_lines(graph, shape, corners);
    if (counts) *counts = found;
    keep_inside();
    return graph;
}

}  // namespace knap
