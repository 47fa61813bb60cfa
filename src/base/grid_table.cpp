#include "base/grid_table.hpp"

#include "base/error.hpp"
#include "base/formatted.hpp"
#include "base/table_corner.hpp"

#include <algorithm>
#include <cmath>

namespace knap {

GridTable::GridTable(const std::vector<std::array<double, 4>>& rows) {
    for (std::size_t k = 0; k < 3; ++k) {
        for (const auto& row : rows) axes_[k].push_back(row[k]);
        std::ranges::sort(axes_[k]);
        const auto repeated = std::ranges::unique(axes_[k]);
        axes_[k].erase(repeated.begin(), repeated.end());
    }
    const std::vector<double>&x = axes_[0], &y = axes_[1], &t = axes_[2];
    const auto fail = [&](const char* what, std::size_t i, std::size_t j, std::size_t l) {
        throw UserError("bad-csv", formatted("%s line for x = %.6g, y = %.6g, t = %.6g", what, x[i], y[j], t[l]),
                        formatted("%zu values of x, %zu of y and %zu of t make a grid with one line for each place",
                                  x.size(), y.size(), t.size()));
    };
    const auto index = [](const std::vector<double>& axis, double at) {
        return static_cast<std::size_t>(std::ranges::lower_bound(axis, at) - axis.begin());
    };
    std::vector<std::array<std::size_t, 3>> places;
    for (const auto& row : rows) places.push_back({index(t, row[2]), index(y, row[1]), index(x, row[0])});
    std::ranges::sort(places);
    std::array<std::size_t, 3> expected{0, 0, 0};
    for (const auto& place : places) {
        if (place < expected) fail("there is a second", place[2], place[1], place[0]);
        if (place > expected) fail("there is no", expected[2], expected[1], expected[0]);
        if (++expected[2] == x.size()) expected[2] = 0, ++expected[1];
        if (expected[1] == y.size()) expected[1] = 0, ++expected[0];
    }
    if (expected[0] < t.size()) fail("there is no", expected[2], expected[1], expected[0]);
    values_.resize(rows.size());
    for (const auto& row : rows)
        values_[(index(t, row[2]) * y.size() + index(y, row[1])) * x.size() + index(x, row[0])] = row[3];
}

double GridTable::operator()(double x, double y, double t) const {
    const std::array<double, 3> at{x, y, t};
    std::array<std::size_t, 3> low{}, high{};  // neighbours on each axis
    std::array<double, 3> part{};              // of the upper one
    for (std::size_t k = 0; k < 3; ++k) {
        const std::vector<double>& axis = axes_[k];
        const auto above = static_cast<std::size_t>(std::ranges::upper_bound(axis, at[k]) - axis.begin());
        low[k] = std::max<std::size_t>(above, 1) - 1;
        high[k] = std::min(above, axis.size() - 1);
        if (high[k] > low[k]) part[k] = (at[k] - axis[low[k]]) / (axis[high[k]] - axis[low[k]]);
    }
    double sum = 0;
    for (unsigned corner = 0; corner < 8; ++corner) {
        double weight = 1;
        std::array<std::size_t, 3> i{};
        for (std::size_t k = 0; k < 3; ++k) {
            const bool upper = (corner >> k & 1U) != 0;
            weight *= upper ? part[k] : 1 - part[k];
            i[k] = upper ? high[k] : low[k];
        }
        if (weight != 0) sum += weight * values_[(i[2] * axes_[1].size() + i[1]) * axes_[0].size() + i[0]];
    }
    return sum;
}

double GridTable::corner(double begin, double end, double shortest) const {
    const std::vector<double>&x = axes_[0], &y = axes_[1], &t = axes_[2];
    auto at = std::ranges::upper_bound(t, begin);
    if (at == t.end() || *at >= end) return end;
    const auto [low, high] = std::ranges::minmax(values_);
    const std::size_t n = x.size() * y.size();
    double farthest = 0, found = end;
    for (; at != t.end() && *at < end; ++at) {
        if (*at - begin < shortest) continue;
        const double part = (*at - begin) / (end - begin);
        for (std::size_t i = 0; i < n; ++i) {
            const auto value = [&](std::size_t k) { return values_[k * n + i]; };
            const std::size_t k = at - t.begin();
            const double here = x[i % x.size()], there = y[i / x.size()],
                         line = (1 - part) * (*this)(here, there, begin) + part * (*this)(here, there, end),
                         off = std::abs(value(k) - line);
            if (off > farthest && off > may_pass_over(t, k, value) * (high - low)) farthest = off, found = *at;
        }
    }
    return found;
}

}  // namespace knap
