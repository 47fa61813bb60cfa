#include "stepper/implicit/line_search.hpp"

#include "base/reserve_capacity.hpp"
#include "base/secant.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr double small_slope = 0.1, found_slope = 1e-2;  // of that at the start
constexpr double min_length = 0.05;                      // on soft springs
constexpr int max_slopes = 30, max_doublings = 10;

}  // namespace

LineSearch::LineSearch(const Model& model) { reserve_capacity(model.fan_points.size() + 1, turn_); }

void LineSearch::begin(const CondensedSystem& system, const std::vector<ActivePoint>& points) {
    bulk_slope_ = system.slope(), bulk_curvature_ = system.curvature();
    turn_.resize(points.size());
    for (std::size_t j = 0; j < turn_.size(); ++j) turn_[j] = points[j].across(system.direction());
}

template <class MultipliersOf>
double LineSearch::slope(double a, const std::vector<ActivePoint>& points, const MultipliersOf& multipliers_of) const {
    double sum = bulk_slope_ + a * bulk_curvature_;
    for (std::size_t j = 0; j < turn_.size(); ++j) {
        if (turn_[j].isZero(0)) continue;
        const ActivePoint& point = points[j];
        const Vec2 rate = point.rate + a * turn_[j];
        const PointResponse r = respond(point.law, multipliers_of(j), rate.x(), rate.y());
        sum -= r.normal(point.law) * turn_[j].x() + r.tangential * turn_[j].y();
    }
    return sum;
}

double LineSearch::length(const CondensedSystem& system, const std::vector<ActivePoint>& points) {
    begin(system, points);
    const auto at = [&](double a) {
        return slope(a, points, [&](std::size_t j) -> const Multipliers& { return points[j].multipliers; });
    };
    double slope_at_start = bulk_slope_;  // the responses of the points are those of the start
    for (std::size_t j = 0; j < turn_.size(); ++j)
        if (!turn_[j].isZero(0))
            slope_at_start -=
                points[j].response.normal(points[j].law) * turn_[j].x() + points[j].response.tangential * turn_[j].y();
    double low = 0, slope_low = slope_at_start, high = 1, slope_high = at(1);
    if (slope_low >= 0 || std::abs(slope_high) <= small_slope * std::abs(slope_low)) return 1;
    for (int i = 0; slope_high < 0; ++i) {  // still downhill: a majorised step was too short
        if (i == max_doublings) return high;
        low = high, slope_low = slope_high;
        high *= 2, slope_high = at(high);
    }
    return zero_between(low, slope_low, high, slope_high, found_slope * std::abs(slope_at_start), max_slopes, at);
}

double LineSearch::length_on_soft_springs(const CondensedSystem& system, const std::vector<ActivePoint>& points,
                                          const std::vector<Vec2>& move) {
    begin(system, points);
    const auto at = [&](double a) {
        return slope(a, points, [&](std::size_t j) {
            Multipliers moved = points[j].softened();
            moved.contact += a * move[j].x(), moved.tangential += a * move[j].y();
            return moved;
        });
    };
    const double slope_at_start = at(0), slope_at_end = at(1);
    if (slope_at_end <= small_slope * std::abs(slope_at_start)) return 1;
    if (slope_at_start >= 0) return 0.5;
    const double found = found_slope * std::abs(slope_at_start);
    return std::clamp(zero_between(0, slope_at_start, 1, slope_at_end, found, max_slopes, at), min_length, 1.0);
}

}  // namespace knap
