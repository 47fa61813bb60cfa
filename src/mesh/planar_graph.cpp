#include "mesh/planar_graph.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace knap {
namespace {

/// Inserts one straight piece after the other; earlier pieces keep their place, later ones are bent onto them.
class GraphBuilder {
public:
    explicit GraphBuilder(PlanarGraph& graph) : graph_(graph) {}

    /// Points of the pieces that are nearer than the tolerance to earlier nodes and segments are moved onto these.
    void insert(const std::vector<Segment>& pieces, double tolerance, GraphSegment labels,
                const std::vector<Index>& boundaries = {}) {
        tolerance_ = tolerance;
        for (std::size_t i = 0; i < pieces.size(); ++i) {
            if (!boundaries.empty()) labels.boundary = boundaries[i];
            const Index from = node_at(pieces[i].a), to = node_at(pieces[i].b);
            connect_through(from, to, labels, 0);
        }
    }

private:
    /// Connects two nodes through all nodes between them; a piece that was bent onto one may then come across others.
    void connect_through(Index from, Index to, const GraphSegment& labels, int n_bends) {
        if (from == to) return;
        const Vec2 p = graph_.nodes[from], q = graph_.nodes[to];
        split_crossed(p, q);
        const Vec2 low = p.cwiseMin(q).array() - tolerance_, high = p.cwiseMax(q).array() + tolerance_;
        std::vector<std::pair<double, Index>> stops{{0.0, from}};  // position on the piece, 0..1, and node
        for (Index n = 0; n < n_nodes(); ++n) {
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

    Index n_nodes() const { return static_cast<Index>(graph_.nodes.size()); }

    Index add_node(const Vec2& p) {
        graph_.nodes.push_back(p);
        return n_nodes() - 1;
    }

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
        return add_node(p);
    }

    Index split(std::size_t s, const Vec2& p) {
        GraphSegment second = graph_.segments[s];
        graph_.segments[s].to = second.from = add_node(p);
        graph_.segments.push_back(second);
        return second.from;
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

    void connect(Index from, Index to, GraphSegment labels) {
        if (from == to) return;
        for (GraphSegment& old : graph_.segments) {
            if (std::minmax(old.from, old.to) != std::minmax(from, to)) continue;
            if (old.crack < 0) old.crack = labels.crack;
            old.region = std::max(old.region, labels.region);
            return;
        }
        labels.from = from, labels.to = to;
        graph_.segments.push_back(labels);
    }

    PlanarGraph& graph_;
    double tolerance_ = 0;  // [m]
};

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

// --- checks

constexpr double area_of_unit_triangle = 0.433;  // equilateral, edge 1

std::string place(const Vec2& p) { return concatenated("(", p.x(), ", ", p.y(), ") m"); }

void check_points(const std::string& part, const std::vector<Vec2>& points, bool closed, double tolerance) {
    const std::size_t min_points = closed ? 3 : 2;
    if (points.size() < min_points) throw ShapeError(part, "needs at least ", min_points, " points");
    for (const Vec2& p : points)
        if (!p.allFinite()) throw ShapeError(part, "has a point that is not a finite number");
    for (const Segment& side : sides_of(points, closed))
        if (!((side.b - side.a).norm() > tolerance))
            throw ShapeError(part, "has a segment of zero length at ", place(side.b), ": remove one of its two points");
}

/// A part as messages name it.
std::string part_text(const std::string& part) { return part == "outer" ? "the outline of the body" : part; }

struct Polygon {
    std::string name;
    const std::vector<Vec2>& points;
};

/// Throws unless all polygons are simple, have an area and do not touch each other.
void check_polygons(const std::vector<Polygon>& polygons, double tolerance) {
    struct Side {
        Segment line;
        std::size_t polygon, number;
        Vec2 low, high;  // [m] its box
    };
    std::vector<Side> sides;
    for (std::size_t p = 0; p < polygons.size(); ++p) {
        const auto& [name, points] = polygons[p];
        check_points(name, points, true, tolerance);
        if (!(std::abs(signed_area(points)) > tolerance * bounding_box(points).diagonal()))
            throw ShapeError(name, "has no area");
        std::size_t number = 0;
        for (const Segment& s : sides_of(points, true))
            sides.push_back({s, p, number++, s.a.cwiseMin(s.b), s.a.cwiseMax(s.b)});
    }
    const auto check = [&](const Side& s, const Side& t) {
        const auto& [name, points] = polygons[s.polygon];
        const bool same = s.polygon == t.polygon;
        const bool s_then_t = same && (s.number + 1) % points.size() == t.number;
        const bool t_then_s = same && (t.number + 1) % points.size() == s.number;
        if (s_then_t || t_then_s) {  // neighbours share their vertex and nothing else
            const auto& [a, b] = s_then_t ? s.line : t.line;
            const auto& [c, d] = s_then_t ? t.line : s.line;
            if (distance_to_segment(a, b, d) <= tolerance || distance_to_segment(c, d, a) <= tolerance)
                throw ShapeError(name, "turns back on itself at ", place(c));
            return;
        }
        if (distance_between(s.line, t.line) > tolerance) return;
        const std::string near = place(0.5 * (t.line.a + t.line.b));
        if (same)
            throw ShapeError(name, "crosses or touches itself near ", near, " (sides ", std::min(s.number, t.number),
                             " and ", std::max(s.number, t.number), ")");
        const auto [first, second] = std::minmax({s.polygon, t.polygon});
        throw ShapeError(polygons[second].name, "crosses or touches ", part_text(polygons[first].name), " near ", near,
                         first == 0 ? ": draw it as part of the outline, or move it away"
                                    : ": make them one, or move one of them away");
    };
    std::ranges::stable_sort(sides, {}, [](const Side& s) { return s.low.x(); });  // sweep along x
    for (auto s = sides.begin(); s != sides.end(); ++s)
        for (auto t = s + 1; t != sides.end() && t->low.x() <= s->high.x() + tolerance; ++t)
            if (t->low.y() <= s->high.y() + tolerance && t->high.y() >= s->low.y() - tolerance) check(*s, *t);
}

void check_rings(const Shape& shape, double tolerance) {
    std::vector<Polygon> rings;
    const auto add = [&](const Ring& ring) {
        const std::string name = GraphSegment{.ring = static_cast<Index>(rings.size())}.part_name();
        rings.push_back({name, ring.points});
        if (ring.boundary.size() != ring.points.size()) throw ShapeError(name, "needs one boundary name per side");
        for (const Index b : ring.boundary)
            if (b < 0 || b >= std::ssize(shape.boundary_names))
                throw ShapeError(name, "has a side whose boundary has no name");
    };
    add(shape.outer);
    for (const Ring& hole : shape.holes) add(hole);
    check_polygons(rings, tolerance);
    for (std::size_t r = 1; r < rings.size(); ++r) {
        const auto& [name, points] = rings[r];
        if (!contains(rings[0].points, points[0])) throw ShapeError(name, "lies outside the outline of the body");
        for (std::size_t q = 1; q < rings.size(); ++q)
            if (q != r && contains(rings[q].points, points[0])) throw ShapeError(name, "lies inside ", rings[q].name);
    }
}

/// The segment whose part is more likely wrong: cracks before regions before holes before the outer ring.
const GraphSegment& likelier(const GraphSegment& a, const GraphSegment& b) {
    const auto rank = [](const GraphSegment& s) { return s.crack >= 0 ? 3 : s.region >= 0 ? 2 : s.ring > 0 ? 1 : 0; };
    return rank(b) > rank(a) ? b : a;
}

void check_lengths(const PlanarGraph& graph, const SizeField& min_length) {
    for (const GraphSegment& s : graph.segments) {
        const auto [a, b] = graph.line(s);
        if ((b - a).norm() < min_length(0.5 * (a + b)))
            throw ShapeError(s.part_name(), "has a piece of only ", (b - a).norm(), " m at ", place(a),
                             ", below a twentieth of the mesh size: drop the detail, move what crosses there, "
                             "or refine the mesh");
    }
}

void check_gaps(const PlanarGraph& graph, const SizeField& min_gap) {
    std::vector<const GraphSegment*> of_node(graph.nodes.size());
    for (const GraphSegment& s : graph.segments)
        for (const Index n : {s.from, s.to}) of_node[n] = of_node[n] ? &likelier(*of_node[n], s) : &s;
    for (Index n = 0; n < std::ssize(graph.nodes); ++n) {
        const Vec2 p = graph.nodes[n];
        const double limit = min_gap(p);
        for (const GraphSegment& s : graph.segments) {
            if (s.from == n || s.to == n) continue;
            const auto [a, b] = graph.line(s);
            if ((a.cwiseMin(b) - p).maxCoeff() > limit || (p - a.cwiseMax(b)).maxCoeff() > limit) continue;
            const double gap = distance_to_segment(a, b, p);
            if (gap >= limit) continue;
            const GraphSegment &offender = likelier(s, *of_node[n]), &other = &offender == &s ? *of_node[n] : s;
            throw ShapeError(offender.part_name(), "comes within ", gap, " m of ", part_text(other.part_name()), " at ",
                             place(p), " without touching it: let it end there exactly, or leave at least ", limit,
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
        std::ranges::sort(arms[n], {}, &Arm::direction);
        for (std::size_t i = 0; i < arms[n].size() && arms[n].size() > 1; ++i) {
            const Arm &arm = arms[n][i], &next = arms[n][(i + 1) % arms[n].size()];
            double angle = next.direction - arm.direction;
            if (angle < 0) angle += 2 * std::numbers::pi;
            if (angle < min_angle)
                throw ShapeError(likelier(*arm.segment, *next.segment).part_name(),
                                 "has a corner of less than 1 degree at ", place(graph.nodes[n]),
                                 ": make it blunt or let the lines coincide");
        }
    }
}

/// About the number of triangles that the mesh would have.
double expected_triangles(double area, const MeshOptions& options) {
    double sum = area / (options.size * options.size);
    for (const RefinedPlace& place : options.refine) {
        // inside the place, and in the seam around it where the size grows:
        // integral of dx/(size + grading x)^2 = 1/(size grading)
        sum += std::min(area, place.area()) / (place.size * place.size);
        sum += std::min(place.perimeter(), area / place.size) / (place.size * options.grading);
    }
    return sum / area_of_unit_triangle;
}

}  // namespace

PlanarGraph planar_graph(const Shape& shape, double region_tolerance) {
    PlanarGraph graph;
    const double tolerance = shape.tolerance();
    GraphBuilder builder(graph);
    builder.insert(sides_of(shape.outer.points, true), tolerance, {.ring = 0}, shape.outer.boundary);
    for (Index i = 0; i < std::ssize(shape.holes); ++i)
        builder.insert(sides_of(shape.holes[i].points, true), tolerance, {.ring = i + 1}, shape.holes[i].boundary);
    for (Index i = 0; i < std::ssize(shape.cracks); ++i)
        builder.insert(sides_of(shape.cracks[i].points, false), tolerance, {.crack = i});
    for (Index i = 0; i < std::ssize(shape.regions); ++i)
        builder.insert(sides_of(shape.regions[i].points, true), std::max(tolerance, region_tolerance), {.region = i});
    cut_off(graph, shape, tolerance);
    drop_unused_nodes(graph);
    return graph;
}

std::string GraphSegment::part_name() const {
    if (crack >= 0) return concatenated("cracks[", crack, "]");
    if (region >= 0) return concatenated("regions[", region, "]");
    return ring > 0 ? concatenated("holes[", ring - 1, "]") : "outer";
}

void check_shape(const Shape& shape) {
    check_points("outer", shape.outer.points, true, 0);
    const double tolerance = shape.tolerance();
    check_rings(shape, tolerance);
    for (Index i = 0; i < std::ssize(shape.regions); ++i) {
        const std::string part = GraphSegment{.region = i}.part_name();
        check_polygons({{part, shape.regions[i].points}}, tolerance);
        if (shape.regions[i].tag < 0) throw ShapeError(part, "has a negative tag");
    }
    const auto crack_name = [](std::size_t i) { return GraphSegment{.crack = static_cast<Index>(i)}.part_name(); };
    for (std::size_t i = 0; i < shape.cracks.size(); ++i)
        check_points(crack_name(i), shape.cracks[i].points, false, tolerance);
    std::vector<bool> inside(shape.cracks.size(), false);
    for (const GraphSegment& s : planar_graph(shape).segments)
        if (s.crack >= 0) inside[s.crack] = true;
    for (std::size_t i = 0; i < shape.cracks.size(); ++i)
        if (!inside[i])
            throw ShapeError(crack_name(i),
                             "has no length inside the body (it lies outside, along the border or along "
                             "another crack)");
}

void check_sizes(const Shape& shape, const MeshOptions& options) {
    const auto check = [](bool holds, const auto&... message) {
        if (!holds) throw ShapeError("size", message...);
    };
    check(options.size > 0 && std::isfinite(options.size), "the mesh size must be above zero");
    check(options.grading > 0 && options.grading <= 1, "the grading must be above 0 and at most 1");
    check(options.min_angle >= 0 && options.min_angle <= 30,
          "the requested smallest angle must lie between 0 and 30 degree");
    for (const RefinedPlace& place : options.refine) {
        const Vec2 extent = place.box.extent();
        check(place.size > 0 && std::isfinite(place.size), "the mesh size of a refined place must be above zero");
        check(extent.minCoeff() >= 0 && extent.allFinite(), "a refined box must have low <= high");
    }
    const Vec2 extent = bounding_box(shape.outer.points).extent();
    const double area = shape.area();
    check(options.size <= extent.maxCoeff() && area_of_unit_triangle * options.size * options.size <= area,
          "the mesh size ", options.size, " m is larger than the body (", extent.x(), " m x ", extent.y(), " m)");
    const double n = expected_triangles(area, options);
    check(n <= max_triangles, "the mesh would have about ", n, " triangles, more than ", max_triangles,
          ": choose larger sizes");
}

void check_details(const PlanarGraph& graph, const MeshOptions& options) {
    const SizeField twentieth(options, 0.05);
    check_corners(graph);
    check_lengths(graph, twentieth);
    check_gaps(graph, twentieth);
}

}  // namespace knap
