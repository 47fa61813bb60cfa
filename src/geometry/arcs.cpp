#include "geometry/arcs.hpp"

#include "geometry/shape.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace knap {
namespace {

constexpr double turn = 2 * std::numbers::pi;
constexpr double least_of_turn = 12;  // sides
constexpr double most_samples = 1e6;

/// Length in local sizes up to the end of each of many equal pieces.
std::vector<double> in_sizes(const Arc& arc, const SizeField& size) {
    const double n_wanted = size.slope() > 0 ? 8 * arc.length() / size.smallest() : 1;
    const int n = static_cast<int>(std::clamp(std::ceil(n_wanted), 1.0, most_samples));
    std::vector<double> sum{0};
    for (int i = 0; i < n; ++i) sum.push_back(sum.back() + arc.length() / n / size(arc.at((i + 0.5) / n)));
    return sum;
}

double sides_of(const Arc& arc, double length_in_sizes) {
    return std::max({1.0, std::ceil(least_of_turn * std::abs(arc.sweep) / turn * (1 - 1e-12)), std::ceil(length_in_sizes)});
}

}  // namespace

double Arc::length() const { return radius * std::abs(sweep); }

Vec2 Arc::at(double part) const { return centre + radius * Vec2(std::cos(from + part * sweep), std::sin(from + part * sweep)); }

std::optional<Arc> arc_through(const Vec2& a, const Vec2& through, const Vec2& b) {
    // the centre is equally far from all three, relative to a: 2 p . c = p . p
    const Vec2 p = through - a, q = b - a;
    const double area = cross(p, q), scale = std::max({p.squaredNorm(), q.squaredNorm(), (q - p).squaredNorm()});
    if (!(std::abs(area) > 1e-9 * scale)) return std::nullopt;
    const Vec2 c = Vec2(q.y() * p.squaredNorm() - p.y() * q.squaredNorm(), p.x() * q.squaredNorm() - q.x() * p.squaredNorm()) / (2 * area);
    const auto direction = [&](const Vec2& x) { return std::atan2(x.y() - c.y(), x.x() - c.x()); };
    const double from = direction(Vec2::Zero());
    double sweep = direction(q) - from;
    if (area > 0 && sweep < 0) sweep += turn;  // a, through and b counterclockwise
    if (area < 0 && sweep > 0) sweep -= turn;
    return Arc{a + c, c.norm(), from, sweep};
}

double sides_of(const Arc& arc, const SizeField& size) { return sides_of(arc, in_sizes(arc, size).back()); }

std::vector<Vec2> points_within(const Arc& arc, const SizeField& size) {
    const std::vector<double> sum = in_sizes(arc, size);
    const int n = static_cast<int>(sides_of(arc, sum.back()));
    std::vector<Vec2> points;
    std::size_t i = 1;
    for (int k = 1; k < n; ++k) {
        const double wanted = sum.back() * k / n;
        while (i + 1 < sum.size() && sum[i] < wanted) ++i;
        const double fraction = (wanted - sum[i - 1]) / (sum[i] - sum[i - 1]);
        points.push_back(arc.at((static_cast<double>(i) - 1 + fraction) / static_cast<double>(sum.size() - 1)));
    }
    return points;
}

std::vector<Vec2> circle(const Vec2& centre, double radius, const SizeField& size) {
    if (size.slope() == 0) return circle(centre, radius, static_cast<int>(std::max(least_of_turn, std::ceil(turn * radius / size.largest()))));
    const Arc arc{centre, radius, 0, turn};
    std::vector<Vec2> points{arc.at(0)};
    for (const Vec2& p : points_within(arc, size)) points.push_back(p);
    return points;
}

}  // namespace knap
