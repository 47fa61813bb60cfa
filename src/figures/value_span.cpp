#include "figures/value_span.hpp"

#include <algorithm>

namespace knap {

ValueSpan span_of(std::vector<double> values, double outside) {
    std::erase_if(values, [](double v) { return !std::isfinite(v); });
    if (values.empty()) return {};
    std::sort(values.begin(), values.end());
    const auto skipped = static_cast<std::size_t>(outside * static_cast<double>(values.size()));
    return {.low = values[skipped], .high = values[values.size() - 1 - skipped], .least = values.front(), .most = values.back()};
}

ValueSpan joined(const ValueSpan& a, const ValueSpan& b) {
    return {.low = std::min(a.low, b.low), .high = std::max(a.high, b.high), .least = std::min(a.least, b.least), .most = std::max(a.most, b.most)};
}

}  // namespace knap
