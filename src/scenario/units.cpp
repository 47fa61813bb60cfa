#include "scenario/units.hpp"

#include "base/text.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

namespace knap {
namespace {

struct Unit {
    std::string_view symbol;
    Dimension dimension;
    int power_of_ten;  // 1 symbol = factor * 10^power_of_ten in SI
    double factor;
    std::string_view prefixes;  // usual ones, the likelier of two that differ by case only first; "": takes none
};

constexpr Dimension length{.length = 1}, mass{.mass = 1}, time{.time = 1}, angle{.angle = 1},
    temperature{.temperature = 1};
constexpr Dimension force{.length = 1, .mass = 1, .time = -2}, pressure{.length = -1, .mass = 1, .time = -2};
constexpr Dimension energy{.length = 2, .mass = 1, .time = -2}, power{.length = 2, .mass = 1, .time = -3};

constexpr std::array units{
    Unit{"m", length, 0, 1, "mkcun"},
    Unit{"g", mass, -3, 1, "mkcun"},
    Unit{"t", mass, 3, 1, ""},
    Unit{"s", time, 0, 1, "mkcun"},
    Unit{"min", time, 0, 60, ""},
    Unit{"h", time, 0, 3600, ""},
    Unit{"day", time, 0, 86400, ""},
    Unit{"year", time, 0, 365.25 * 86400, ""},  // Julian
    Unit{"Hz", {.time = -1}, 0, 1, "MGkmu"},
    Unit{"N", force, 0, 1, "MGkmu"},
    Unit{"Pa", pressure, 0, 1, "MGkmu"},
    Unit{"bar", pressure, 5, 1, ""},
    Unit{"J", energy, 0, 1, "MGkmu"},
    Unit{"W", power, 0, 1, "MGkmu"},
    Unit{"deg", angle, 0, 1, ""},
    Unit{"rad", angle, 0, 180 / std::numbers::pi, ""},
    Unit{"K", temperature, 0, 1, "m"},
    Unit{"C", temperature, 0, 1, ""},  // degrees Celsius: another zero, which the reader of heat keeps apart
    Unit{"%", {}, -2, 1, ""},
    Unit{"cR", {.rayleigh = 1}, 0, 1, ""},
    Unit{"CFL", {.courant = 1}, 0, 1, ""},
};

constexpr std::pair<std::string_view, int> prefixes[] = {{"T", 12},      {"G", 9},  {"M", 6},  {"k", 3},
                                                         {"c", -2},      {"m", -3}, {"u", -6}, {"\u00b5", -6},
                                                         {"\u03bc", -6}, {"n", -9}, {"p", -12}};

/// Names of dimensions, by a unit.
// clang-format off
constexpr std::pair<std::string_view, std::string_view> kinds[] = {
    {"", "a plain number"}, {"m", "a length"}, {"m2", "an area"}, {"kg", "a mass"}, {"s", "a time"},
    {"deg", "an angle"}, {"deg/s", "an angular velocity"}, {"Hz", "a rate"}, {"m/s", "a speed"},
    {"m/s2", "an acceleration"}, {"N", "a force"}, {"Pa", "a pressure"}, {"J", "an energy"},
    {"J/m2", "an energy per area"}, {"N/m3", "a force per volume"}, {"kg/m3", "a density"}, {"W", "a power"},
    {"K", "a temperature"}, {"1/K", "an expansion per temperature"},
    {"W/m/K", "a conductivity of heat"},
    {"J/kg/K", "a heat capacity"}, {"J/kg", "a heat per mass"},
    {"W/m2", "a flux of heat"}, {"W/m3", "a source of heat"},
    {"W/m2/K", "a transfer coefficient of heat"},
    {"cR", "a multiple of the Rayleigh speed"}, {"CFL", "a multiple of the stable step"}};
// clang-format on

/// The base units, in the order in which a unit without a name is printed.
constexpr std::pair<const char*, int Dimension::*> base_units[] = {
    {"kg", &Dimension::mass},    {"m", &Dimension::length},      {"s", &Dimension::time},
    {"deg", &Dimension::angle},  {"K", &Dimension::temperature}, {"cR", &Dimension::rayleigh},
    {"CFL", &Dimension::courant}};

/// Common spellings that are not unit symbols, in small letters.
constexpr std::pair<std::string_view, std::string_view> misspellings[] = {
    {"sec", "s"},     {"second", "s"},   {"msec", "ms"},  {"usec", "us"},   {"micron", "um"},  {"meter", "m"},
    {"metre", "m"},   {"pascal", "Pa"},  {"newton", "N"}, {"joule", "J"},   {"degree", "deg"}, {"\u00b0", "deg"},
    {"hour", "h"},    {"minute", "min"}, {"tonne", "t"},  {"ton", "t"},     {"gram", "g"},     {"kilogram", "kg"},
    {"percent", "%"}, {"radian", "rad"}, {"cc", "cm3"},   {"kelvin", "K"},  {"degc", "C"},     {"celsius", "C"},
    {"\u00b0c", "C"}, {"day", "day"},    {"d", "day"},    {"year", "year"}, {"yr", "year"},    {"annum", "year"}};

/// Dimension of a unit expression such as kg/m3, and its value in SI: factor * 10^power_of_ten.
struct Scale {
    Dimension dimension;
    int power_of_ten = 0;
    double factor = 1;
};

std::optional<Scale> scale_of_symbol(std::string_view symbol) {
    for (const Unit& unit : units) {
        if (unit.symbol == symbol) return Scale{unit.dimension, unit.power_of_ten, unit.factor};
        if (unit.prefixes.empty() || !symbol.ends_with(unit.symbol)) continue;
        const std::string_view before = symbol.substr(0, symbol.size() - unit.symbol.size());
        for (const auto& [prefix, exponent] : prefixes)
            if (before == prefix) return Scale{unit.dimension, unit.power_of_ten + exponent, unit.factor};
    }
    return std::nullopt;
}

bool is_operator(char c) { return c == '/' || c == '*' || c == '.' || c == ' '; }
bool in_symbol(char c) { return !is_operator(c) && !(c >= '0' && c <= '9') && c != '^' && c != '-'; }

/// "J/m2", "kg m/s2", "N*s^-1", "1/K", "/s": factors, each a symbol and an exponent; a slash divides by the one factor
/// after it.
std::optional<Scale> scale_of(std::string_view text) {
    Scale scale;
    int sign = 1;
    if (text.starts_with("1/")) text.remove_prefix(1);
    if (text.starts_with('/')) {
        text = trimmed(text.substr(1)), sign = -1;
        if (text.empty()) return std::nullopt;
    }
    while (!text.empty()) {
        const std::size_t n = std::ranges::find_if_not(text, in_symbol) - text.begin();
        const std::optional<Scale> symbol = scale_of_symbol(text.substr(0, n));
        if (!symbol) return std::nullopt;
        text.remove_prefix(n);
        const bool caret = text.starts_with('^');
        if (caret) text.remove_prefix(1);
        int exponent = 1;
        if (caret || (!text.empty() && !is_operator(text.front()))) {
            const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), exponent);
            if (error != std::errc() || exponent == 0 || std::abs(exponent) > 9) return std::nullopt;
            text.remove_prefix(end - text.data());
        }
        exponent *= sign;
        for (const auto& [name, power] : base_units) scale.dimension.*power += exponent * (symbol->dimension.*power);
        scale.power_of_ten += exponent * symbol->power_of_ten;
        scale.factor *= std::pow(symbol->factor, exponent);
        if (text.empty()) return scale;
        if (!is_operator(text.front())) return std::nullopt;
        text = trimmed(text);
        sign = text.starts_with('/') ? -1 : 1;
        if (text.starts_with('/') || text.starts_with('*') || text.starts_with('.')) text = trimmed(text.substr(1));
        if (text.empty()) return std::nullopt;
    }
    return scale;
}

