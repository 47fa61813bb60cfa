// The checks that a shape can be meshed with the requested sizes: every mistake is named before anything is meshed.
#include "base/display_unit.hpp"
#include "base/formatted.hpp"
#include "mesh/search_grid.hpp"
#include "mesh/shape_graph.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

namespace knap {
namespace {

constexpr double area_of_unit_triangle = 0.433;  // equilateral, edge 1

/// Faults in the order in which they are found; those of one part and kind are one, with its first places.
class FaultList {
public:
    template <class... Parts>
    void add(const std::string& part, const Parts&... message) {
        found_.push_back({part, concatenated(message...)});
    }
    bool any() const { return !found_.empty(); }
    void throw_if_any() const {
        if (any()) throw ShapeError(found_);
    }
    std::vector<ShapeFault>& all() { return found_; }

private:
    std::vector<ShapeFault> found_;
};

/// Places of one kind of fault on one part.
struct FaultPlaces {
    static constexpr std::size_t n_shown = 4;
    std::vector<Vec2> at = {};  // the first ones
    std::size_t n = 0;
    Vec2 last = {};
    double worst = infinity;  // [m] the smallest length
    double limit = 0;         // [m] there
    std::string other = {};   // the other part there
    bool of_cracks = false;   // a crack has one of these places: snap moves it

