#include "figures/ticks.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace knap {

namespace {

struct Prefix {
    double value;
    const char* symbol;
};
constexpr std::array<Prefix, 9> prefixes{{{1e12, "T"}, {1e9, "G"}, {1e6, "M"}, {1e3, "k"}, {1, ""}, {1e-3, "m"}, {1e-6, "µ"}, {1e-9, "n"}, {1e-12, "p"}}};

/// With so many decimals; with an exponent where these would be more digits than a double has, or would fill the page.
std::string fixed(double value, int decimals) {
    if (std::abs(value) >= 1e15 || decimals > 30) return short_number(value);
    char text[64];
    const auto end = std::to_chars(text, text + sizeof text, value, std::chars_format::fixed, decimals).ptr;
    return {text, end};
}

/// The smallest round number that is not below `value`.
double round_up(double value) {
    const double power = std::pow(10, std::floor(std::log10(value)));
    for (const double digit : {1.0, 2.0, 2.5, 5.0})
        if (value <= digit * power * (1 + 1e-9)) return digit * power;
    return 10 * power;
}

int decimals_of(double step) {
    int decimals = 0;
    for (double scaled = step; decimals < 12 && std::abs(scaled - std::round(scaled)) > 1e-6 * scaled; scaled *= 10) ++decimals;
    return decimals;
}

/// With a minus sign of the width of a plus sign, and no minus zero.
std::string label(double value, int decimals) {
    const std::string text = fixed(std::abs(value), decimals);
    const bool zero = text.find_first_not_of("0.") == std::string::npos;
    return value < 0 && !zero ? "−" + text : text;
}

}  // namespace

DisplayUnit display_unit(double largest, const std::string& unit) {
    if (unit.empty() || !(largest > 0)) return {1, unit};
    for (const Prefix& prefix : prefixes) {
        if ((unit == "m/s" || unit == "s") && prefix.value > 1) continue;
        if (largest >= 0.9999 * prefix.value) return {1 / prefix.value, prefix.symbol + unit};
    }
    return {1 / prefixes.back().value, prefixes.back().symbol + unit};
}

std::string with_unit(const std::string& quantity, const std::string& unit) { return unit.empty() ? quantity : quantity + " [" + unit + "]"; }

Ticks round_ticks(double low, double high, int n_most) {
    const int n = std::max(n_most, 2);
    const double slack = 1e-9 * (high - low);
    Ticks ticks;
    ticks.step = round_up((high - low) / n);
    double first = std::ceil((low - slack) / ticks.step), last = std::floor((high + slack) / ticks.step);
    if (last - first + 1 > n) {
        ticks.step = round_up(1.01 * ticks.step);
        first = std::ceil((low - slack) / ticks.step), last = std::floor((high + slack) / ticks.step);
    }
    for (double i = first; i <= last; ++i) {
        ticks.at.push_back(i * ticks.step);
        ticks.labels.push_back(label(i * ticks.step, decimals_of(ticks.step)));
    }
    return ticks;
}

std::vector<double> round_range(double low, double high, int n_most) {
    n_most = std::max(n_most, 3);
    // widening can ask for a larger step, which can ask for more widening
    for (double step = 0, next = round_ticks(low, high, n_most).step; next > step;) {
        step = next;
        low = step * std::floor(low / step + 1e-9);
        high = step * std::ceil(high / step - 1e-9);
        next = round_ticks(low, high, n_most).step;
    }
    return {low, high};
}

namespace {

constexpr std::array<double, 3> digits{1, 2, 5};

/// "0.02", "500", or with a raised exponent.
std::string power_label(double digit, int exponent, bool raise) {
    if (!raise) return fixed(digit * std::pow(10, exponent), std::max(-exponent, 0));
    constexpr std::array<const char*, 10> raised{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    std::string text = (digit == 1 ? "" : fixed(digit, 0) + "·") + "10" + (exponent < 0 ? "⁻" : "");
    for (const char c : std::to_string(std::abs(exponent))) text += raised[c - '0'];
    return text;
}

}  // namespace

Ticks logarithmic_ticks(double low, double high) {
    const bool powers_alone = high - low >= 2;
    const int stride = std::max(1, static_cast<int>(std::ceil((high - low) / 8)));
    const bool raise = low < -3 - 1e-9 || high > 4 + 1e-9;
    Ticks ticks;
    for (int exponent = static_cast<int>(std::floor(low)); exponent <= high + 1e-9; ++exponent) {
        if (powers_alone && exponent % stride != 0) continue;
        for (const double digit : digits) {
            const double at = exponent + std::log10(digit);
            if ((powers_alone && digit != 1) || at < low - 1e-9 || at > high + 1e-9) continue;
            ticks.at.push_back(at);
            ticks.labels.push_back(power_label(digit, exponent, raise));
        }
    }
    return ticks;
}

std::vector<double> logarithmic_range(double low, double high) {
    if (high - low < 0.5) {
        const double middle = 0.5 * (low + high);
        low = middle - 0.25, high = middle + 0.25;
    }
    const double power_low = std::floor(low + 1e-9), power_high = std::ceil(high - 1e-9);
    if (high - low > 2) return {power_low, power_high};
    double below = power_low, above = power_high;
    for (const double digit : {2.0, 5.0})
        if (power_low + std::log10(digit) <= low + 1e-9) below = power_low + std::log10(digit);
    for (const double digit : {5.0, 2.0})
        if (power_high - 1 + std::log10(digit) >= high - 1e-9) above = power_high - 1 + std::log10(digit);
    return {below, above};
}

std::string short_number(double value) {
    char text[64];
    const auto end = std::to_chars(text, text + sizeof text, value, std::chars_format::general, 4).ptr;
    return {text, end};
}

std::string time_text(double seconds, bool plain) {
    const DisplayUnit shown = display_unit(std::abs(seconds), "s");
    const double value = seconds * shown.factor;
    const int before = value == 0 ? 3 : 1 + static_cast<int>(std::floor(std::log10(std::abs(value))));  // digits before the point
    const double hundreds = std::pow(10, before - 3), three = std::round(value / hundreds) * hundreds;
    const int n_digits = std::abs(three - value) <= 1e-3 * std::abs(value) ? 3 : 4;
    std::string number = fixed(value, std::max(n_digits - before, 0));
    if (number.find('.') != std::string::npos) {
        number.erase(number.find_last_not_of('0') + 1);
        if (number.back() == '.') number.pop_back();
    }
    if (!plain) return number + " " + shown.unit;
    return number + (shown.unit == "µs" ? "us" : shown.unit);
}

}  // namespace knap