std::string_view without_plus(std::string_view text) {
    return text.substr(text.starts_with('+') && !text.starts_with("+-") ? 1 : 0);
}

/// The length of the number at the start of `text`, digits with a point and an exponent; 0 if there is none.
std::size_t read_number(std::string_view text, double& value) {
    const std::size_t first = std::min(text.find_first_not_of('-'), text.size());
    if (first == text.size() || std::isalpha(static_cast<unsigned char>(text[first]))) return 0;  // inf, nan
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc::invalid_argument ? 0 : end - text.data();
}

/// The double nearest to `decimal` * 10^power.
std::optional<double> shifted(std::string_view decimal, int power) {
    const std::size_t e = std::min(decimal.find_first_of("eE"), decimal.size());
    int exponent = 0;
    if (e < decimal.size()) {
        const std::string_view digits = without_plus(decimal.substr(e + 1));
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), exponent);
        if (error != std::errc() || std::abs(exponent) > 9999) return std::nullopt;
    }
    const std::string text = std::string(decimal.substr(0, e)) + "e" + std::to_string(exponent + power);
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() ? std::optional(value) : std::nullopt;
}

/// A regular expression of the symbols of each dimension.
std::vector<std::pair<Dimension, std::string>> symbol_patterns() {
    std::string letters, others;  // others: of two bytes
    for (const auto& [prefix, exponent] : prefixes) (prefix.size() == 1 ? letters : others += "|") += prefix;
    std::vector<std::pair<Dimension, std::string>> patterns;
    for (const Unit& unit : units) {
        auto found = std::ranges::find(patterns, unit.dimension, &std::pair<Dimension, std::string>::first);
        if (found == patterns.end()) found = patterns.insert(found, {unit.dimension, ""});
        found->second += (found->second.empty() ? "" : "|") +
                         (unit.prefixes.empty() ? "" : "(?:[" + letters + "]" + others + ")?") +
                         std::string(unit.symbol);
    }
    return patterns;
}

