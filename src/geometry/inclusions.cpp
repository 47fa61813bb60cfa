#include "geometry/inclusions.hpp"

#include "base/random.hpp"
#include "geometry/planar_graph.hpp"
#include "geometry/polygon.hpp"
#include "geometry/size_field.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace knap {
namespace {

constexpr int most_trials = 5000;  // of one inclusion

/// Diameters whose circles have the area wanted, or as many as are wanted; largest first.
std::vector<double> diameters(const InclusionOptions& options, double area, Random& random) {
    const double variance = std::log(1 + options.spread * options.spread);
    std::vector<double> found;
    for (double missing = area; options.number > 0 ? static_cast<int>(found.size()) < options.number : missing > 0;) {
        const double d = options.size * std::exp(std::sqrt(variance) * random.normal() - 0.5 * variance), own = 0.25 * std::numbers::pi * d * d;
        if (options.number == 0 && own > 2 * missing) break;
        found.push_back(d);
        missing -= own;
    }
    std::sort(found.rbegin(), found.rend());
    return found;
}

/// The form of one inclusion of area pi d^2/4 round the origin; as a disc (ellipse) a polygon with sides of the mesh size where it lies.
class Form {
public:
    Form(const InclusionOptions& options, double diameter, Random& random) : options_(options), diameter_(diameter), turn_(random.uniform(0, 2 * std::numbers::pi)) {
        for (int i = 0; i < options.corners; ++i) {
            const double shift = random.uniform(-0.3, 0.3), radius = random.uniform(0.85, 1.15);
            corners_.push_back(radius * direction_of(turn_ + 2 * std::numbers::pi * (i + shift) / options.corners));
        }
        const double direction = options.direction ? *options.direction : random.uniform(0, std::numbers::pi);
        along_ = direction_of(direction);
        if (options.corners > 0) outline_ = scaled(corners_);
    }

    const std::vector<Vec2>& outline_of_sides(double side) {
        const int n = options_.corners > 0 ? options_.corners : std::max(8, static_cast<int>(std::lround(std::numbers::pi * diameter_ / side)));
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
    std::vector<Vec2> corners_, outline_;
};

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

std::string filled(const PlacedInclusions& placed) {
    return std::to_string(placed.n) + ", which fill " + std::to_string(100 * placed.fraction) + " % of the area,";
}

std::string wanted(const InclusionOptions& options) {
    return options.number > 0 ? std::to_string(options.number) + " are" : std::to_string(100 * options.fraction) + " % are";
}

}  // namespace

PlacedInclusions place_inclusions(Shape& shape, const InclusionOptions& options, std::uint64_t seed, const std::string& part) {
    Random random(seed, part);
    double area = std::abs(signed_area(shape.outer.points));
    for (const Ring& hole : shape.holes) area -= std::abs(signed_area(hole.points));
    const Box box = bounding_box(shape.outer.points);
    const Shape body = shape;
    std::vector<Obstacle> obstacles = obstacles_of(shape);
    const SizeField size(options.mesh, 1);
    PlacedInclusions placed;
    for (const double diameter : diameters(options, options.fraction * area, random)) {
        Form form(options, diameter, random);
        bool done = false;
        for (int trial = 0; trial < most_trials && !done; ++trial) {
            const Vec2 centre(random.uniform(box.low.x(), box.high.x()), random.uniform(box.low.y(), box.high.y()));
            if (!in_body(body, centre)) continue;
            std::vector<Vec2> points = form.outline_of_sides(size(centre));
            for (Vec2& p : points) p += centre;
            const Obstacle candidate = obstacle(std::move(points), true);
            if (std::any_of(obstacles.begin(), obstacles.end(), [&](const Obstacle& o) { return nearer_than(options.distance, candidate, o); })) continue;
            done = true;
            ++placed.n;
            placed.fraction += std::abs(signed_area(candidate.line)) / area;
            if (options.tag)
                shape.regions.push_back({candidate.line, *options.tag});
            else
                shape.holes.push_back({candidate.line, std::vector<Index>(candidate.line.size(), options.boundary)});
            obstacles.push_back(candidate);
        }
        if (!done) throw ShapeError(part, "finds no room: " + filled(placed) + " are placed, " + wanted(options) + " wanted");
    }
    return placed;
}

}  // namespace knap
