#include "app/convergence.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace knap {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

bool counts(double error) { return std::isfinite(error) && error > 0; }

}  // namespace

double observed_order(double h_coarse, double error_coarse, double h_fine, double error_fine) {
    if (!counts(error_coarse) || !counts(error_fine) || h_coarse == h_fine) return unknown;
    return std::log(error_coarse / error_fine) / std::log(h_coarse / h_fine);
}

double fitted_order(const std::vector<double>& h, const std::vector<double>& error) {
    double n = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (std::size_t i = 0; i < h.size(); ++i) {
        if (!counts(error[i])) continue;
        const double a = std::log(h[i]), b = std::log(error[i]);
        n += 1, x += a, y += b, xx += a * a, xy += a * b;
    }
    const double spread = n * xx - x * x;
    return n >= 2 && spread > 1e-12 * n * xx ? (n * xy - x * y) / spread : unknown;
}

Trend trend_of(const std::vector<double>& gaps) {
    std::vector<double> known;
    std::copy_if(gaps.begin(), gaps.end(), std::back_inserter(known), [](double gap) { return std::isfinite(gap); });
    if (known.empty()) return Trend::unknown;
    if (std::all_of(known.begin(), known.end(), [](double gap) { return gap == 0; })) return Trend::same;
    if (known.size() < 2) return Trend::unknown;
    for (std::size_t i = 1; i < known.size(); ++i)
        if (known[i] > 0 && known[i] >= known[i - 1]) return Trend::does_not_fall;
    return Trend::falls;
}

std::optional<Extrapolation> extrapolate(double ratio, double coarse, double middle, double fine) {
    // q(rh) - q(h) = C h^p (r^p - 1), so two differences in a row are in the ratio r^p
    const double p = std::log((coarse - middle) / (middle - fine)) / std::log(ratio);
    if (!std::isfinite(p) || p <= 0) return std::nullopt;
    return Extrapolation{p, fine + (fine - middle) / (std::pow(ratio, p) - 1)};
}

std::optional<Extrapolation> extrapolate(const std::vector<double>& h, const std::vector<double>& value) {
    const auto of_three = [&](std::size_t last) -> std::optional<Extrapolation> {
        const double ratio = h[last - 1] / h[last];
        if (std::abs(h[last - 2] / h[last - 1] - ratio) > 0.05 * ratio) return std::nullopt;
        return extrapolate(ratio, value[last - 2], value[last - 1], value[last]);
    };
    const std::size_t n = h.size();
    if (n < 3) return std::nullopt;
    std::vector<double> gaps;
    for (std::size_t i = 1; i < n; ++i) gaps.push_back(std::abs(value[i] - value[i - 1]));
    const auto found = of_three(n - 1);
    if (!found || found->order < 0.5 || found->order > 3 || trend_of(gaps) != Trend::falls) return std::nullopt;
    if (n == 3) return found;
    const auto before = of_three(n - 2);
    if (!before || std::abs(before->order - found->order) > 0.3) return std::nullopt;
    return found;
}

Spread spread_of(const std::vector<double>& values) {
    std::vector<double> sample;
    std::copy_if(values.begin(), values.end(), std::back_inserter(sample), [](double v) { return std::isfinite(v); });
    if (sample.empty()) return {0, unknown, unknown, unknown, unknown};
    const double n = static_cast<double>(sample.size());
    double sum = 0, squares = 0;
    for (const double v : sample) sum += v;
    for (const double v : sample) squares += (v - sum / n) * (v - sum / n);
    const auto [low, high] = std::minmax_element(sample.begin(), sample.end());
    return {static_cast<int>(sample.size()), sum / n, n > 1 ? std::sqrt(squares / (n - 1)) : 0, *low, *high};
}

}  // namespace knap