/// a^i b
Dimension product(const Dimension& a, int i, const Dimension& b) {
    Dimension found;
    for (const auto& [name, member] : base_units) found.*member = i * (a.*member) + b.*member;
    return found;
}

/// A regular expression of the ways to write `wanted` by `n` factors behind those of `before`, each way behind a "|";
/// "" where there is none. Their exponents have at most this `sum`; of three none takes back another, as in m s/s.
std::string products(const Dimension& wanted, int n, int sum, const std::vector<Dimension>& before = {}) {
    static const auto symbols = symbol_patterns();
    const bool is_first = before.empty();
    std::string ways;
    for (const auto& [dimension, pattern] : symbols)
        for (int exponent = n - 1 - sum; exponent <= sum - n + 1; ++exponent) {
            const Dimension rest = product(dimension, -exponent, wanted);
            const int sign = exponent > 0 ? 1 : -1;
            if (exponent == 0 || (dimension == Dimension{} && (!is_first || n > 2 || exponent != 1)) ||
                (n + before.size() > 2 && std::ranges::count(before, product(dimension, -sign, {})) > 0))
                continue;
            std::vector<Dimension> taken = before;
            taken.push_back(product(dimension, sign, {}));
            const std::string others = n > 1 ? products(rest, n - 1, sum - std::abs(exponent), taken) : "";
            if (n > 1 ? others.empty() : rest != Dimension{}) continue;
            const auto power = [&](int written) {
                return "(?:" + pattern + ")" + (written == 1 ? "(?:\\^?1)?" : "\\^?" + std::to_string(written));
            };
            ways += (is_first ? "|(?:" : "|(?:(?: *[*.] *| +)") + power(exponent) + (is_first ? "|1?/ *" : "| */ *") +
                    power(-exponent) + ")" + (n > 1 ? "(?:" + others.substr(1) + ")" : "");
        }
    return ways;
}

}  // namespace

Quantity parse_quantity(std::string_view text) {
    text = without_plus(trimmed(text));
    Quantity quantity;
    const std::size_t n = read_number(text, quantity.number);
    if (n == 0) return {.problem = "does not begin with a number"};
    quantity.unit = trimmed(text.substr(n));
    if (quantity.unit.starts_with(',')) {
        quantity.problem = "has a decimal comma; use a decimal point";
    } else if (const std::optional<Scale> scale = scale_of(quantity.unit); !scale) {
        quantity.unknown_unit = true;
        quantity.problem = "has the unknown unit `" + quantity.unit + "`";
    } else if (const std::optional<double> value = shifted(text.substr(0, n), scale->power_of_ten); !value) {
        quantity.problem = "is outside the range of numbers";
    } else {
        quantity.value = *value * scale->factor;
        quantity.dimension = scale->dimension;
    }
    return quantity;
}

