#include "scenario/units.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace knap {
namespace {

struct Unit {
    std::string_view symbol;
    Dimension dimension;
    int power_of_ten;  // 1 symbol = factor * 10^power_of_ten in SI
    double factor;
    bool takes_prefix;
};

constexpr Dimension length{.length = 1}, mass{.mass = 1}, time{.time = 1}, angle{.angle = 1};
constexpr Dimension force{.length = 1, .mass = 1, .time = -2}, pressure{.length = -1, .mass = 1, .time = -2};
constexpr Dimension energy{.length = 2, .mass = 1, .time = -2}, power{.length = 2, .mass = 1, .time = -3};

constexpr std::array units{
    Unit{"m", length, 0, 1, true},
    Unit{"g", mass, -3, 1, true},
    Unit{"t", mass, 3, 1, false},
    Unit{"s", time, 0, 1, true},
    Unit{"min", time, 0, 60, false},
    Unit{"h", time, 0, 3600, false},
    Unit{"Hz", {.time = -1}, 0, 1, true},
    Unit{"N", force, 0, 1, true},
    Unit{"Pa", pressure, 0, 1, true},
    Unit{"bar", pressure, 5, 1, false},
    Unit{"J", energy, 0, 1, true},
    Unit{"W", power, 0, 1, true},
    Unit{"deg", angle, 0, 1, false},
    Unit{"rad", angle, 0, 180 / std::numbers::pi, false},
    Unit{"%", {}, -2, 1, false},
    Unit{"cR", {.rayleigh = 1}, 0, 1, false},
    Unit{"CFL", {.courant = 1}, 0, 1, false},
};

struct Prefix {
    std::string_view symbol;
    int power_of_ten;
};
constexpr std::array prefixes{Prefix{"T", 12},      Prefix{"G", 9},  Prefix{"M", 6},  Prefix{"k", 3},
                              Prefix{"c", -2},      Prefix{"m", -3}, Prefix{"u", -6}, Prefix{"\u00b5", -6},
                              Prefix{"\u03bc", -6}, Prefix{"n", -9}, Prefix{"p", -12}};

struct Names {
    Dimension dimension;
    std::string_view name;
};
constexpr std::array kinds{
    Names{{}, "a plain number"},
    Names{length, "a length"},
    Names{{.length = 2}, "an area"},
    Names{mass, "a mass"},
    Names{time, "a time"},
    Names{angle, "an angle"},
    Names{{.time = -1, .angle = 1}, "an angular velocity"},
    Names{{.time = -1}, "a rate"},
    Names{{.length = 1, .time = -1}, "a speed"},
    Names{{.length = 1, .time = -2}, "an acceleration"},
    Names{force, "a force"},
    Names{pressure, "a pressure"},
    Names{energy, "an energy"},
    Names{{.mass = 1, .time = -2}, "an energy per area"},
    Names{{.length = -2, .mass = 1, .time = -2}, "a force per volume"},
    Names{{.length = -3, .mass = 1}, "a density"},
    Names{power, "a power"},
    Names{{.rayleigh = 1}, "a multiple of the Rayleigh speed"},
    Names{{.courant = 1}, "a multiple of the stable step"},
};

/// A unit expression such as kg/m3: what it is and what one of it is in SI.
struct Scale {
    Dimension dimension;
    int power_of_ten = 0;
    double factor = 1;
};

std::optional<Scale> symbol_scale(std::string_view symbol) {
    for (const Unit& unit : units)
        if (unit.symbol == symbol) return Scale{unit.dimension, unit.power_of_ten, unit.factor};
    for (const Prefix& prefix : prefixes) {
        if (!symbol.starts_with(prefix.symbol)) continue;
        for (const Unit& unit : units)
            if (unit.takes_prefix && symbol.substr(prefix.symbol.size()) == unit.symbol)
                return Scale{unit.dimension, unit.power_of_ten + prefix.power_of_ten, unit.factor};
    }
    return std::nullopt;
}

/// The base units, in the order in which a unit without a name of its own is printed.
constexpr std::array<std::pair<const char*, int Dimension::*>, 6> base_units{{{"kg", &Dimension::mass},
                                                                              {"m", &Dimension::length},
                                                                              {"s", &Dimension::time},
                                                                              {"deg", &Dimension::angle},
                                                                              {"cR", &Dimension::rayleigh},
                                                                              {"CFL", &Dimension::courant}}};

void multiply(Scale& scale, const Scale& by, int exponent) {
    for (const auto& [symbol, power] : base_units) scale.dimension.*power += exponent * (by.dimension.*power);
    scale.power_of_ten += exponent * by.power_of_ten;
    scale.factor *= std::pow(by.factor, exponent);
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool joins(char c) { return c == '/' || c == '*' || c == '.' || c == ' '; }
bool in_symbol(char c) { return !joins(c) && !is_digit(c) && c != '^' && c != '-'; }

/// One factor of a unit expression, "mm3" or "s^-2", taken off the front of `text`.
bool multiply_factor(Scale& scale, std::string_view& text, bool divide) {
    std::size_t n = 0;
    while (n < text.size() && in_symbol(text[n])) ++n;
    const std::optional<Scale> symbol = symbol_scale(text.substr(0, n));
    if (!symbol) return false;
    text.remove_prefix(n);
    const bool caret = text.starts_with('^');
    if (caret) text.remove_prefix(1);
    int exponent = 1;
    if (caret || (!text.empty() && !joins(text.front()))) {
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), exponent);
        if (error != std::errc() || exponent == 0 || std::abs(exponent) > 9) return false;
        text.remove_prefix(end - text.data());
    }
    multiply(scale, *symbol, divide ? -exponent : exponent);
    return text.empty() || joins(text.front());
}

