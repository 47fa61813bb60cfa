#include "material/friction_over_pressure.hpp"

#include "base/formatted.hpp"

namespace knap {
namespace {

constexpr double straight = 1e-9;  // [-] of the slopes of two pieces: a smaller bend is none

double slope(const Vec2& from, const Vec2& to) { return (to.y() - from.y()) / (to.x() - from.x()); }

}  // namespace

FrictionOverPressure::FrictionOverPressure(const std::vector<Vec2>& points) {
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        const double mu = slope(points[i], points[i + 1]);
        if (!lines_.empty() && mu >= lines_.back().slope * (1 - straight)) continue;
        lines_.push_back({mu, points[i].y() - mu * points[i].x()});
        start_.push_back(points[i].x());
    }
}

std::string fault_of_friction(const std::vector<Vec2>& points) {
    const auto of = [](std::size_t i) { return " (pair " + std::to_string(i + 1) + ")"; };
    if (points.size() < 2) return "has fewer than two pairs";
    if (points.size() > FrictionOverPressure::most_points)
        return formatted("has %zu pairs, more than %zu", points.size(), FrictionOverPressure::most_points);
    if (!points[0].isZero(0)) return "does not start with threshold 0 at pressure 0";
    for (std::size_t i = 1; i < points.size(); ++i) {
        if (!(points[i].x() > points[i - 1].x())) return "has pressures that do not ascend" + of(i);
        if (points[i].y() < points[i - 1].y()) return "has a threshold that falls with the pressure" + of(i);
        if (i >= 2 && slope(points[i - 1], points[i]) > slope(points[i - 2], points[i - 1]) * (1 + straight))
            return "is not concave: its slope grows" + of(i);
    }
    if (points[1].y() == 0) return "has no friction at all";
    return {};
}

}  // namespace knap