    /// True where it is the worst so far. Consecutive equal places are one.
    bool add(const Vec2& x, double length, double allowed) {
        if (n == 0 || x != last) {
            if (++n <= n_shown) at.push_back(x);
            last = x;
        }
        if (!(length < worst)) return false;
        worst = length, limit = allowed;
        return true;
    }
    /// "(1, 2) m, (3, 4) m and 5 more places"
    std::string text() const {
        std::vector<std::string> places;
        for (const Vec2& x : at) places.push_back(place_text(x));
        return joined(places) + (n > at.size() ? concatenated(" and ", n - at.size(), " more places") : "");
    }
};

std::string length_text(double length) { return readable(length, "m"); }

/// "50 mm, a twentieth of the mesh size of 1 m there"
std::string limit_text(double limit) {
    return length_text(limit) + ", a twentieth of the mesh size of " + length_text(20 * limit) + " there";
}

/// What snap would do about cracks, or why it does not help.
std::string snap_text(const FaultPlaces& places, double snap) {
    const double limit = places.limit;
    if (!places.of_cracks) return "";
    if (snap <= 0) return ", or let the shape have snap = \"" + length_text(limit) + "\"";
    if (snap < limit) return "; its snap of " + length_text(snap) + " is below that, which a finer mesh makes smaller";
    return "";
}

/// False, and a fault, for points that no graph can be made of.
bool check_points(const std::string& part, const std::vector<Vec2>& points, bool closed, double tolerance,
                  FaultList& faults) {
    const std::size_t n = faults.all().size(), min_points = closed ? 3 : 2;
    if (points.size() < min_points) {
        faults.add(part, "needs at least ", min_points, " points");
    } else if (!std::ranges::all_of(points, [](const Vec2& p) { return p.allFinite(); })) {
        faults.add(part, "has a point that is not a finite number");
    } else {
        FaultPlaces places;
        for (const Segment& side : sides_of(points, closed))
            if (const double length = (side.b - side.a).norm(); !(length > tolerance)) places.add(side.b, length, 0);
        if (!places.at.empty())
            faults.add(part, "has a segment of zero length at ", places.text(), ": remove one of its two points");
    }
    return faults.all().size() == n;
}

/// A part as messages name it.
std::string part_text(const std::string& part) { return part == "outer" ? "the outline of the body" : part; }

struct Polygon {
    std::string name;
    const std::vector<Vec2>& points;
};

/// Faults unless all polygons are simple, have an area and do not touch each other: one for a polygon or pair.
void check_polygons(const std::vector<Polygon>& polygons, double tolerance, FaultList& faults) {
    struct Side {
        Segment line;
        std::size_t polygon, number;
        Vec2 low, high;  // [m] its box
    };
    std::vector<Side> sides;
    for (std::size_t p = 0; p < polygons.size(); ++p) {
        const auto& [name, points] = polygons[p];
        if (!check_points(name, points, true, tolerance, faults)) continue;
        if (!(std::abs(signed_area(points)) > tolerance * bounding_box(points).diagonal())) {
            faults.add(name, "has no area");
            continue;
        }
        std::size_t number = 0;
        for (const Segment& s : sides_of(points, true))
            sides.push_back({s, p, number++, s.a.cwiseMin(s.b), s.a.cwiseMax(s.b)});
    }
    std::set<std::pair<std::size_t, std::size_t>> reported;
    const auto check = [&](const Side& s, const Side& t) {
        const auto& [name, points] = polygons[s.polygon];
        const auto [first, second] = std::minmax(s.polygon, t.polygon);
        const auto is_new = [&, pair = std::pair(first, second)] { return reported.insert(pair).second; };
        const bool same = s.polygon == t.polygon;
        const bool s_then_t = same && (s.number + 1) % points.size() == t.number;
        const bool t_then_s = same && (t.number + 1) % points.size() == s.number;
        if (s_then_t || t_then_s) {  // neighbours share their vertex and nothing else
            const auto& [a, b] = s_then_t ? s.line : t.line;
            const auto& [c, d] = s_then_t ? t.line : s.line;
            if ((distance_to_segment(a, b, d) <= tolerance || distance_to_segment(c, d, a) <= tolerance) && is_new())
                faults.add(name, "turns back on itself at ", place_text(c));
            return;
        }
        if (distance_between(s.line, t.line) > tolerance || !is_new()) return;
        const std::string near = place_text(0.5 * (t.line.a + t.line.b));
        if (same)
            faults.add(name, "crosses or touches itself near ", near, " (sides ", std::min(s.number, t.number), " and ",
                       std::max(s.number, t.number), ")");
        else
            faults.add(polygons[second].name, "crosses or touches ", part_text(polygons[first].name), " near ", near,
                       first == 0 ? ": draw it as part of the outline, or move it away"
                                  : ": make them one, or move one of them away");
    };
    std::ranges::stable_sort(sides, {}, [](const Side& s) { return s.low.x(); });  // sweep along x
    for (auto s = sides.begin(); s != sides.end(); ++s)
        for (auto t = s + 1; t != sides.end() && t->low.x() <= s->high.x() + tolerance; ++t)
            if (t->low.y() <= s->high.y() + tolerance && t->high.y() >= s->low.y() - tolerance) check(*s, *t);
}

void check_rings(const Shape& shape, double tolerance, FaultList& faults) {
    std::vector<Polygon> rings;
    const auto add = [&](const Ring& ring) {
        const std::string name = GraphSegment{.ring = static_cast<Index>(rings.size())}.part_name();
        rings.push_back({name, ring.points});
        if (ring.boundary.size() != ring.points.size()) faults.add(name, "needs one boundary name per side");
        if (std::ranges::any_of(ring.boundary, [&](Index b) { return b < 0 || b >= std::ssize(shape.boundary_names); }))
            faults.add(name, "has a side whose boundary has no name");
    };
    add(shape.outer);
    for (const Ring& hole : shape.holes) add(hole);
    check_polygons(rings, tolerance, faults);
    faults.throw_if_any();  // in and out need whole rings
    for (std::size_t r = 1; r < rings.size(); ++r) {
        const auto& [name, points] = rings[r];
        if (!contains(rings[0].points, points[0])) faults.add(name, "lies outside the outline of the body");
        for (std::size_t q = 1; q < rings.size(); ++q)
            if (q != r && contains(rings[q].points, points[0])) {
                faults.add(name, "lies inside ", rings[q].name);
                break;
            }
    }
}

/// The segment whose part is more likely wrong: cracks before regions before holes before the outer ring.
const GraphSegment& likelier(const GraphSegment& a, const GraphSegment& b) {
    const auto rank = [](const GraphSegment& s) { return s.crack >= 0 ? 3 : s.region >= 0 ? 2 : s.ring > 0 ? 1 : 0; };
    return rank(b) > rank(a) ? b : a;
}

/// Cracks in their order, then regions, holes and the outer ring.
struct PartOrder {
    std::array<Index, 3> key;
    explicit PartOrder(const GraphSegment& s)
        : key{s.crack < 0, s.crack >= 0 ? s.crack : s.region < 0,
              s.crack >= 0    ? 0
              : s.region >= 0 ? s.region
                              : -s.ring} {}
    auto operator<=>(const PartOrder&) const = default;
};

/// Faults of one kind by the part that has them.
class PlacesOfParts {
public:
    FaultPlaces& of(const GraphSegment& s) {
        auto& [name, places] = parts_[PartOrder(s)];
        if (name.empty()) name = s.part_name();
        return places;
    }
    const auto& all() const { return parts_; }

private:
    std::map<PartOrder, std::pair<std::string, FaultPlaces>> parts_;
};

/// Whether a crack runs through each node.
std::vector<bool> nodes_of_cracks(const PlanarGraph& graph) {
    std::vector<bool> found(graph.nodes.size(), false);
    for (const GraphSegment& s : graph.segments)
        if (s.crack >= 0) found[s.from] = found[s.to] = true;
    return found;
}

void check_lengths(const PlanarGraph& graph, const SizeField& min_length, double snap, FaultList& faults) {
    const std::vector<bool> of_crack = nodes_of_cracks(graph);
    PlacesOfParts parts;
    for (const GraphSegment& s : graph.segments) {
        const auto [a, b] = graph.line(s);
        const double length = (b - a).norm(), limit = min_length(0.5 * (a + b));
        if (!(length < limit)) continue;
        FaultPlaces& places = parts.of(s);
        places.add(a, length, limit);
        places.of_cracks = places.of_cracks || of_crack[s.from] || of_crack[s.to];
    }
    for (const auto& [order, named] : parts.all()) {
        const auto& [part, places] = named;
        faults.add(part, "has a piece of only ", length_text(places.worst), " at ", places.text(), ", below ",
                   limit_text(places.limit), ": drop the detail, move what crosses there, refine the mesh",
                   snap_text(places, snap));
    }
}

void check_gaps(const PlanarGraph& graph, const SizeField& min_gap, double snap, FaultList& faults) {
    if (graph.nodes.empty()) return;
    std::vector<const GraphSegment*> of_node(graph.nodes.size());
    for (const GraphSegment& s : graph.segments)
        for (const Index n : {s.from, s.to}) of_node[n] = of_node[n] ? &likelier(*of_node[n], s) : &s;
    SearchGrid lines(bounding_box(graph.nodes), graph.segments.size());
    for (Index i = 0; i < std::ssize(graph.segments); ++i) lines.add(graph.line(graph.segments[i]), i);
    PlacesOfParts parts;
    for (Index n = 0; n < std::ssize(graph.nodes); ++n) {
        const Vec2 p = graph.nodes[n];
        const double limit = min_gap(p);
        for (const Index i : lines.near({p, p}, limit)) {
            const GraphSegment& s = graph.segments[i];
            if (s.from == n || s.to == n) continue;
            const auto [a, b] = graph.line(s);
            const double gap = distance_to_segment(a, b, p);
            if (gap >= limit * (1 - 1e-9)) continue;  // the demanded distance itself, but for its rounding
            const GraphSegment &offender = likelier(s, *of_node[n]), &other = &offender == &s ? *of_node[n] : s;
            FaultPlaces& places = parts.of(offender);
            places.of_cracks = places.of_cracks || offender.crack >= 0;
            if (places.add(p, gap, limit)) places.other = part_text(other.part_name());
        }
    }
    for (const auto& [order, named] : parts.all()) {
        const auto& [part, places] = named;
        faults.add(part, "comes within ", length_text(places.worst), " of ", places.other, " at ", places.text(),
                   " without touching it: let it end there exactly, or leave at least ", limit_text(places.limit),
                   snap_text(places, snap));
    }
}

void check_corners(const PlanarGraph& graph, FaultList& faults) {
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
    PlacesOfParts parts;
    for (std::size_t n = 0; n < arms.size(); ++n) {
        std::ranges::sort(arms[n], {}, &Arm::direction);
        for (std::size_t i = 0; i < arms[n].size() && arms[n].size() > 1; ++i) {
            const Arm &arm = arms[n][i], &next = arms[n][(i + 1) % arms[n].size()];
            double angle = next.direction - arm.direction;
            if (angle < 0) angle += 2 * std::numbers::pi;
            if (angle < min_angle) parts.of(likelier(*arm.segment, *next.segment)).add(graph.nodes[n], angle, 0);
        }
    }
    for (const auto& [order, named] : parts.all())
        faults.add(named.first, "has a corner of less than 1 degree at ", named.second.text(),
                   ": make it blunt or let the lines coincide");
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

/// Where a crack lies that has no part of its own in the body; the graph is that of all lines.
struct PlaceOfLostCrack {
    bool outside = false, on_border = false;
    std::set<Index> along = {};  // other cracks

    PlaceOfLostCrack(const PlanarGraph& graph, const Crack& crack, double tolerance) {
        for (const Segment& side : sides_of(crack.points, false)) {
            const Vec2 middle = 0.5 * (side.a + side.b);
            const auto line = std::ranges::find_if(graph.segments, [&](const GraphSegment& s) {
                const auto [a, b] = graph.line(s);
                return s.region < 0 && distance_to_segment(a, b, middle) <= 2 * tolerance;
            });
            if (line == graph.segments.end()) outside = true;
            else if (line->crack >= 0) along.insert(line->crack);
            else on_border = true;
        }
    }
    std::string text() const {
        std::vector<std::string> places;
        for (const Index i : along) places.push_back("along " + GraphSegment{.crack = i}.part_name());
        if (on_border) places.push_back("along the border of the body");
        if (outside) places.push_back("outside the body");
        return joined(places);
    }
};

/// Cracks with no part inside the body; the graph is that of `drawn`, before anything was left out. Where cracks are
/// snapped, only those outside: a line that was drawn twice is left out and counted, as a shorter piece is.
void check_cracks(const Shape& shape, const Shape& drawn, const PlanarGraph& graph, FaultList& faults) {
    std::vector<bool> inside(shape.cracks.size(), false);
    for (const GraphSegment& s : graph.segments)
        if (s.crack >= 0) inside[s.crack] = true;
    for (Index i = 0; i < std::ssize(shape.cracks); ++i) {
        if (inside[i] || drawn.cracks[i].points.empty()) continue;
        const PlaceOfLostCrack place(graph, drawn.cracks[i], shape.tolerance());
        if (shape.snap > 0 && !place.outside) continue;
        faults.add(
            GraphSegment{.crack = i}.part_name(), "has no length of its own inside the body: it lies ", place.text(),
            place.outside || shape.snap > 0 ? "" : ": remove it, or let the shape have snap, which leaves it out");
    }
}

/// The shape without lines that are none, so that faults of the others are found, too. With snap repeated points are
/// pieces that are left out. Throws ShapeError where no graph can be made.
Shape checked_drawing(const Shape& shape, FaultList& faults) {
    check_points("outer", shape.outer.points, true, 0, faults);
    faults.throw_if_any();
    const double tolerance = shape.tolerance();
    check_rings(shape, tolerance, faults);
    for (Index i = 0; i < std::ssize(shape.regions); ++i) {
        const std::string part = GraphSegment{.region = i}.part_name();
        check_polygons({{part, shape.regions[i].points}}, tolerance, faults);
        if (shape.regions[i].tag < 0) faults.add(part, "has a negative tag");
    }
    faults.throw_if_any();
    Shape drawn = shape;
    for (Index i = 0; i < std::ssize(drawn.cracks); ++i) {
        std::vector<Vec2>& points = drawn.cracks[i].points;
        const auto merge_repeated = [&] {
            const auto repeats = [&](const Vec2& a, const Vec2& b) { return (b - a).norm() <= tolerance; };
            points.erase(std::unique(points.begin(), points.end(), repeats), points.end());
        };
        const bool had_length = points.size() > 1;
        if (shape.snap > 0) merge_repeated();
        if (shape.snap > 0 && had_length && points.size() == 1) points.clear();  // left out and counted
        else if (!check_points(GraphSegment{.crack = i}.part_name(), points, false, tolerance, faults))
            merge_repeated();
        if (points.size() < 2) points.clear();
    }
    return drawn;
}

}  // namespace

void check_shape(const Shape& shape) {
    FaultList faults;
    Shape drawn = checked_drawing(shape, faults);
    drawn.snap = 0;
    check_cracks(shape, drawn, planar_graph(drawn), faults);
    faults.throw_if_any();
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

std::vector<ShapeFault> faults_of_details(const PlanarGraph& graph, const MeshOptions& options, double snap) {
    const SizeField twentieth(options, 0.05);
    FaultList faults;
    check_corners(graph, faults);
    check_lengths(graph, twentieth, snap, faults);
    check_gaps(graph, twentieth, snap, faults);
    return std::move(faults.all());
}

PlanarGraph checked_graph(const Shape& shape, const MeshOptions& options, double region_tolerance) {
    FaultList faults;
    Shape drawn = checked_drawing(shape, faults);
    check_sizes(shape, options);
    PlanarGraph graph = planar_graph(drawn, region_tolerance);
    drawn.snap = 0;
    check_cracks(shape, drawn, shape.regions.empty() && shape.snap == 0 ? graph : planar_graph(drawn), faults);
    for (ShapeFault& fault : faults_of_details(graph, options, shape.snap)) faults.all().push_back(std::move(fault));
    faults.throw_if_any();
    return graph;
}

}  // namespace knap
