#include "microstructure/inclusions.hpp"

#include "base/random.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace knap {
namespace {

constexpr int max_trials = 20;
constexpr double max_traces = 1e6;  // including those outside the body
const double min_sine = std::sin(15 * std::numbers::pi / 180);

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
    /// They cross far from their ends and not too obliquely, and the crossing is appended to `crossings`; or they keep
    /// their distance.
    static bool are_compatible(const Segment& s, const Segment& t, double nearest, std::vector<Vec2>& crossings) {
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

int place_joints(Shape& shape, const JointOptions& options, std::uint64_t seed, const std::string& part) {
    Random random(seed, part);
    const Shape body = shape;
    const Box box = bounding_box(shape.outer.points);
    const Vec2 middle = box.middle();
    const double reach = 0.6 * box.diagonal();  // every row crosses the body
    const double bridge =
        options.persistence < 1 ? options.length * (1 - options.persistence) / options.persistence : 0;
    const double n_rows = 2 * reach / options.spacing;
    const double n_traces = n_rows * (options.persistence < 1 ? 2 * reach / (options.length + bridge) : 1);
    if (!(n_traces <= max_traces)) {
        char text[160];
        std::snprintf(text, sizeof text, "asks for some %.2g traces across a body of %.4g m; at most %.0e are placed",
                      n_traces, box.diagonal(), max_traces);
        throw ShapeError(part, text);
    }
    Drawing drawing(shape);
    int n_left_out = 0;

    // from `from` to `to` along the row at `offset` across, turned by the scatter of the direction
    const auto trace_at = [&](double offset, double from, double to) -> Segment {
        const double row_angle = options.direction, angle = row_angle + options.spread * random.normal();
        const Vec2 row(std::cos(row_angle), std::sin(row_angle)), along(std::cos(angle), std::sin(angle));
        const Vec2 centre = middle + offset * turned_left(row) + 0.5 * (from + to) * row;
        return {centre - 0.5 * (to - from) * along, centre + 0.5 * (to - from) * along};
    };
    const auto place = [&](double offset, double from, double to) {
        for (int trial = 0; trial < max_trials; ++trial) {
            const Segment trace =
                trace_at(offset + (trial == 0 ? 0 : random.uniform(-0.3, 0.3) * options.spacing), from, to);
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
        if (options.persistence >= 1) {
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
