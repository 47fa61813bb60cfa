#pragma once
#include "base/vec.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace knap {

/// The value that the part q of the values does not exceed, linear between two of them; NaN without values. Values that
/// are not finite do not count.
inline double quantile(std::vector<double> values, double q) {
    std::erase_if(values, [](double x) { return !std::isfinite(x); });
    if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
    std::ranges::sort(values);
    const double place = q * static_cast<double>(values.size() - 1);
    const std::size_t i = std::min(static_cast<std::size_t>(place), values.size() - 1),
                      j = std::min(i + 1, values.size() - 1);
    return values[i] + (place - static_cast<double>(i)) * (values[j] - values[i]);
}

}  // namespace knap
