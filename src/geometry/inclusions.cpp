#include "geometry/inclusions.hpp"

#include "base/random.hpp"
#include "geometry/planar_graph.hpp"
#include "geometry/polygon.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace knap {
namespace {

constexpr int most_trials = 5000;  // of one inclusion

/// Diameters whose circles have the area wanted, largest first.
std::vector<double> diameters(const InclusionOptions& options, double area, Random& random) {
    const double variance = std::log(1 + options.spread * options.spread);
    std::vector<double> found;
    for (double missing = area; missing > 0;) {
        const double d = options.size * std::exp(std::sqrt(variance) * random.normal() - 0.5 * variance), own = 0.25 * std::numbers::pi * d * d;
        if (own > 2 * missing) break;
        found.push_back(d);
        missing -= own;
    }
    std::sort(found.rbegin(), found.rend());
    return found;
}

/// An outline of area pi d^2/4 round the origin.
std::vector<Vec2> outline(const InclusionOptions& options, double diameter, Random& random) {
    const bool round = options.corners == 0;
    const int n = round ? std::max(8, static_cast<int>(std::lround(std::numbers::pi * diameter / options.side))) : options.corners;
    const double turn = random.uniform(0, 2 * std::numbers::pi);
    std::vector<Vec2> points;
    for (int i = 0; i < n; ++i) {
        const double shift = round ? 0 : random.uniform(-0.3, 0.3), radius = round ? 1 : random.uniform(0.85, 1.15);
        const double angle = turn + 2 * std::numbers::pi * (i + shift) / n;
        points.push_back(radius * Vec2(std::cos(angle), std::sin(angle)));
    }
    const double direction = options.direction ? *options.direction : random.uniform(0, std::numbers::pi);
    const Vec2 along(std::cos(direction), std::sin(direction)), across = turned_left(along);
    for (Vec2& p : points) p = along.dot(p) * options.elongation * along + across.dot(p) * across;
    const double scale = std::sqrt(0.25 * std::numbers::pi * diameter * diameter / std::abs(signed_area(points)));
    for (Vec2& p : points) p *= scale;
    return points;
}

/// What an inclusion has to keep its distance from.
struct Obstacle {
    Vec2 centre;
    double radius;  // [m] of a circle round it
    std::vector<Vec2> line;
    bool closed;

    std::size_t n_sides() const { return closed ? line.size() : line.size() - 1; }
};

Obstacle obstacle(std::vector<Vec2> line, bool closed) {
    const Box box = bounding_box(line);
    return {0.5 * (box.low + box.high), 0.5 * box.diagonal(), std::move(line), closed};
}

bool nearer_than(double distance, const Obstacle& a, const Obstacle& b) {
    if ((a.centre - b.centre).norm() > a.radius + b.radius + distance) return false;
    for (std::size_t i = 0; i < a.n_sides(); ++i)
        for (std::size_t j = 0; j < b.n_sides(); ++j)
            if (distance_between_segments(a.line[i], a.line[(i + 1) % a.line.size()], b.line[j], b.line[(j + 1) % b.line.size()]) < distance) return true;
    return (b.closed && contains(b.line, a.line.front())) || (a.closed && contains(a.line, b.line.front()));
}

/// The sides of a long line one by one, so that the circle round each is small.
void add_sides(const std::vector<Vec2>& line, bool closed, std::vector<Obstacle>& obstacles) {
    for (std::size_t i = 0; i + (closed ? 0 : 1) < line.size(); ++i)
        obstacles.push_back(obstacle({line[i], line[(i + 1) % line.size()]}, false));
}

std::vector<Obstacle> obstacles_of(const Shape& shape) {
    std::vector<Obstacle> obstacles;
    add_sides(shape.outer.points, true, obstacles);
    for (const Ring& hole : shape.holes) obstacles.push_back(obstacle(hole.points, true));
    for (const Region& region : shape.regions) add_sides(region.points, true, obstacles);
    for (const Crack& crack : shape.cracks) add_sides(crack.points, false, obstacles);
    return obstacles;
}

}  // namespace

void place_inclusions(Shape& shape, const InclusionOptions& options, std::uint64_t seed, const std::string& part) {
    Random random(seed, part);
    double area = std::abs(signed_area(shape.outer.points));
    for (const Ring& hole : shape.holes) area -= std::abs(signed_area(hole.points));
    const Box box = bounding_box(shape.outer.points);
    const Shape body = shape;
    std::vector<Obstacle> obstacles = obstacles_of(shape);
    double placed = 0;
    for (const double diameter : diameters(options, options.fraction * area, random)) {
        const std::vector<Vec2> form = outline(options, diameter, random);
        bool done = false;
        for (int trial = 0; trial < most_trials && !done; ++trial) {
            const Vec2 centre(random.uniform(box.low.x(), box.high.x()), random.uniform(box.low.y(), box.high.y()));
            if (!in_body(body, centre)) continue;
            std::vector<Vec2> points = form;
            for (Vec2& p : points) p += centre;
            const Obstacle candidate = obstacle(std::move(points), true);
            if (std::any_of(obstacles.begin(), obstacles.end(), [&](const Obstacle& o) { return nearer_than(options.distance, candidate, o); })) continue;
            done = true;
            placed += std::abs(signed_area(candidate.line));
            if (options.tag)
                shape.regions.push_back({candidate.line, *options.tag});
            else
                shape.holes.push_back({candidate.line, std::vector<Index>(candidate.line.size(), options.boundary)});
            obstacles.push_back(candidate);
        }
        if (!done)
            throw ShapeError(part, "finds no room: " + std::to_string(100 * placed / area) + " % of the area are filled, " +
                                       std::to_string(100 * options.fraction) + " % are wanted");
    }
}

}  // namespace knap
