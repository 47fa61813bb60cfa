#include "figures/ticks.hpp"

#include "base/text.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace knap {
namespace {

constexpr double slack = 1e-9;  // of rounding, relative to a step or a decade

/// With an exponent where fixed notation would need more digits than a double has.
std::string fixed(double value, int decimals) {
    if (std::abs(value) >= 1e15 || decimals > 30) return short_number(value);
    return decimal(value, std::chars_format::fixed, decimals);
}

/// The smallest round number not below `value`.
double round_up(double value) {
    const double power = std::pow(10, std::floor(std::log10(value)));
    for (const double digit : {1.0, 2.0, 2.5, 5.0})
        if (value <= digit * power * (1 + slack)) return digit * power;
    return 10 * power;
}

int decimals_of(double step) {
    int decimals = 0;
    for (double scaled = step; decimals < 12 && std::abs(scaled - std::round(scaled)) > 1e-6 * scaled; scaled *= 10)
        ++decimals;
    return decimals;
}

/// With a minus sign as wide as a plus sign, and without minus zero.
std::string label(double value, int decimals) {
    const std::string text = fixed(std::abs(value), decimals);
    const bool zero = text.find_first_not_of("0.") == text.npos;
    return value < 0 && !zero ? "−" + text : text;
}

/// "0.02", "500", or with a superscript exponent "2·10⁵".
std::string power_label(double digit, int exponent, bool superscript) {
    if (!superscript) return fixed(digit * std::pow(10, exponent), std::max(-exponent, 0));
    constexpr std::array<const char*, 10> digits{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    std::string text = (digit == 1 ? "" : fixed(digit, 0) + "·") + "10" + (exponent < 0 ? "⁻" : "");
    for (const char c : std::to_string(std::abs(exponent))) text += digits[static_cast<std::size_t>(c - '0')];
    return text;
}

}  // namespace

ValueSpan span_of(std::vector<double> values, double outliers) {
    std::erase_if(values, [](double v) { return !std::isfinite(v); });
    if (values.empty()) return {};
    std::ranges::sort(values);
    const auto skipped = static_cast<std::size_t>(outliers * static_cast<double>(values.size()));
    return {values[skipped], values[values.size() - 1 - skipped], values.front(), values.back()};
}

ValueSpan joined(const ValueSpan& a, const ValueSpan& b) {
    return {std::min(a.low, b.low), std::max(a.high, b.high), std::min(a.min, b.min), std::max(a.max, b.max)};
}

std::string with_unit(const std::string& quantity, const std::string& unit) {
    return unit.empty() ? quantity : quantity + " [" + unit + "]";
}

Ticks round_ticks(double low, double high, int max_ticks) {
    const int n = std::max(max_ticks, 2);
    Ticks ticks;
    double first = 0, last = n;
    for (double step = (high - low) / n; last - first + 1 > n; step = 1.01 * ticks.step) {
        ticks.step = round_up(step);
        first = std::ceil((low - slack * (high - low)) / ticks.step);
        last = std::floor((high + slack * (high - low)) / ticks.step);
    }
    for (double i = first; i <= last; ++i) {
        ticks.at.push_back(i * ticks.step);
        ticks.labels.push_back(label(i * ticks.step, decimals_of(ticks.step)));
    }
    return ticks;
}

Limits round_range(double low, double high, int max_ticks) {
    max_ticks = std::max(max_ticks, 3);  // two may not fit on both sides of zero
    // wider limits may need a larger step, and that still wider limits
    for (double step = 0, next = round_ticks(low, high, max_ticks).step; next > step;) {
        step = next;
        low = step * std::floor(low / step + slack);
        high = step * std::ceil(high / step - slack);
        next = round_ticks(low, high, max_ticks).step;
    }
    return {low, high};
}

Ticks logarithmic_ticks(double low, double high) {
    const bool only_powers = high - low >= 2, superscript = low < -3 - slack || high > 4 + slack;
    const int stride = std::max(1, static_cast<int>(std::ceil((high - low) / 8)));
    Ticks ticks;
    for (int exponent = static_cast<int>(std::floor(low)); exponent <= high + slack; ++exponent)
        for (const double digit : {1, 2, 5}) {
            const double at = exponent + std::log10(digit);
            if (only_powers && (digit != 1 || exponent % stride != 0)) continue;
            if (at < low - slack || at > high + slack) continue;
            ticks.at.push_back(at);
            ticks.labels.push_back(power_label(digit, exponent, superscript));
        }
    return ticks;
}

Limits logarithmic_range(double low, double high) {
    if (high - low < 0.5) {
        const double middle = 0.5 * (low + high);
        low = middle - 0.25, high = middle + 0.25;
    }
    Limits range{std::floor(low + slack), std::ceil(high - slack)};
    if (high - low > 2) return range;
    const double below = range.low, above = range.high - 1;
    for (const double digit : {2., 5.})
        if (below + std::log10(digit) <= low + slack) range.low = below + std::log10(digit);
    for (const double digit : {5., 2.})
        if (above + std::log10(digit) >= high - slack) range.high = above + std::log10(digit);
    return range;
}

std::string short_number(double value) { return decimal(value, std::chars_format::general, 4); }

std::string time_text(double seconds, bool plain) {
    const DisplayUnit shown = display_unit(std::abs(seconds), "s");
    const double value = seconds * shown.factor;
    const int before_point = value == 0 ? 3 : 1 + static_cast<int>(std::floor(std::log10(std::abs(value))));
    const double last_digit = std::pow(10, before_point - 3), three = std::round(value / last_digit) * last_digit;
    const int n_digits = std::abs(three - value) <= 1e-3 * std::abs(value) ? 3 : 4;
    std::string number = fixed(value, std::max(n_digits - before_point, 0));
    if (number.find('.') != number.npos) {
        number.erase(number.find_last_not_of('0') + 1);
        if (number.back() == '.') number.pop_back();
    }
    if (!plain) return number + " " + shown.unit;
    return number + (shown.unit == "µs" ? "us" : shown.unit);
}

}  // namespace knap
