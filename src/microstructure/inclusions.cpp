#include "microstructure/inclusions.hpp"

#include "base/random.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace knap {
namespace {

constexpr int max_trials = 5000;  // of one inclusion

/// Diameters whose circles have the area requested, or as many as are requested; largest first.
std::vector<double> diameters(const InclusionOptions& options, double area, Random& random) {
    std::vector<double> found;
    for (double missing = area; options.number > 0 ? static_cast<int>(found.size()) < options.number : missing > 0;) {
        const double d = options.size * random.lognormal(options.spread), own = 0.25 * std::numbers::pi * d * d;
        if (options.number == 0 && own > 2 * missing) break;
        found.push_back(d);
        missing -= own;
    }
    std::sort(found.rbegin(), found.rend());
    return found;
}

/// The outline of one inclusion of area pi d^2/4 around the origin; of a disc (ellipse) a polygon with sides of the
/// local mesh size.
class Form {
public:
    Form(const InclusionOptions& options, double diameter, Random& random)
        : options_(options), diameter_(diameter), turn_(random.uniform(0, 2 * std::numbers::pi)) {
        std::vector<Vec2> corners;
        for (int i = 0; i < options.corners; ++i) {
            const double shift = random.uniform(-0.3, 0.3), radius = random.uniform(0.85, 1.15);
            corners.push_back(radius * direction_of(turn_ + 2 * std::numbers::pi * (i + shift) / options.corners));
        }
        along_ = direction_of(options.direction ? *options.direction : random.uniform(0, std::numbers::pi));
        if (options.corners > 0) outline_ = scaled(corners);
    }

    const std::vector<Vec2>& outline(double side) {
        if (options_.corners > 0) return outline_;
        const int n = std::max(8, static_cast<int>(std::lround(std::numbers::pi * diameter_ / side)));
        if (n == static_cast<int>(outline_.size())) return outline_;
        std::vector<Vec2> points;
        for (int i = 0; i < n; ++i) points.push_back(direction_of(turn_ + 2 * std::numbers::pi * i / n));
        return outline_ = scaled(std::move(points));
    }

private:
    static Vec2 direction_of(double angle) { return {std::cos(angle), std::sin(angle)}; }

    std::vector<Vec2> scaled(std::vector<Vec2> points) const {
        const Vec2 across = turned_left(along_);
        for (Vec2& p : points) p = along_.dot(p) * options_.elongation * along_ + across.dot(p) * across;
        const double scale = std::sqrt(0.25 * std::numbers::pi * diameter_ * diameter_ / std::abs(signed_area(points)));
        for (Vec2& p : points) p *= scale;
        return points;
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
    Vec2 centre;    // [m] of a circle around it
    double radius;  // [m]
    std::vector<Segment> sides;

    Obstacle(std::vector<Vec2> line, bool is_closed)
        : points(std::move(line)), closed(is_closed), sides(sides_of(points, closed)) {
        const Box box = bounding_box(points);
        centre = box.middle();
        radius = 0.5 * box.diagonal();
    }
};

bool nearer_than(double distance, const Obstacle& a, const Obstacle& b) {
    if ((a.centre - b.centre).norm() > a.radius + b.radius + distance) return false;
    for (const Segment& s : a.sides)
        for (const Segment& t : b.sides)
            if (distance_between(s, t) < distance) return true;
    return (b.closed && contains(b.points, a.points.front())) || (a.closed && contains(a.points, b.points.front()));
}

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

std::string no_room(const PlacedInclusions& placed, const InclusionOptions& options) {
    return "finds no room: " + std::to_string(placed.n) + ", which fill " + std::to_string(100 * placed.fraction) +
           " % of the area, are placed, " +
           (options.number > 0 ? std::to_string(options.number) : std::to_string(100 * options.fraction) + " %") +
           " are wanted";
}

}  // namespace

PlacedInclusions place_inclusions(Shape& shape, const InclusionOptions& options, std::uint64_t seed,
                                  const std::string& part) {
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
            const Obstacle candidate(std::move(points), true);
            const auto is_near = [&](const Obstacle& other) { return nearer_than(options.distance, candidate, other); };
            if (std::any_of(obstacles.begin(), obstacles.end(), is_near)) continue;
            done = true;
            ++placed.n;
            placed.fraction += std::abs(signed_area(candidate.points)) / area;
            if (options.tag) shape.regions.push_back({candidate.points, *options.tag});
            else
                shape.holes.push_back(
                    {candidate.points, std::vector<Index>(candidate.points.size(), options.boundary)});
            obstacles.push_back(candidate);
        }
        if (!done) throw ShapeError(part, no_room(placed, options));
    }
    return placed;
}

}  // namespace knap
