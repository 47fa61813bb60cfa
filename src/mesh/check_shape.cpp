#include "mesh/check_shape.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

namespace knap {
namespace {

constexpr double area_of_unit_triangle = 0.433;  // equilateral, edge 1

std::string text(double value) {
    std::ostringstream out;
    out << value;
    return out.str();
}

std::string text(const Vec2& p) { return "(" + text(p.x()) + ", " + text(p.y()) + ") m"; }

void check_points(const std::string& part, const std::vector<Vec2>& points, bool closed, double tolerance) {
    const std::size_t needed = closed ? 3 : 2;
    if (points.size() < needed) throw ShapeError(part, "needs at least " + std::to_string(needed) + " points");
    for (const Vec2& p : points)
        if (!p.allFinite()) throw ShapeError(part, "has a point that is not a finite number");
    for (const Segment& side : sides_of(points, closed))
        if (!((side.b - side.a).norm() > tolerance))
            throw ShapeError(part,
                             "has a segment of zero length at " + text(side.b) + ": remove one of its two points");
}

/// A side of one of several polygons.
struct Side {
    Segment line;
    std::size_t polygon, number;
};

void append_sides(const std::vector<Vec2>& points, std::size_t polygon, std::vector<Side>& sides) {
    std::size_t number = 0;
    for (const Segment& line : sides_of(points, true)) sides.push_back({line, polygon, number++});
}

/// Calls found(first, second) for every two sides whose bounding boxes come nearer than `tolerance` (sweep along x).
template <class Found>
void for_near_sides(std::vector<Side> sides, double tolerance, Found found) {
    const auto low = [](const Side& s) { return Vec2(s.line.a.cwiseMin(s.line.b)); };
    const auto high = [](const Side& s) { return Vec2(s.line.a.cwiseMax(s.line.b)); };
    std::stable_sort(sides.begin(), sides.end(), [&](const Side& s, const Side& t) { return low(s).x() < low(t).x(); });
    for (std::size_t i = 0; i < sides.size(); ++i) {
        const Side& s = sides[i];
        for (std::size_t j = i + 1; j < sides.size() && low(sides[j]).x() <= high(s).x() + tolerance; ++j) {
            const Side& t = sides[j];
            if (low(t).y() <= high(s).y() + tolerance && high(t).y() >= low(s).y() - tolerance) found(s, t);
        }
    }
}

/// Two sides of one polygon: neighbours may share their vertex and nothing else, others must not touch.
void check_two_sides(const std::string& part, const Side& s, const Side& t, std::size_t n, double tolerance) {
    const bool s_then_t = (s.number + 1) % n == t.number, t_then_s = (t.number + 1) % n == s.number;
    if (s_then_t || t_then_s) {
        const auto& [a, b] = s_then_t ? s.line : t.line;
        const auto& [c, d] = s_then_t ? t.line : s.line;
        if (distance_to_segment(a, b, d) <= tolerance || distance_to_segment(c, d, a) <= tolerance)
            throw ShapeError(part, "turns back on itself at " + text(c));
    } else if (distance_between(s.line, t.line) <= tolerance) {
        const auto [first, second] = std::minmax({s.number, t.number});
        throw ShapeError(part, "crosses or touches itself near " + text(Vec2(0.5 * (t.line.a + t.line.b))) +
                                   " (sides " + std::to_string(first) + " and " + std::to_string(second) + ")");
    }
}

void check_polygon(const std::string& part, const std::vector<Vec2>& points, double tolerance) {
    check_points(part, points, true, tolerance);
    if (!(std::abs(signed_area(points)) > tolerance * bounding_box(points).diagonal()))
        throw ShapeError(part, "has no area");
    std::vector<Side> sides;
    append_sides(points, 0, sides);
    for_near_sides(sides, tolerance,
                   [&](const Side& s, const Side& t) { check_two_sides(part, s, t, points.size(), tolerance); });
}

/// Ring 0 is the outer one.
std::string ring_name(std::size_t ring) { return part_name(GraphSegment{.ring = static_cast<Index>(ring)}); }

void check_rings(const Shape& shape, double tolerance) {
    std::vector<const Ring*> rings{&shape.outer};
    for (const Ring& hole : shape.holes) rings.push_back(&hole);
    std::vector<Side> sides;
    for (std::size_t r = 0; r < rings.size(); ++r) {
        check_polygon(ring_name(r), rings[r]->points, tolerance);
        if (rings[r]->boundary.size() != rings[r]->points.size())
            throw ShapeError(ring_name(r), "needs one boundary name per side");
        for (const Index b : rings[r]->boundary)
            if (b < 0 || static_cast<std::size_t>(b) >= shape.boundary_names.size())
                throw ShapeError(ring_name(r), "has a side whose boundary has no name");
        append_sides(rings[r]->points, r, sides);
    }
    for_near_sides(sides, tolerance, [&](const Side& s, const Side& t) {
        if (s.polygon == t.polygon || distance_between(s.line, t.line) > tolerance) return;
        const auto [first, second] = std::minmax({s.polygon, t.polygon});
        throw ShapeError(ring_name(second), "crosses or touches " + ring_name(first) + " near " +
                                                text(Vec2(0.5 * (s.line.a + s.line.b))) +
                                                ": make it part of that ring or move it away");
    });
    for (std::size_t r = 1; r < rings.size(); ++r) {
        const Vec2& p = rings[r]->points.front();
        if (!contains(rings[0]->points, p)) throw ShapeError(ring_name(r), "lies outside the outer ring");
        for (std::size_t q = 1; q < rings.size(); ++q)
            if (q != r && contains(rings[q]->points, p)) throw ShapeError(ring_name(r), "lies inside " + ring_name(q));
    }
}

/// The part that is most likely wrong: cracks before regions before holes before the outer ring.
const GraphSegment& likelier(const GraphSegment& a, const GraphSegment& b) {
    const auto rank = [](const GraphSegment& s) { return s.crack >= 0 ? 3 : s.region >= 0 ? 2 : s.ring > 0 ? 1 : 0; };
    return rank(b) > rank(a) ? b : a;
}

void check_lengths(const PlanarGraph& graph, const SizeField& min_length) {
    for (const GraphSegment& s : graph.segments) {
        const auto [a, b] = graph.line(s);
        if ((b - a).norm() < min_length(0.5 * (a + b)))
            throw ShapeError(part_name(s),
                             "has a piece of only " + text((b - a).norm()) + " m at " + text(a) +
                                 ", below a twentieth of the mesh size: drop the detail, move what crosses there, "
                                 "or refine the mesh");
    }
}

void check_gaps(const PlanarGraph& graph, const SizeField& min_gap) {
    std::vector<const GraphSegment*> of_node(graph.nodes.size());
    for (const GraphSegment& s : graph.segments)
        for (const Index n : {s.from, s.to}) of_node[n] = of_node[n] ? &likelier(*of_node[n], s) : &s;
    for (std::size_t n = 0; n < graph.nodes.size(); ++n) {
        const Vec2 p = graph.nodes[n];
        const double limit = min_gap(p);
        for (const GraphSegment& s : graph.segments) {
            if (s.from == static_cast<Index>(n) || s.to == static_cast<Index>(n)) continue;
            const auto [a, b] = graph.line(s);
            if ((a.cwiseMin(b) - p).maxCoeff() > limit || (p - a.cwiseMax(b)).maxCoeff() > limit) continue;
            const double gap = distance_to_segment(a, b, p);
            if (gap >= limit) continue;
            const GraphSegment &offender = likelier(s, *of_node[n]), &other = &offender == &s ? *of_node[n] : s;
            throw ShapeError(part_name(offender),
                             "comes within " + text(gap) + " m of " + part_name(other) + " at " + text(p) +
                                 " without touching it: let it end there exactly, or leave at least " + text(limit) +
                                 " m (a twentieth of the mesh size)");
        }
    }
}

void check_corners(const PlanarGraph& graph) {
    struct Arm {
        double direction;  // [rad]
        const GraphSegment* segment;
    };
    std::vector<std::vector<Arm>> arms(graph.nodes.size());
    for (const GraphSegment& s : graph.segments) {
        const auto [a, b] = graph.line(s);
        const Vec2 ahead = b - a;
        arms[s.from].push_back({std::atan2(ahead.y(), ahead.x()), &s});
        arms[s.to].push_back({std::atan2(-ahead.y(), -ahead.x()), &s});
    }
    constexpr double min_angle = std::numbers::pi / 180;
    for (std::size_t n = 0; n < arms.size(); ++n) {
        std::sort(arms[n].begin(), arms[n].end(), [](const Arm& a, const Arm& b) { return a.direction < b.direction; });
        for (std::size_t i = 0; i < arms[n].size() && arms[n].size() > 1; ++i) {
            const Arm &arm = arms[n][i], &next = arms[n][(i + 1) % arms[n].size()];
            double angle = next.direction - arm.direction;
            if (angle < 0) angle += 2 * std::numbers::pi;
            if (angle < min_angle)
                throw ShapeError(part_name(likelier(*arm.segment, *next.segment)),
                                 "has a corner of less than 1 degree at " + text(graph.nodes[n]) +
                                     ": make it blunt or let the lines coincide");
        }
    }
}

/// About the number of triangles that the mesh would have.
double expected_triangles(double area, const MeshOptions& options) {
    double sum = area / (options.size * options.size);
    for (const RefineBox& box : options.refine) {
        // inside the box, and in the seam around it where the size grows: integral of dx/(size + grading x)^2 = 1/(size
        // grading)
        const Vec2 extent = box.high - box.low;
        sum += std::min(area, extent.x() * extent.y()) / (box.size * box.size);
        sum += std::min(2 * extent.sum(), area / box.size) / (box.size * options.grading);
    }
    return sum / area_of_unit_triangle;
}

}  // namespace

void check_shape(const Shape& shape) {
    check_points("outer", shape.outer.points, true, 0);
    const double tolerance = shape.tolerance();
    check_rings(shape, tolerance);
    for (std::size_t i = 0; i < shape.regions.size(); ++i) {
        const std::string part = part_name(GraphSegment{.region = static_cast<Index>(i)});
        check_polygon(part, shape.regions[i].points, tolerance);
        if (shape.regions[i].tag < 0) throw ShapeError(part, "has a negative tag");
    }
    const auto crack_name = [](std::size_t i) { return part_name(GraphSegment{.crack = static_cast<Index>(i)}); };
    for (std::size_t i = 0; i < shape.cracks.size(); ++i)
        check_points(crack_name(i), shape.cracks[i].points, false, tolerance);
    std::vector<char> inside(shape.cracks.size(), 0);
    for (const GraphSegment& s : planar_graph(shape).segments)
        if (s.crack >= 0) inside[s.crack] = 1;
    for (std::size_t i = 0; i < shape.cracks.size(); ++i)
        if (!inside[i])
            throw ShapeError(
                crack_name(i),
                "has no length inside the body (it lies outside, along the border or along another crack)");
}

void check_sizes(const Shape& shape, const MeshOptions& options) {
    const auto fail = [](const std::string& message) { throw ShapeError("size", message); };
    if (!(options.size > 0) || !std::isfinite(options.size)) fail("the mesh size must be above zero");
    if (!(options.grading > 0 && options.grading <= 1)) fail("the grading must be above 0 and at most 1");
    if (!(options.min_angle >= 0 && options.min_angle <= 30))
        fail("the requested smallest angle must lie between 0 and 30 degree");
    for (const RefineBox& box : options.refine) {
        if (!(box.size > 0) || !std::isfinite(box.size)) fail("the mesh size of a refine box must be above zero");
        if (!((box.high - box.low).minCoeff() >= 0) || !(box.high - box.low).allFinite())
            fail("a refine box must have low <= high");
    }
    const Vec2 extent = bounding_box(shape.outer.points).extent();
    const double area = shape.area();
    if (options.size > extent.maxCoeff() || area_of_unit_triangle * options.size * options.size > area)
        fail("the mesh size " + text(options.size) + " m is larger than the body (" + text(extent.x()) + " m x " +
             text(extent.y()) + " m)");
    const double n = expected_triangles(area, options);
    if (n > max_triangles)
        fail("the mesh would have about " + text(n) + " triangles, more than " + text(max_triangles) +
             ": choose larger sizes");
}

void check_details(const PlanarGraph& graph, const MeshOptions& options) {
    const SizeField twentieth(options, 0.05);
    check_corners(graph);
    check_lengths(graph, twentieth);
    check_gaps(graph, twentieth);
}

}  // namespace knap
