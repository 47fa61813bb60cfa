#include "base/display_unit.hpp"

#include "base/formatted.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace knap {

DisplayUnit display_unit(double largest, const std::string& unit) {
    constexpr std::array prefixes{"p", "n", "µ", "m", "", "k", "M", "G", "T"};  // 1e-12, 1e-9, ...
    // a prefix multiplies the first factor, which must be no power and have none of its own: 1e-3 m2 are not 1 mm2
    const std::string first = unit.substr(0, unit.find_first_of(" /"));
    const bool takes_prefix =
        first == "m" || first == "s" || first == "Pa" || first == "J" || first == "N" || first == "W";
    if (!takes_prefix || !(largest >= 1e-12)) return {1, unit};
    std::size_t i = unit.starts_with("m/s") || unit == "s" ? 4 : prefixes.size() - 1;
    const auto value = [&] { return std::pow(10, 3 * static_cast<int>(i) - 12); };
    while (i > 0 && largest < 0.9999 * value()) --i;
    return {1 / value(), prefixes[i] + unit};
}

namespace {

/// With so many digits, but "130" instead of "1.3e+02".
std::string rounded(double value, int digits) {
    const double size = std::abs(value);
    if (!(size >= std::pow(10, digits) - 0.5 && size < 1e6)) return formatted("%.*g", digits, value);
    const double last = std::pow(10, std::floor(std::log10(size)) + 1 - digits);
    return formatted("%.0f", last * std::round(value / last));
}

}  // namespace

std::string readable(double value, const std::string& unit, int digits) {
    struct Long {
        double size, from;  // [s]
        const char* name;
    };
    constexpr double hour = 3600, day = 24 * hour, year = 365.25 * day;
    const double size = std::abs(value), of_seconds = std::pow(10, digits > 6 ? digits : std::min(digits, 4));
    if (unit == "s" && size >= of_seconds && std::isfinite(size))
        for (const auto& [length, from, name] :
             {Long{year, 2 * year, "year"}, {day, day, "day"}, {hour, 2 * hour, "h"}, {60, 0, "min"}})
            if (size >= from) return formatted("%.*g ", digits, value / length) + name;
    const DisplayUnit shown = display_unit(size, unit);
    return rounded(value * shown.factor, digits) + (unit.empty() ? "" : " " + shown.unit);
}

}  // namespace knap
