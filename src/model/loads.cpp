#include "model/loads.hpp"

#include "base/table_corner.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace knap {
namespace {

constexpr double resolved = 1e-3;  // [-] of the values around: the trapezoid misses no more

}  // namespace

double TimeFunction::operator()(double t) const {
    assert(time.size() == value.size());
    if (time.empty()) return 1;
    if (t <= time.front()) return value.front();
    if (t >= time.back()) return value.back();
    const std::size_t after = std::upper_bound(time.begin(), time.end(), t) - time.begin();
    const double part = (t - time[after - 1]) / (time[after] - time[after - 1]);
    return value[after - 1] + part * (value[after] - value[after - 1]);
}

double TimeFunction::slope_before(double t) const {
    if (time.empty() || t <= time.front() || t > time.back()) return 0;
    const std::size_t after = std::lower_bound(time.begin(), time.end(), t) - time.begin();
    return (value[after] - value[after - 1]) / (time[after] - time[after - 1]);
}

/// visit(from, to, a, b): the straight pieces of positive length in the interval, with the values at their ends on the
/// side of the piece (two points at one time are a jump).
template <class Visit>
void TimeFunction::for_each_piece(double begin, double end, const Visit& visit) const {
    std::size_t i = std::upper_bound(time.begin(), time.end(), begin) - time.begin();
    const auto between = [&](double t) {
        if (i == 0) return value.front();
        if (i == time.size()) return value.back();
        return value[i - 1] + (t - time[i - 1]) / (time[i] - time[i - 1]) * (value[i] - value[i - 1]);
    };
    double from = begin, a = between(begin);
    for (; i < time.size() && time[i] < end; ++i) {
        if (time[i] > from) visit(from, time[i], a, value[i]);
        from = time[i], a = value[i];
    }
    visit(from, end, a, between(end));
}

double TimeFunction::beyond_trapezoid(double begin, double end) const {
    const auto inside = std::lower_bound(time.begin(), time.end(), begin);
    if (inside == time.end() || *inside > end) return 0;
    const auto behind = std::upper_bound(inside, time.end(), end);
    double sum = 0, largest = 0;  // of the points around
    if (inside != time.begin()) largest = std::abs(value[inside - time.begin() - 1]);
    if (behind != time.end()) largest = std::max(largest, std::abs(value[behind - time.begin()]));
    for_each_piece(begin, end, [&](double from, double to, double a, double b) {
        sum += 0.5 * (to - from) * (a + b);
        largest = std::max({largest, std::abs(a), std::abs(b)});
    });
    const double beyond = sum / (end - begin) - 0.5 * ((*this)(begin) + (*this)(end));
    return std::abs(beyond) > resolved * largest ? beyond : 0;
}

std::array<double, 2> TimeFunction::range(double begin, double end) const {
    if (time.empty()) return {1, 1};
    double low = (*this)(end), high = low;
    for_each_piece(begin, end, [&](double, double, double a, double b) {
        low = std::min({low, a, b}), high = std::max({high, a, b});
    });
    return {low, high};
}

double TimeFunction::integral(double t) const {
    if (time.empty()) return t;
    double sum = 0;
    for_each_piece(0, t, [&](double from, double to, double a, double b) { sum += 0.5 * (to - from) * (a + b); });
    return sum;
}

double TimeFunction::over_step(double begin, double end, double theta) const {
    const double at_ends = theta * (*this)(end) + (1 - theta) * (*this)(begin), beyond = beyond_trapezoid(begin, end);
    if (beyond == 0) return at_ends;
    double low = infinity, high = -infinity;  // without the far side of a jump at an end
    for_each_piece(begin, end, [&](double, double, double a, double b) {
        low = std::min({low, a, b}), high = std::max({high, a, b});
    });
    return std::clamp(at_ends + beyond, low, high);
}

double TimeFunction::over_kick(double t, double before, double after) const {
    if (time.empty()) return 1;
    const double missed =
        (before > 0 ? before * beyond_trapezoid(t - before, t) : 0) + after * beyond_trapezoid(t, t + after);
    return missed == 0 ? (*this)(t) : (*this)(t) + missed / (before + after);
}

double TimeFunction::corner(double begin, double end, double shortest) const {
    const auto first = std::upper_bound(time.begin(), time.end(), begin),
               last = std::lower_bound(first, time.end(), end);
    if (first == last) return end;
    const auto [low, high] = std::ranges::minmax(value);
    const double at_begin = (*this)(begin), slope = ((*this)(end)-at_begin) / (end - begin);
    const auto value_at = [&](std::size_t i) { return value[i]; };
    double farthest = 0, found = end;
    for (auto at = first; at != last; ++at) {
        if (*at - begin < shortest) continue;
        const std::size_t i = at - time.begin();
        const double off = std::abs(value[i] - at_begin - slope * (*at - begin));
        if (off > farthest && off > may_pass_over(time, i, value_at) * (high - low)) farthest = off, found = *at;
    }
    return found;
}

PrescribedRate prescribed_rate(bool is_displacement, double value, const TimeFunction& history, double displacement,
                               const StepTimes& step) {
    const double end = step.begin + step.h;
    if (is_displacement) {
        const double rate = (value * history(end) - displacement) / step.h;
        return {rate, step.central_differences ? rate : value * history.slope_before(end)};
    }
    if (step.central_differences) {
        const bool bends = history.beyond_trapezoid(step.begin, end) != 0;
        const double velocity =
            value * (bends ? history.over_step(step.begin, end, 0.5) : history(step.begin + 0.5 * step.h));
        return {velocity, velocity};
    }
    return {value * history.over_step(step.begin, end, step.theta), value * history(end)};
}

}  // namespace knap