std::string unit_suggestion(std::string_view unknown, std::string_view expected) {
    const auto suggest = [](const std::string& unit) { return "did you mean `" + unit + "`?"; };
    std::string text(unknown);
    for (const auto& [from, to] : {std::pair{"\u00b2", "2"}, {"\u00b3", "3"}, {"\u00b7", "*"}})
        for (std::size_t at; (at = text.find(from)) != std::string::npos;)
            text.replace(at, std::string_view(from).size(), to);
    if (scale_of(text)) return suggest(text);
    std::size_t begin = 0, end = 0;  // of the first unknown symbol
    do {
        begin = std::find_if(text.begin() + end, text.end(), in_symbol) - text.begin();
        end = std::find_if_not(text.begin() + begin, text.end(), in_symbol) - text.begin();
    } while (begin < text.size() && scale_of_symbol(std::string_view(text).substr(begin, end - begin)));
    std::string symbol = text.substr(begin, end - begin);
    if (symbol.empty()) return "";
    const auto with = [&](std::string_view other) {
        return text.substr(0, begin) + std::string(other) + text.substr(end);
    };
    std::string word = symbol;
    for (char& c : word) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    if (word.size() > 3 && word.ends_with('s')) word.pop_back();
    for (const auto& [written, unit] : misspellings)
        if (word == written && scale_of(with(unit))) return suggest(with(unit));
    std::vector<std::string> fitting, others;
    for (const Unit& unit : units)
        for (std::size_t i = 0; i <= unit.prefixes.size(); ++i) {
            const std::string candidate = (i > 0 ? std::string{unit.prefixes[i - 1]} : "") + std::string(unit.symbol);
            if (const std::optional<Scale> scale = scale_of(with(candidate)))
                (scale->dimension == dimension_of(expected) ? fitting : others).push_back(candidate);
        }
    const std::string* found = nearest(symbol, fitting);
    if (!found) found = nearest(symbol, others);
    return found ? suggest(with(*found)) : "";
}

std::string units_markdown() {
    std::string out = "| unit | quantity | value in SI | takes prefixes |\n|---|---|---|---|\n";
    for (const Unit& unit : units) {
        std::string si = unit.dimension == mass ? "kg" : "";
        for (const Unit& other : units)
            if (si.empty() && other.dimension == unit.dimension && other.power_of_ten == 0 && other.factor == 1)
                si = other.symbol;
        const std::string value = shortest(*shifted(shortest(unit.factor), unit.power_of_ten));
        out += "| `" + std::string(unit.symbol) + "` | " + kind_name(unit.dimension) + " | " + value +
               (si.empty() ? "" : " " + si) + " | " + (unit.prefixes.empty() ? "" : "yes") + " |\n";
    }
    std::vector<std::string> list;
    for (const auto& [prefix, exponent] : prefixes)
        list.push_back("`" + std::string(prefix) + "` 1e" + std::to_string(exponent));
    return out + "\nPrefixes: " + joined(list) +
           ". Units are combined by `/`, `*`, `.` or a blank, with whole exponents behind them: `J/m2`, `kg/m^3`, "
           "`N*s`, `mm/ms`, `m s-2`, `/s` or `1/s`, `1/day`.\n";
}

std::string quantity_pattern(std::string_view unit) {
    const std::string number = "^ *[-+]?(?:[0-9]+\\.?[0-9]*|\\.[0-9]+)(?:[eE][-+]?[0-9]+)?";
    if (unit == "*") return number;
    const Dimension wanted = dimension_of(unit);
    const std::string forms = products(wanted, 1, 3) + products(wanted, 2, 6) + products(wanted, 3, 5);
    return number + " *(?:" + forms.substr(1) + ")" + (wanted == Dimension{} ? "?" : "") + " *$";
}

Dimension dimension_of(std::string_view unit) { return scale_of(unit).value_or(Scale{}).dimension; }

std::string kind_name(const Dimension& dimension) {
    for (const auto& [unit, kind] : kinds)
        if (dimension_of(unit) == dimension) return std::string(kind);
    std::string name = "something in";
    for (const auto& [symbol, power] : base_units) {
        const int exponent = dimension.*power;
        if (exponent != 0) name += " " + std::string(symbol) + (exponent != 1 ? "^" + std::to_string(exponent) : "");
    }
    return name;
}

}  // namespace knap
