#include "microstructure/inclusions.hpp"

#include "base/random.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace knap {
namespace {

constexpr double pi = std::numbers::pi;

Vec2 direction_of(double angle) { return {std::cos(angle), std::sin(angle)}; }

// --- inclusions

/// Diameters whose circles have the requested area, or as many as are requested; largest first.
std::vector<double> diameters(const InclusionOptions& options, double area, Random& random) {
    std::vector<double> found;
    for (double missing = area; options.number > 0 ? std::ssize(found) < options.number : missing > 0;) {
        const double d = options.size * random.lognormal(options.spread), own = 0.25 * pi * d * d;
        if (options.number == 0 && own > 2 * missing) break;
        found.push_back(d);
        missing -= own;
    }
    std::ranges::sort(found, std::greater());
    return found;
}

/// Counterclockwise, without points on its sides (A. M. Andrew 1979).
std::vector<Vec2> convex_hull(std::vector<Vec2> points) {
    std::ranges::sort(points, {}, [](const Vec2& p) { return std::pair(p.x(), p.y()); });
    std::vector<Vec2> hull;
    for (int half = 0; half < 2; ++half) {
        const std::size_t first = hull.size();
        for (const Vec2& p : points) {
            while (hull.size() >= first + 2 && cross(hull.back() - hull[hull.size() - 2], p - hull.back()) <= 0)
                hull.pop_back();
            hull.push_back(p);
        }
        hull.pop_back();  // the first point of the other half
        std::ranges::reverse(points);
    }
    return hull;
}

/// The outline of one inclusion of area pi d^2/4 around the origin; of a disc (ellipse) a polygon with sides of the
/// local mesh size.
class Form {
public:
    Form(const InclusionOptions& options, double diameter, Random& random)
        : options_(options), diameter_(diameter), turn_(random.uniform(0, 2 * pi)) {
        for (int i = 0; i < options.corners; ++i) {
            const double shift = random.uniform(-0.3, 0.3), radius = random.uniform(0.85, 1.15);
            outline_.push_back(radius * direction_of(turn_ + 2 * pi * (i + shift) / options.corners));
        }
        if (options.convex && options.corners > 0) outline_ = convex_hull(std::move(outline_));
        along_ = direction_of(options.direction ? *options.direction : random.uniform(0, pi));
        if (options.corners > 0) scale();
    }

    /// `side` [m] of a disc.
    const std::vector<Vec2>& outline(double side) {
        const int n = std::max(8, static_cast<int>(std::lround(pi * diameter_ / side)));
        if (options_.corners > 0 || n == std::ssize(outline_)) return outline_;
        outline_.clear();
        for (int i = 0; i < n; ++i) outline_.push_back(direction_of(turn_ + 2 * pi * i / n));
        scale();
        return outline_;
    }

private:
    void scale() {
        const Vec2 across = turned_left(along_);
        for (Vec2& p : outline_) p = along_.dot(p) * options_.elongation * along_ + across.dot(p) * across;
        const double scale = std::sqrt(0.25 * pi * diameter_ * diameter_ / std::abs(signed_area(outline_)));
        for (Vec2& p : outline_) p *= scale;
    }

    const InclusionOptions& options_;
    double diameter_, turn_;
    Vec2 along_;
    std::vector<Vec2> outline_;
};

/// A line or a polygon from which an inclusion must keep its distance.
struct Obstacle {
    std::vector<Vec2> points;
    bool closed;
    std::vector<Segment> sides;
    Vec2 centre;    // [m] of a circle around it
    double radius;  // [m]

    Obstacle(std::vector<Vec2> line, bool is_closed)
        : points(std::move(line)), closed(is_closed), sides(sides_of(points, closed)) {
        const Box box = bounding_box(points);
        centre = box.middle();
        radius = 0.5 * box.diagonal();
    }

