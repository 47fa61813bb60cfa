#include "geometry/joints.hpp"

#include "base/random.hpp"
#include "geometry/planar_graph.hpp"
#include "geometry/polygon.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace knap {
namespace {

constexpr int most_trials = 20;
constexpr double most_traces = 1e6;  // that are looked at; those beside the body too
const double least_sine = std::sin(15 * std::numbers::pi / 180);

struct Line {
    Vec2 a, b;
};

void add_sides(const std::vector<Vec2>& points, bool closed, std::vector<Line>& lines) {
    for (std::size_t i = 0; i + (closed ? 0 : 1) < points.size(); ++i) lines.push_back({points[i], points[(i + 1) % points.size()]});
}

/// Lines and where they cross.
struct Drawing {
    std::vector<Line> lines;
    std::vector<Vec2> crossings;
};

/// They cross well, and where that is goes to `crossings`; or they keep their distance.
bool get_along(const Line& trace, const Line& other, double nearest, std::vector<Vec2>& crossings) {
    double t;
    if (!segments_cross(trace.a, trace.b, other.a, other.b, t)) return distance_between_segments(trace.a, trace.b, other.a, other.b) >= nearest;
    const Vec2 crossing = trace.a + t * (trace.b - trace.a), along = (trace.b - trace.a).normalized();
    for (const Vec2& end : {trace.a, trace.b, other.a, other.b})
        if ((end - crossing).norm() < nearest) return false;
    crossings.push_back(crossing);
    return std::abs(cross(along, (other.b - other.a).normalized())) >= least_sine;
}

/// Adds the sides of a trace when they get along with all that is there.
bool add(const std::vector<Line>& sides, double nearest, Drawing& drawing) {
    std::vector<Vec2> crossings;
    for (const Line& side : sides) {
        for (const Line& line : drawing.lines)
            if (!get_along(side, line, nearest, crossings)) return false;
        for (const Vec2& x : drawing.crossings)
            if (distance_to_segment(side.a, side.b, x) < nearest) return false;
    }
    drawing.lines.insert(drawing.lines.end(), sides.begin(), sides.end());
    drawing.crossings.insert(drawing.crossings.end(), crossings.begin(), crossings.end());
    return true;
}

/// What a shape has, with the crossings of its cracks.
Drawing drawing_of(const Shape& shape) {
    Drawing drawing;
    add_sides(shape.outer.points, true, drawing.lines);
    for (const Ring& hole : shape.holes) add_sides(hole.points, true, drawing.lines);
    for (const Region& region : shape.regions) add_sides(region.points, true, drawing.lines);
    for (const Crack& crack : shape.cracks) {
        std::vector<Line> sides;
        add_sides(crack.points, false, sides);
        for (const Line& side : sides)
            for (const Line& line : drawing.lines) get_along(side, line, 0, drawing.crossings);
        drawing.lines.insert(drawing.lines.end(), sides.begin(), sides.end());
    }
    return drawing;
}

/// A trace of no width, or the four sides of a vein.
std::vector<Vec2> outline(const Line& trace, double thickness) {
    if (thickness == 0) return {trace.a, trace.b};
    const Vec2 half = 0.5 * thickness * turned_left((trace.b - trace.a).normalized());
    return {trace.a - half, trace.b - half, trace.b + half, trace.a + half};
}

/// Some of it lies in the body: a few places along it are tried.
bool reaches_body(const Shape& shape, const Box& box, const Line& trace) {
    const Vec2 low = trace.a.cwiseMin(trace.b), high = trace.a.cwiseMax(trace.b);
    if ((low.array() > box.high.array()).any() || (high.array() < box.low.array()).any()) return false;
    constexpr int n = 64;
    for (int i = 0; i < n; ++i)
        if (in_body(shape, trace.a + (i + 0.5) / n * (trace.b - trace.a))) return true;
    return false;
}

}  // namespace

int place_joints(Shape& shape, const JointOptions& options, std::uint64_t seed, const std::string& part) {
    Random random(seed, part);
    const Shape body = shape;
    const Box box = bounding_box(shape.outer.points);
    const Vec2 middle = 0.5 * (box.low + box.high);
    const double reach = 0.6 * box.diagonal();  // every row crosses the body
    const double bridge = options.persistence < 1 ? options.length * (1 - options.persistence) / options.persistence : 0;
    const double n_rows = 2 * reach / options.spacing, n_traces = n_rows * (options.persistence < 1 ? 2 * reach / (options.length + bridge) : 1);
    if (!(n_traces <= most_traces)) {
        char text[160];
        std::snprintf(text, sizeof text, "asks for some %.2g traces across a body of %.4g m; at most %.0e are placed", n_traces, box.diagonal(), most_traces);
        throw ShapeError(part, text);
    }
    Drawing drawing = drawing_of(shape);
    int n_left_out = 0;

    // what is beside `at` on the row `offset` across, turned by the scatter of the direction
    const auto trace_at = [&](double offset, double from, double to) -> Line {
        const double row_angle = options.direction, angle = row_angle + options.spread * random.normal();
        const Vec2 row(std::cos(row_angle), std::sin(row_angle)), along(std::cos(angle), std::sin(angle));
        const Vec2 centre = middle + offset * turned_left(row) + 0.5 * (from + to) * row;
        return {centre - 0.5 * (to - from) * along, centre + 0.5 * (to - from) * along};
    };
    const auto place = [&](double offset, double from, double to) {
        for (int trial = 0; trial < most_trials; ++trial) {
            const Line trace = trace_at(offset + (trial == 0 ? 0 : random.uniform(-0.3, 0.3) * options.spacing), from, to);
            if (!reaches_body(body, box, trace)) return;
            const std::vector<Vec2> points = outline(trace, options.thickness);
            std::vector<Line> own;
            add_sides(points, points.size() > 2, own);
            if (!add(own, options.nearest, drawing)) continue;
            if (options.tag)
                shape.regions.push_back({points, *options.tag});
            else
                shape.cracks.push_back({points, options.joint});
            return;
        }
        ++n_left_out;
    };
    for (double offset = -reach + random.uniform() * options.spacing; offset < reach; offset += options.spacing * random.uniform(0.5, 1.5)) {
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