/// "J/m2", "kg m/s2", "N*s"; a slash divides by the one factor after it.
std::optional<Scale> unit_scale(std::string_view text) {
    Scale scale;
    bool divide = false, first = true;
    while (!text.empty()) {
        if (!first) {
            while (text.starts_with(' ')) text.remove_prefix(1);
            divide = text.starts_with('/');
            if (divide || text.starts_with('*') || text.starts_with('.')) text.remove_prefix(1);
            while (text.starts_with(' ')) text.remove_prefix(1);
        }
        first = false;
        if (!multiply_factor(scale, text, divide)) return std::nullopt;
    }
    return scale;
}

/// Length of the number at the front of `text`: digits, a point, an exponent.
std::size_t number_length(std::string_view text) {
    const auto digits_from = [&](std::size_t n) {
        return std::min(text.find_first_not_of("0123456789", n), text.size());
    };
    const auto after_sign = [&](std::size_t n) {
        return n < text.size() && (text[n] == '+' || text[n] == '-') ? n + 1 : n;
    };
    const std::size_t begin = after_sign(0), end = std::min(text.find_first_not_of("0123456789.", begin), text.size());
    if (text.substr(begin, end - begin).find_first_not_of('.') == std::string_view::npos) return 0;
    if (end == text.size() || (text[end] != 'e' && text[end] != 'E')) return end;
    const std::size_t exponent = after_sign(end + 1);
    return digits_from(exponent) > exponent ? digits_from(exponent) : end;
}

std::string_view without_plus(std::string_view text) { return text.substr(text.starts_with('+') ? 1 : 0); }

/// The double nearest to `decimal` * 10^power.
std::optional<double> shifted(std::string_view decimal, int power) {
    const auto read = [](std::string_view text, auto& value) {
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        return error == std::errc() && end == text.data() + text.size();
    };
    const std::size_t e = decimal.find_first_of("eE");
    int exponent = 0;
    if (e != std::string_view::npos && !read(without_plus(decimal.substr(e + 1)), exponent)) return std::nullopt;
    if (std::abs(exponent) > 9999) return std::nullopt;
    const std::string text = std::string(without_plus(decimal.substr(0, e))) + "e" + std::to_string(exponent + power);
    double value = 0;
    return read(text, value) ? std::optional(value) : std::nullopt;
}

}  // namespace

Quantity parse_quantity(std::string_view text) {
    text = trimmed(text);
    const std::size_t n = number_length(text);
    if (n == 0) return {.problem = "does not begin with a number"};
    const std::string_view number = text.substr(0, n), unit = trimmed(text.substr(n));
    Quantity quantity{.unit = std::string(unit)};
    if (unit.starts_with(',')) {
        quantity.problem = "has a comma where a decimal point belongs";
        return quantity;
    }
    const std::optional<Scale> scale = unit_scale(unit);
    quantity.unknown_unit = !scale;
    const std::optional<double> value = scale ? shifted(number, scale->power_of_ten) : std::nullopt;
    if (!scale) quantity.problem = "has the unknown unit `" + quantity.unit + "`";
    else if (!value) quantity.problem = "is not a number that can be stored";
    if (!value) return quantity;
    quantity.value = *value * scale->factor;
    quantity.dimension = scale->dimension;
    return quantity;
}

