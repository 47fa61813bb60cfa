// Is a shape well formed? Lengths below 1e-6 of the diagonal count as zero (shape_tolerance).
#include "geometry/shape.hpp"

#include "geometry/planar_graph.hpp"
#include "geometry/polygon.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <sstream>

namespace knap {

std::vector<Vec2> circle(const Vec2& centre, double radius, int n) {
    std::vector<Vec2> points;
    for (int i = 0; i < n; ++i) {
        const double angle = 2 * std::numbers::pi * i / n;
        points.push_back(centre + radius * Vec2(std::cos(angle), std::sin(angle)));
    }
    return points;
}

namespace {

std::string text(const Vec2& p) {
    std::ostringstream out;
    out << "(" << p.x() << ", " << p.y() << ") m";
    return out.str();
}

std::string part_name(const char* kind, std::size_t i) { return std::string(kind) + "[" + std::to_string(i) + "]"; }

void check_points(const std::string& part, const std::vector<Vec2>& points, bool closed, double tolerance) {
    const std::size_t needed = closed ? 3 : 2;
    if (points.size() < needed) throw ShapeError(part, "needs at least " + std::to_string(needed) + " points");
    for (const Vec2& p : points)
        if (!p.allFinite()) throw ShapeError(part, "has a point that is not a finite number");
    for (std::size_t i = closed ? 0 : 1; i < points.size(); ++i) {
        const Vec2 &from = points[i == 0 ? points.size() - 1 : i - 1], &to = points[i];
        if (!((to - from).norm() > tolerance))
            throw ShapeError(part, "has a segment of zero length at " + text(to) + ": remove one of its two points");
    }
}

/// A side of a polygon, for the search of sides that touch.
struct Side {
    Vec2 a, b;
    std::size_t polygon;  // index into the list searched
    std::size_t number;
};

/// Calls `found(first, second)` for every two sides whose bounding boxes come nearer than `tolerance` (sweep along x).
template <class Found>
void near_sides(std::vector<Side> sides, double tolerance, Found found) {
    const auto left = [](const Side& s) { return std::min(s.a.x(), s.b.x()); };
    std::stable_sort(sides.begin(), sides.end(), [&](const Side& s, const Side& t) { return left(s) < left(t); });
    for (std::size_t i = 0; i < sides.size(); ++i) {
        const Side& s = sides[i];
        const double right = std::max(s.a.x(), s.b.x()) + tolerance;
        for (std::size_t j = i + 1; j < sides.size() && left(sides[j]) <= right; ++j) {
            const Side& t = sides[j];
            if (std::min(t.a.y(), t.b.y()) > std::max(s.a.y(), s.b.y()) + tolerance) continue;
            if (std::max(t.a.y(), t.b.y()) < std::min(s.a.y(), s.b.y()) - tolerance) continue;
            found(s, t);
        }
    }
}

void append_sides(std::vector<Side>& sides, const std::vector<Vec2>& points, std::size_t polygon) {
    for (std::size_t i = 0; i < points.size(); ++i) sides.push_back({points[i], points[(i + 1) % points.size()], polygon, i});
}

/// Two sides of one polygon: neighbours may share their corner and nothing else, others must not touch.
void check_sides(const std::string& part, const Side& s, const Side& t, std::size_t n, double tolerance) {
    const bool s_then_t = (s.number + 1) % n == t.number, t_then_s = (t.number + 1) % n == s.number;
    const auto folds = [&](const Side& first, const Side& second) {
        return distance_to_segment(first.a, first.b, second.b) <= tolerance ||
               distance_to_segment(second.a, second.b, first.a) <= tolerance;
    };
    if (s_then_t || t_then_s) {
        if (s_then_t ? folds(s, t) : folds(t, s)) throw ShapeError(part, "turns back on itself at " + text(s_then_t ? t.a : s.a));
    } else if (distance_between_segments(s.a, s.b, t.a, t.b) <= tolerance) {
        throw ShapeError(part, "crosses or touches itself near " + text(0.5 * (t.a + t.b)) + " (sides " +
                                   std::to_string(std::min(s.number, t.number)) + " and " + std::to_string(std::max(s.number, t.number)) +
                                   ")");
    }
}

void check_polygon(const std::string& part, const std::vector<Vec2>& points, double tolerance) {
    check_points(part, points, true, tolerance);
    if (!(std::abs(signed_area(points)) > tolerance * bounding_box(points).diagonal())) throw ShapeError(part, "has no area");
    std::vector<Side> sides;
    append_sides(sides, points, 0);
    near_sides(sides, tolerance, [&](const Side& s, const Side& t) { check_sides(part, s, t, points.size(), tolerance); });
}

void check_boundary_tags(const std::string& part, const Ring& ring, std::size_t n_names) {
    if (ring.boundary.size() != ring.points.size()) throw ShapeError(part, "needs one boundary name per side");
    for (const Index b : ring.boundary)
        if (b < 0 || static_cast<std::size_t>(b) >= n_names) throw ShapeError(part, "has a side whose boundary has no name");
}

std::string ring_name(std::size_t ring) { return ring == 0 ? "outer" : part_name("holes", ring - 1); }

/// Ring 0 is the outer one.
void check_rings_apart(const std::vector<const Ring*>& rings, double tolerance) {
    std::vector<Side> sides;
    for (std::size_t r = 0; r < rings.size(); ++r) append_sides(sides, rings[r]->points, r);
    near_sides(sides, tolerance, [&](const Side& s, const Side& t) {
        if (s.polygon == t.polygon || distance_between_segments(s.a, s.b, t.a, t.b) > tolerance) return;
        throw ShapeError(ring_name(std::max(s.polygon, t.polygon)), "crosses or touches " + ring_name(std::min(s.polygon, t.polygon)) +
                                                                        " near " + text(0.5 * (s.a + s.b)) +
                                                                        ": make it part of that ring or move it away");
    });
    for (std::size_t r = 1; r < rings.size(); ++r) {
        const Vec2& p = rings[r]->points.front();
        if (!contains(rings[0]->points, p)) throw ShapeError(ring_name(r), "lies outside the outer ring");
        for (std::size_t q = 1; q < rings.size(); ++q)
            if (q != r && contains(rings[q]->points, p)) throw ShapeError(ring_name(r), "lies inside " + ring_name(q));
    }
}

}  // namespace

double shape_tolerance(const Shape& shape) { return 1e-6 * bounding_box(shape.outer.points).diagonal(); }

void check_shape(const Shape& shape) {
    check_points("outer", shape.outer.points, true, 0);
    const double tolerance = shape_tolerance(shape);
    std::vector<const Ring*> rings{&shape.outer};
    for (const Ring& hole : shape.holes) rings.push_back(&hole);
    for (std::size_t r = 0; r < rings.size(); ++r) {
        check_polygon(ring_name(r), rings[r]->points, tolerance);
        check_boundary_tags(ring_name(r), *rings[r], shape.boundary_names.size());
    }
    check_rings_apart(rings, tolerance);
    for (std::size_t i = 0; i < shape.regions.size(); ++i) {
        check_polygon(part_name("regions", i), shape.regions[i].points, tolerance);
        if (shape.regions[i].tag < 0) throw ShapeError(part_name("regions", i), "has a negative tag");
    }
    for (std::size_t i = 0; i < shape.cracks.size(); ++i) check_points(part_name("cracks", i), shape.cracks[i].points, false, tolerance);
    const PlanarGraph graph = planar_graph(shape);
    for (std::size_t i = 0; i < shape.cracks.size(); ++i) {
        const auto& of_crack = graph.segments;
        if (std::none_of(of_crack.begin(), of_crack.end(), [&](const auto& s) { return s.crack == static_cast<Index>(i); }))
            throw ShapeError(part_name("cracks", i),
                             "has no length inside the body (it lies outside, along the border or along another crack)");
    }
}

}  // namespace knap
