#include "mesh/shape.hpp"

#include <algorithm>
#include <cmath>

namespace knap {

bool Shape::contains(const Vec2& p) const {
    const auto covers = [&](const Ring& ring) { return knap::contains(ring.points, p); };
    return covers(outer) && std::none_of(holes.begin(), holes.end(), covers);
}

double Shape::area() const {
    double sum = std::abs(signed_area(outer.points));
    for (const Ring& hole : holes) sum -= std::abs(signed_area(hole.points));
    return sum;
}

double Shape::tolerance() const { return 1e-6 * bounding_box(outer.points).diagonal(); }

namespace {

void change_points(Shape& shape, const auto& changed) {
    const auto change_all = [&](std::vector<Vec2>& points) {
        for (Vec2& p : points) p = changed(p);
    };
    change_all(shape.outer.points);
    for (Ring& hole : shape.holes) change_all(hole.points);
    for (Crack& crack : shape.cracks) change_all(crack.points);
    for (Region& region : shape.regions) change_all(region.points);
}

}  // namespace

void turn(Shape& shape, const Vec2& about, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    change_points(shape, [&](const Vec2& p) -> Vec2 { return about + c * (p - about) + s * turned_left(p - about); });
}

void move(Shape& shape, const Vec2& by) {
    change_points(shape, [&](const Vec2& p) -> Vec2 { return p + by; });
}

namespace {

std::vector<Segment> border_of(const Shape& shape) {
    std::vector<Segment> border = sides_of(shape.outer.points, true);
    for (const Ring& hole : shape.holes)
        for (const Segment& side : sides_of(hole.points, true)) border.push_back(side);
    return border;
}

/// The middle of the longest part in the shape of a line across it.
Vec2 point_within(const Shape& shape, const std::vector<Segment>& border) {
    const Box box = bounding_box(shape.outer.points);
    const double y = box.low.y() + 0.4837 * box.extent().y();  // through no vertex of a simple drawing
    std::vector<double> crossings;
    for (const auto& [a, b] : border)
        if ((a.y() > y) != (b.y() > y)) crossings.push_back(a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
    std::ranges::sort(crossings);
    Vec2 middle(box.middle().x(), y);
    double longest = 0;
    for (std::size_t k = 0; k + 1 < crossings.size(); k += 2)
        if (const double length = crossings[k + 1] - crossings[k]; length > longest)
            longest = length, middle.x() = 0.5 * (crossings[k] + crossings[k + 1]);
    return middle;
}

/// The middles of the pieces into which the border of another shape divides the side `s`.
std::vector<Vec2> middles_of_pieces(const Segment& s, const std::vector<Segment>& other, double tolerance) {
    const Box reach{s.a.cwiseMin(s.b).array() - tolerance, s.a.cwiseMax(s.b).array() + tolerance};
    std::vector<double> cuts{0, 1};
    for (const Segment& t : other) {
        if ((t.a.cwiseMin(t.b).array() > reach.high.array()).any() ||
            (t.a.cwiseMax(t.b).array() < reach.low.array()).any())
            continue;
        if (double position; segments_cross(s, t, position)) cuts.push_back(position);
        if (distance_to_segment(s.a, s.b, t.a) <= tolerance) cuts.push_back(nearest_parameter(s.a, s.b, t.a));
    }
    std::ranges::sort(cuts);
    std::vector<Vec2> middles;
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i)
        if (cuts[i + 1] > cuts[i]) middles.push_back(s.a + 0.5 * (cuts[i] + cuts[i + 1]) * (s.b - s.a));
    return middles;
}

}  // namespace

std::optional<ShapeOverlap> overlap(const Shape& a, const Shape& b, double tolerance) {
    const Box box_a = bounding_box(a.outer.points), box_b = bounding_box(b.outer.points);
    const Box common{box_a.low.cwiseMax(box_b.low), box_a.high.cwiseMin(box_b.high)};
    if (!((common.extent().array() > tolerance).all())) return std::nullopt;
    const std::vector<Segment> border_a = border_of(a), border_b = border_of(b);
    ShapeOverlap deepest{tolerance, Vec2::Zero()};
    const auto try_at = [&](const Vec2& p, const Shape& shape, const std::vector<Segment>& border) {
        if (!shape.contains(p)) return;
        double depth = infinity;
        for (const Segment& side : border) depth = std::min(depth, distance_to_segment(side.a, side.b, p));
        if (depth > deepest.depth) deepest = {depth, p};
    };
    const auto try_sides = [&](const std::vector<Segment>& sides, const Shape& shape,
                               const std::vector<Segment>& border) {
        for (const Segment& side : sides)
            for (const Vec2& p : middles_of_pieces(side, border, tolerance)) try_at(p, shape, border);
    };
    try_sides(border_a, b, border_b);
    try_sides(border_b, a, border_a);
    if (deepest.depth > tolerance) return deepest;
    try_at(point_within(a, border_a), b, border_b);  // one and the same outline, or one in the other
    try_at(point_within(b, border_b), a, border_a);
    return deepest.depth > tolerance ? std::optional(deepest) : std::nullopt;
}

}  // namespace knap