namespace {

/// Prefixes that are usual with a unit, the likelier of two that differ by case only first.
std::vector<std::string_view> usual_prefixes(const Unit& unit) {
    if (!unit.takes_prefix) return {""};
    if (unit.dimension == length || unit.dimension == mass || unit.dimension == time)
        return {"", "m", "k", "c", "u", "n"};
    return {"", "M", "G", "k", "m", "u"};
}

/// Words for units that are not theirs.
std::string_view unit_of_word(std::string word) {
    for (char& c : word) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    if (word.size() > 3 && word.ends_with('s')) word.pop_back();
    constexpr std::array<std::pair<std::string_view, std::string_view>, 21> words{
        {{"sec", "s"},      {"second", "s"},   {"msec", "ms"},     {"usec", "us"},    {"micron", "um"},
         {"meter", "m"},    {"metre", "m"},    {"pascal", "Pa"},   {"newton", "N"},   {"joule", "J"},
         {"degree", "deg"}, {"\u00b0", "deg"}, {"hour", "h"},      {"minute", "min"}, {"tonne", "t"},
         {"ton", "t"},      {"gram", "g"},     {"kilogram", "kg"}, {"percent", "%"},  {"radian", "rad"},
         {"cc", "cm3"}}};
    for (const auto& [written, meant] : words)
        if (word == written) return meant;
    return "";
}

std::string with_plain_powers(std::string text) {
    for (const auto& [from, to] : {std::pair{"\u00b2", "2"}, {"\u00b3", "3"}, {"\u00b7", "*"}})
        for (std::size_t at; (at = text.find(from)) != std::string::npos;)
            text.replace(at, std::string_view(from).size(), to);
    return text;
}

std::string asked(const std::string& unit) { return "did you mean `" + unit + "`?"; }

}  // namespace

std::string unit_meant(std::string_view unknown, std::string_view wanted) {
    const std::string text = with_plain_powers(std::string(unknown));
    if (unit_scale(text)) return asked(text);
    std::size_t begin = 0, end = 0;  // of the first symbol that is not known
    do {
        begin = end;
        while (begin < text.size() && !in_symbol(text[begin])) ++begin;
        for (end = begin; end < text.size() && in_symbol(text[end]);) ++end;
    } while (begin < text.size() && symbol_scale(text.substr(begin, end - begin)));
    const std::string symbol = text.substr(begin, end - begin);
    if (symbol.empty()) return "";
    const auto with = [&](std::string_view instead) {
        return text.substr(0, begin) + std::string(instead) + text.substr(end);
    };
    if (const std::string_view meant = unit_of_word(symbol); !meant.empty() && unit_scale(with(meant)))
        return asked(with(meant));
    std::vector<std::string> fitting, others;
    for (const Unit& unit : units)
        for (const std::string_view prefix : usual_prefixes(unit)) {
            const std::string candidate = std::string(prefix) + std::string(unit.symbol);
            const std::optional<Scale> scale = unit_scale(with(candidate));
            if (scale) (scale->dimension == dimension_of(wanted) ? fitting : others).push_back(candidate);
        }
    const std::string* meant = nearest(symbol, fitting);
    if (!meant) meant = nearest(symbol, others);
    return meant ? asked(with(*meant)) : "";
}

std::string units_markdown() {
    std::string out = "| unit | is | 1 of it in SI | takes prefixes |\n|---|---|---|---|\n";
    for (const Unit& unit : units) {
        std::string si = unit.dimension == mass ? "kg" : "";
        for (const Unit& other : units)
            if (si.empty() && other.dimension == unit.dimension && other.power_of_ten == 0 && other.factor == 1)
                si = other.symbol;
        const std::string value = shortest(*shifted(shortest(unit.factor), unit.power_of_ten));
        out += "| `" + std::string(unit.symbol) + "` | " + kind_name(unit.dimension) + " | " + value +
               (si.empty() ? "" : " " + si);
        out += std::string(" | ") + (unit.takes_prefix ? "yes" : "") + " |\n";
    }
    out += "\nPrefixes: ";
    for (const Prefix& prefix : prefixes)
        out += (prefix.symbol == prefixes.front().symbol ? "`" : ", `") + std::string(prefix.symbol) + "` 1e" +
               std::to_string(prefix.power_of_ten);
    return out +
           ". Units are joined by `/`, `*`, `.` or a blank and raised by a whole number behind them: `J/m2`, `kg/m^3`, "
           "`N*s`, `mm/ms`, `m s-2`.\n";
}

Dimension dimension_of(std::string_view unit) {
    const std::optional<Scale> scale = unit_scale(unit);
    return scale ? scale->dimension : Dimension{};
}

std::string kind_name(const Dimension& dimension) {
    for (const Names& kind : kinds)
        if (kind.dimension == dimension) return std::string(kind.name);
    std::string name = "something in";
    for (const auto& [symbol, power] : base_units) {
        const int exponent = dimension.*power;
        if (exponent != 0) name += " " + std::string(symbol) + (exponent != 1 ? "^" + std::to_string(exponent) : "");
    }
    return name;
}

}  // namespace knap
