#pragma once
// Numbers in figures: ranges of values, round ticks along an axis, linear or logarithmic, units with an SI prefix.
#include "base/display_unit.hpp"

#include <cmath>
#include <string>
#include <vector>

namespace knap {

struct Limits {
    double low = 0, high = 1;
};

/// The range of a set of values, with and without outliers: the peak at a crack tip must not set the colours of a body.
struct ValueSpan {
    double low = INFINITY, high = -INFINITY;  // without outliers
    double min = INFINITY, max = -INFINITY;   // of all values
};
/// Span of all finite values; the fraction `outliers` of them is left out of [low, high] at either end.
ValueSpan span_of(std::vector<double> values, double outliers);
ValueSpan joined(const ValueSpan& a, const ValueSpan& b);

/// "crack length [mm]"; a pure number has no brackets.
std::string with_unit(const std::string& quantity, const std::string& unit);

struct Ticks {
    std::vector<double> at;           // inside the limits of the axis
    std::vector<std::string> labels;  // of a linear axis all with the same number of decimals
    double step = 1;                  // of a linear axis: 1, 2, 2.5 or 5 times a power of ten
};

/// At most max(max_ticks, 2) ticks; low < high.
Ticks round_ticks(double low, double high, int max_ticks);

/// The limits widened until both are among their own round_ticks with max(max_ticks, 3).
Limits round_range(double low, double high, int max_ticks);

/// Ticks of a logarithmic axis between two decimal exponents; `at` are exponents. Below two decades 1, 2 and 5 times
/// the powers of ten, otherwise about eight powers at most.
Ticks logarithmic_ticks(double low, double high);

/// Two decimal exponents at least half a decade apart, widened to the next 1, 2 or 5 times a power of ten; above two
/// decades to the next power.
Limits logarithmic_range(double low, double high);

/// "20", "0.5": at most four digits.
std::string short_number(double value);

/// "40 µs", "117.5 µs": three digits, or four where the fourth is more than 0.1 %. `plain`: "12.5us", for file names.
std::string time_text(double seconds, bool plain = false);

}  // namespace knap
