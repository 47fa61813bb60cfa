#include "geometry/mesh_limits.hpp"

#include "geometry/polygon.hpp"
#include "geometry/size_field.hpp"

#include <cmath>
#include <numbers>
#include <sstream>

namespace knap {

namespace {

constexpr double area_of_unit_triangle = 0.433;  // equilateral, edge 1

std::string number(double value) {
    std::ostringstream out;
    out << value;
    return out.str();
}

std::string place(const Vec2& p) { return "(" + number(p.x()) + ", " + number(p.y()) + ") m"; }

/// The part that is most likely wrong: cracks before regions before holes before the outer ring.
const GraphSegment& likelier(const GraphSegment& a, const GraphSegment& b) {
    const auto rank = [](const GraphSegment& s) { return s.crack >= 0 ? 3 : s.region >= 0 ? 2 : s.ring > 0 ? 1 : 0; };
    return rank(b) > rank(a) ? b : a;
}

void check_lengths(const PlanarGraph& graph, const SizeField& least) {
    for (const GraphSegment& s : graph.segments) {
        const Vec2 a = graph.nodes[s.from], b = graph.nodes[s.to];
        if ((b - a).norm() < least(0.5 * (a + b)))
            throw ShapeError(part_name(s),
                             "has a piece of only " + number((b - a).norm()) + " m at " + place(a) +
                                 ", below a twentieth of the mesh size: drop the detail, move what crosses there, or refine the mesh");
    }
}

void check_gaps(const PlanarGraph& graph, const SizeField& least) {
    std::vector<const GraphSegment*> of_node(graph.nodes.size());
    for (const GraphSegment& s : graph.segments)
        for (const Index n : {s.from, s.to}) of_node[n] = of_node[n] ? &likelier(*of_node[n], s) : &s;
    for (std::size_t n = 0; n < graph.nodes.size(); ++n) {
        const Vec2 p = graph.nodes[n];
        const double limit = least(p);
        for (const GraphSegment& s : graph.segments) {
            if (s.from == static_cast<Index>(n) || s.to == static_cast<Index>(n)) continue;
            const Vec2 a = graph.nodes[s.from], b = graph.nodes[s.to];
            if ((a.cwiseMin(b) - p).maxCoeff() > limit || (p - a.cwiseMax(b)).maxCoeff() > limit) continue;
            const double gap = distance_to_segment(a, b, p);
            if (gap >= limit) continue;
            const GraphSegment &offender = likelier(s, *of_node[n]), &other = &offender == &s ? *of_node[n] : s;
            throw ShapeError(part_name(offender), "comes within " + number(gap) + " m of " + part_name(other) + " at " + place(p) +
                                                      " without touching it: let it end there exactly, or leave at least " + number(limit) +
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
        const Vec2 ahead = graph.nodes[s.to] - graph.nodes[s.from];
        arms[s.from].push_back({std::atan2(ahead.y(), ahead.x()), &s});
        arms[s.to].push_back({std::atan2(-ahead.y(), -ahead.x()), &s});
    }
    constexpr double least = std::numbers::pi / 180;
    for (std::size_t n = 0; n < arms.size(); ++n) {
        std::sort(arms[n].begin(), arms[n].end(), [](const Arm& a, const Arm& b) { return a.direction < b.direction; });
        for (std::size_t i = 0; i < arms[n].size() && arms[n].size() > 1; ++i) {
            const Arm &arm = arms[n][i], &next = arms[n][(i + 1) % arms[n].size()];
            double angle = next.direction - arm.direction;
            if (angle < 0) angle += 2 * std::numbers::pi;
            if (angle < least)
                throw ShapeError(
                    part_name(likelier(*arm.segment, *next.segment)),
                    "has a corner of less than 1 degree at " + place(graph.nodes[n]) + ": make it blunt or let the lines coincide");
        }
    }
}

}  // namespace

double expected_triangles(double area, const MeshOptions& options) {
    double sum = area / (options.size * options.size);
    for (const RefineBox& box : options.refine) {
        // inside the box, and in the seam round it where the size grows: integral of dx / (size + grading x)^2 = 1 / (size grading)
        const Vec2 extent = box.high - box.low;
        sum += std::min(area, extent.x() * extent.y()) / (box.size * box.size);
        sum += std::min(2 * extent.sum(), area / box.size) / (box.size * options.grading);
    }
    return sum / area_of_unit_triangle;
}

void check_sizes(const Shape& shape, double area, const MeshOptions& options) {
    const auto fail = [](const std::string& message) { throw ShapeError("size", message); };
    if (!(options.size > 0) || !std::isfinite(options.size)) fail("the mesh size must be above zero");
    if (!(options.grading > 0 && options.grading <= 1)) fail("the grading must be above 0 and at most 1");
    if (!(options.min_angle >= 0 && options.min_angle <= 30)) fail("the wanted smallest angle must lie between 0 and 30 degree");
    for (const RefineBox& box : options.refine) {
        if (!(box.size > 0) || !std::isfinite(box.size)) fail("the mesh size of a refine box must be above zero");
        if (!((box.high - box.low).minCoeff() >= 0) || !(box.high - box.low).allFinite()) fail("a refine box must have low <= high");
    }
    const Vec2 extent = bounding_box(shape.outer.points).high - bounding_box(shape.outer.points).low;
    if (options.size > extent.maxCoeff() || area_of_unit_triangle * options.size * options.size > area)
        fail("the mesh size " + number(options.size) + " m is larger than the body (" + number(extent.x()) + " m x " + number(extent.y()) +
             " m)");
    const double n = expected_triangles(area, options);
    if (n > most_triangles)
        fail("the mesh would have about " + number(n) + " triangles, more than " + number(most_triangles) + ": choose larger sizes");
}

void check_details(const PlanarGraph& graph, const MeshOptions& options) {
    const SizeField least(options, 0.05);
    check_corners(graph);
    check_lengths(graph, least);
    check_gaps(graph, least);
}

}  // namespace knap