    bool is_nearer_than(double distance, const Obstacle& other) const {
        if ((centre - other.centre).norm() > radius + other.radius + distance) return false;
        for (const Segment& s : sides)
            for (const Segment& t : other.sides)
                if (distance_between(s, t) < distance) return true;
        return (other.closed && contains(other.points, points[0])) || (closed && contains(points, other.points[0]));
    }
};

/// Sides of long lines one by one, so that the circle around each is small.
std::vector<Obstacle> obstacles_of(const Shape& shape) {
    std::vector<Obstacle> obstacles;
    const auto add = [&](const std::vector<Vec2>& points, bool closed) {
        for (const Segment& side : sides_of(points, closed)) obstacles.emplace_back(std::vector{side.a, side.b}, false);
    };
    add(shape.outer.points, true);
    for (const Ring& hole : shape.holes) obstacles.emplace_back(hole.points, true);
    for (const Region& region : shape.regions) add(region.points, true);
    for (const Crack& crack : shape.cracks) add(crack.points, false);
    return obstacles;
}

// --- joints

/// Lines of a shape and their crossings.
class Drawing {
public:
    /// The lines of a shape, with the crossings of its cracks.
    explicit Drawing(const Shape& shape) {
        append(sides_of(shape.outer.points, true));
        for (const Ring& hole : shape.holes) append(sides_of(hole.points, true));
        for (const Region& region : shape.regions) append(sides_of(region.points, true));
        for (const Crack& crack : shape.cracks) {
            const std::vector<Segment> sides = sides_of(crack.points, false);
            for (const Segment& side : sides)
                for (const Segment& line : lines_) are_compatible(side, line, 0, crossings_);
            append(sides);
        }
    }

    /// Adds the sides of a trace unless they come nearer than `nearest` [m] to a crossing or are incompatible with a
    /// line.
    bool add(const std::vector<Segment>& sides, double nearest) {
        std::vector<Vec2> crossings;
        for (const Segment& side : sides) {
            for (const Segment& line : lines_)
                if (!are_compatible(side, line, nearest, crossings)) return false;
            for (const Vec2& x : crossings_)
                if (distance_to_segment(side.a, side.b, x) < nearest) return false;
        }
        append(sides);
        crossings_.insert(crossings_.end(), crossings.begin(), crossings.end());
        return true;
    }

private:
    /// They cross at 15 degree or more and far from their ends, and the crossing is appended to `crossings`; or they
    /// keep their distance.
    static bool are_compatible(const Segment& s, const Segment& t, double nearest, std::vector<Vec2>& crossings) {
        static const double min_sine = std::sin(15 * pi / 180);
        double position;
        if (!segments_cross(s, t, position)) return distance_between(s, t) >= nearest;
        const Vec2 crossing = s.a + position * (s.b - s.a);
        for (const Vec2& end : {s.a, s.b, t.a, t.b})
            if ((end - crossing).norm() < nearest) return false;
        crossings.push_back(crossing);
        return std::abs(cross((s.b - s.a).normalized(), (t.b - t.a).normalized())) >= min_sine;
    }

    void append(const std::vector<Segment>& sides) { lines_.insert(lines_.end(), sides.begin(), sides.end()); }

    std::vector<Segment> lines_;
    std::vector<Vec2> crossings_;
};

/// A trace of no width, or the four sides of a vein.
std::vector<Vec2> outline(const Segment& trace, double thickness) {
    if (thickness == 0) return {trace.a, trace.b};
    const Vec2 half = 0.5 * thickness * turned_left((trace.b - trace.a).normalized());
    return {trace.a - half, trace.b - half, trace.b + half, trace.a + half};
}

/// Some of it lies in the body: a few places along it are tried.
bool reaches_body(const Shape& shape, const Box& box, const Segment& trace) {
    const Vec2 low = trace.a.cwiseMin(trace.b), high = trace.a.cwiseMax(trace.b);
    if ((low.array() > box.high.array()).any() || (high.array() < box.low.array()).any()) return false;
    constexpr int n = 64;
    for (int i = 0; i < n; ++i)
        if (shape.contains(trace.a + (i + 0.5) / n * (trace.b - trace.a))) return true;
    return false;
}

}  // namespace

