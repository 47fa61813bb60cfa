#include "mesh/size_field.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace knap {
namespace {

constexpr double full_turn = 2 * std::numbers::pi;
constexpr double min_sides_of_turn = 12;

double length_of(const std::vector<Segment>& line) {
    double length = 0;
    for (const Segment& s : line) length += (s.b - s.a).norm();
    return length;
}

LengthInSizes length_in_sizes(const Arc& arc, const SizeField& size) {
    return {arc.length(), size, [&](double position) { return arc.at(position); }};
}

double n_sides(const Arc& arc, double length_in_sizes) {
    const double of_turn = std::ceil(min_sides_of_turn * std::abs(arc.sweep) / full_turn * (1 - 1e-12));
    return std::max({1.0, of_turn, std::ceil(length_in_sizes)});
}

}  // namespace

double RefinedPlace::distance(const Vec2& p) const {
    if (line.empty()) return box.distance(p);
    double nearest = infinity;
    for (const Segment& s : line) nearest = std::min(nearest, distance_to_segment(s.a, s.b, p));
    return std::max(0.0, nearest - half_width);
}

double RefinedPlace::area() const {
    const Vec2 extent = box.extent();
    return line.empty() ? extent.x() * extent.y()
                        : 2 * half_width * length_of(line) + std::numbers::pi * half_width * half_width;
}

double RefinedPlace::perimeter() const {
    return line.empty() ? 2 * box.extent().sum() : 2 * length_of(line) + full_turn * half_width;
}

RefinedPlace refined_strip(const std::vector<Vec2>& points, double width, double size) {
    const Box box = bounding_box(points);
    const Vec2 margin = Vec2::Constant(0.5 * width);
    return {{box.low - margin, box.high + margin}, size, sides_of(points, false), 0.5 * width};
}

double SizeField::operator()(const Vec2& p) const {
    double size = options_.size;
    for (const RefinedPlace& place : options_.refine) {
        const double least = place.size + options_.grading * place.box.distance(p);
        if (least >= size) continue;  // without a look at all segments of a distant strip
        size = place.line.empty() ? least : std::min(size, place.size + options_.grading * place.distance(p));
    }
    return factor_ * size;
}

double SizeField::smallest() const {
    double size = options_.size;
    for (const RefinedPlace& place : options_.refine) size = std::min(size, place.size);
    return factor_ * size;
}

LengthInSizes::LengthInSizes(double length, const SizeField& size, const std::function<Vec2(double)>& at) {
    constexpr double max_samples = 1e7;
    const double n_needed = size.slope() == 0 ? 1 : std::ceil(8 * length / size.smallest());
    const int n = static_cast<int>(std::clamp(n_needed, 1.0, max_samples));
    for (int i = 0; i < n; ++i) sum_.push_back(sum_.back() + length / n / size(at((i + 0.5) / n)));
}

double LengthInSizes::position(double target) {
    while (sample_ + 1 < sum_.size() && sum_[sample_] < target) ++sample_;
    const double fraction = (target - sum_[sample_ - 1]) / (sum_[sample_] - sum_[sample_ - 1]);
    return (static_cast<double>(sample_) - 1 + fraction) / static_cast<double>(sum_.size() - 1);
}

double Arc::length() const { return radius * std::abs(sweep); }

Vec2 Arc::at(double position) const {
    return centre + radius * Vec2(std::cos(from + position * sweep), std::sin(from + position * sweep));
}

std::optional<Arc> arc_through(const Vec2& a, const Vec2& through, const Vec2& b) {
    // the centre is equally far from all three, relative to a: 2 p . c = p . p
    const Vec2 p = through - a, q = b - a;
    const double area = cross(p, q), scale = std::max({p.squaredNorm(), q.squaredNorm(), (q - p).squaredNorm()});
    if (!(std::abs(area) > 1e-9 * scale)) return std::nullopt;
    const double p2 = p.squaredNorm(), q2 = q.squaredNorm();
    const Vec2 c = Vec2(q.y() * p2 - p.y() * q2, p.x() * q2 - q.x() * p2) / (2 * area);
    const auto direction = [&](const Vec2& x) { return std::atan2(x.y() - c.y(), x.x() - c.x()); };
    const double from = direction(Vec2::Zero());
    double sweep = direction(q) - from;
    if (area > 0 && sweep < 0) sweep += full_turn;  // a, through and b counterclockwise
    if (area < 0 && sweep > 0) sweep -= full_turn;
    return Arc{a + c, c.norm(), from, sweep};
}

double sides_of(const Arc& arc, const SizeField& size) { return n_sides(arc, length_in_sizes(arc, size).total()); }

std::vector<Vec2> points_within(const Arc& arc, const SizeField& size) {
    LengthInSizes length = length_in_sizes(arc, size);
    const int n = static_cast<int>(n_sides(arc, length.total()));
    std::vector<Vec2> points;
    for (int k = 1; k < n; ++k) points.push_back(arc.at(length.position(length.total() * k / n)));
    return points;
}

std::vector<Vec2> circle(const Vec2& centre, double radius, const SizeField& size) {
    if (size.slope() == 0)
        return circle(centre, radius,
                      static_cast<int>(std::max(min_sides_of_turn, std::ceil(full_turn * radius / size.largest()))));
    const Arc arc{centre, radius, 0, full_turn};
    std::vector<Vec2> points{arc.at(0)};
    for (const Vec2& p : points_within(arc, size)) points.push_back(p);
    return points;
}

}  // namespace knap
