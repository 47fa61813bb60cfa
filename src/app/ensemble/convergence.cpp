#include "app/ensemble/convergence.hpp"

#include <algorithm>
#include <numeric>

namespace knap {
namespace {

std::vector<double> finite(std::vector<double> values) {
    std::erase_if(values, [](double v) { return !std::isfinite(v); });
    return values;
}

double mean(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Through the value `last` and the two before it.
std::optional<Extrapolation> extrapolate_three(const std::vector<double>& h, const std::vector<double>& value,
                                               std::size_t last) {
    const double ratio = h[last - 1] / h[last], coarse = value[last - 2], middle = value[last - 1], fine = value[last];
    if (std::abs(h[last - 2] / h[last - 1] - ratio) > 0.05 * ratio) return std::nullopt;
    // q(rh) - q(h) = C h^p (r^p - 1): two successive differences have the ratio r^p
    const double p = std::log((coarse - middle) / (middle - fine)) / std::log(ratio);
    if (!std::isfinite(p) || p <= 0) return std::nullopt;
    return Extrapolation{p, fine + (fine - middle) / (std::pow(ratio, p) - 1)};
}

}  // namespace

Spread spread_of(const std::vector<double>& values) {
    const std::vector<double> sample = finite(values);
    if (sample.empty()) return {};
    const double m = mean(sample), n = static_cast<double>(sample.size());
    double squares = 0;
    for (const double v : sample) squares += (v - m) * (v - m);
    const auto [low, high] = std::ranges::minmax(sample);
    return {static_cast<int>(sample.size()), m, n > 1 ? std::sqrt(squares / (n - 1)) : 0, low, high};
}

double least_squares_slope(const std::vector<double>& x, const std::vector<double>& y) {
    const double mean_x = mean(x), mean_y = mean(y);
    double xx = 0, xy = 0;
    for (std::size_t i = 0; i < x.size(); ++i)
        xx += (x[i] - mean_x) * (x[i] - mean_x), xy += (x[i] - mean_x) * (y[i] - mean_y);
    const bool differ = xx > 1e-24 * static_cast<double>(x.size()) * mean_x * mean_x;  // by more than rounding
    return x.size() > 1 && differ ? xy / xx : NAN;
}

double observed_order(double h_coarse, double error_coarse, double h_fine, double error_fine) {
    const double order = std::log(error_coarse / error_fine) / std::log(h_coarse / h_fine);
    return std::isfinite(order) ? order : NAN;
}

double fitted_order(const std::vector<double>& h, const std::vector<double>& error) {
    std::vector<double> x, y;
    for (std::size_t i = 0; i < h.size(); ++i)
        if (std::isfinite(error[i]) && error[i] > 0) x.push_back(std::log(h[i])), y.push_back(std::log(error[i]));
    return least_squares_slope(x, y);
}

Trend trend_of(const std::vector<double>& gaps) {
    const std::vector<double> known = finite(gaps);
    if (!known.empty() && std::ranges::all_of(known, [](double gap) { return gap == 0; })) return Trend::same;
    if (known.size() < 2) return Trend::unknown;
    for (std::size_t i = 1; i < known.size(); ++i)
        if (known[i] > 0 && known[i] >= known[i - 1]) return Trend::does_not_fall;
    return Trend::falls;
}

std::optional<Extrapolation> extrapolate(const std::vector<double>& h, const std::vector<double>& value) {
    const std::size_t n = h.size();
    if (n < 3) return std::nullopt;
    std::vector<double> gaps;
    for (std::size_t i = 1; i < n; ++i) gaps.push_back(std::abs(value[i] - value[i - 1]));
    const auto found = extrapolate_three(h, value, n - 1);
    if (!found || found->order < 0.5 || found->order > 3 || trend_of(gaps) != Trend::falls) return std::nullopt;
    if (n == 3) return found;
    const auto before = extrapolate_three(h, value, n - 2);
    return before && std::abs(before->order - found->order) <= 0.3 ? found : std::nullopt;
}

}  // namespace knap