PlacedInclusions place_inclusions(Shape& shape, const InclusionOptions& options, std::uint64_t seed,
                                  const std::string& part) {
    constexpr int max_trials = 5000;  // of one inclusion
    Random random(seed, part);
    const Shape body = shape;
    const double area = body.area();
    const Box box = bounding_box(body.outer.points);
    const SizeField size(options.mesh, 1);
    std::vector<Obstacle> obstacles = obstacles_of(body);
    PlacedInclusions placed;
    for (const double diameter : diameters(options, options.fraction * area, random)) {
        Form form(options, diameter, random);
        bool done = false;
        for (int trial = 0; trial < max_trials && !done; ++trial) {
            const Vec2 centre(random.uniform(box.low.x(), box.high.x()), random.uniform(box.low.y(), box.high.y()));
            if (!body.contains(centre)) continue;
            std::vector<Vec2> points = form.outline(size(centre));
            for (Vec2& p : points) p += centre;
            const Obstacle candidate(points, true);
            if (std::ranges::any_of(obstacles, [&](const Obstacle& other) {
                    return candidate.is_nearer_than(options.distance, other);
                }))
                continue;
            done = true;
            ++placed.n;
            placed.fraction += std::abs(signed_area(points)) / area;
            if (options.tag) shape.regions.push_back({points, *options.tag});
            else shape.holes.push_back({points, std::vector<Index>(points.size(), options.boundary)});
            obstacles.push_back(candidate);
        }
        if (!done)
            throw ShapeError(
                part, "finds no room: ", placed.n, ", which fill ", 100 * placed.fraction,
                " % of the area, are placed, ",
                options.number > 0 ? concatenated(options.number) : concatenated(100 * options.fraction, " %"),
                " are requested");
    }
    return placed;
}

int place_joints(Shape& shape, const JointOptions& options, std::uint64_t seed, const std::string& part) {
    constexpr int max_trials = 20;
    constexpr double max_traces = 1e6;  // including those outside the body
    Random random(seed, part);
    const Shape body = shape;
    const Box box = bounding_box(shape.outer.points);
    const Vec2 middle = box.middle();
    const double reach = 0.6 * box.diagonal();  // every row crosses the body
    const bool end_to_end = options.persistence >= 1;
    const double bridge = end_to_end ? 0 : options.length * (1 - options.persistence) / options.persistence;
    const double n_rows = 2 * reach / options.spacing;
    const double n_traces = n_rows * (end_to_end ? 1 : 2 * reach / (options.length + bridge));
    if (!(n_traces <= max_traces))
        throw ShapeError(part, "requires some ", n_traces, " traces across a body of ", box.diagonal(), " m; at most ",
                         max_traces, " are placed");
    Drawing drawing(shape);
    int n_left_out = 0;
    // a trace from `from` to `to` along the row at `offset` across, turned by the scatter of the direction
    const auto place = [&](double offset, double from, double to) {
        for (int trial = 0; trial < max_trials; ++trial) {
            const double shifted = offset + (trial == 0 ? 0 : random.uniform(-0.3, 0.3) * options.spacing);
            const Vec2 row = direction_of(options.direction);
            const Vec2 along = direction_of(options.direction + options.spread * random.normal());
            const Vec2 centre = middle + shifted * turned_left(row) + 0.5 * (from + to) * row;
            const Segment trace{centre - 0.5 * (to - from) * along, centre + 0.5 * (to - from) * along};
            if (!reaches_body(body, box, trace)) return;
            const std::vector<Vec2> points = outline(trace, options.thickness);
            if (!drawing.add(sides_of(points, points.size() > 2), options.nearest)) continue;
            if (options.tag) shape.regions.push_back({points, *options.tag});
            else shape.cracks.push_back({points, options.joint});
            return;
        }
        ++n_left_out;
    };
    for (double offset = -reach + random.uniform() * options.spacing; offset < reach;
         offset += options.spacing * random.uniform(0.5, 1.5)) {
        if (end_to_end) {
            place(offset, -2 * reach, 2 * reach);
            continue;
        }
        for (double at = -reach - random.uniform() * (options.length + bridge); at < reach;) {
            const double length = options.length * random.uniform(0.5, 1.5);
            place(offset, at, at + length);
            at += length + bridge * random.uniform(0.5, 1.5);
        }
    }
    return n_left_out;
}

}  // namespace knap
