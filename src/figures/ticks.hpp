#pragma once
// Round numbers along an axis, even or logarithmic, and units with a prefix.
#include <string>
#include <vector>

namespace knap {

/// Values are shown as value * factor, in `unit`: 3e6 Pa -> 3, "MPa".
struct DisplayUnit {
    double factor = 1;
    std::string unit;
};

/// The prefix that brings `largest` to 1 .. 1000. There is no km/s and no ks; a number without unit stays as it is.
DisplayUnit display_unit(double largest, const std::string& unit);

/// "crack length [mm]"
std::string with_unit(const std::string& quantity, const std::string& unit);

struct Ticks {
    std::vector<double> at;           // multiples of 1, 2, 2.5 or 5 times a power of ten, inside [low, high]
    std::vector<std::string> labels;  // all with the same number of decimals
    double step = 1;
};

/// At most `n_most` (at least 2) ticks; low < high.
Ticks round_ticks(double low, double high, int n_most);

/// [low, high] widened until it begins and ends with one of its own round_ticks; at least 3 (two never fit round zero).
std::vector<double> round_range(double low, double high, int n_most);

/// Ticks of a logarithmic axis over decimal exponents [low, high]: `at` are exponents. Over less than two decades 1, 2 and 5 times the
/// powers of ten, else powers alone, at most about eight.
Ticks logarithmic_ticks(double low, double high);

/// Exponents [low, high] widened to the next 1, 2 or 5 times a power of ten, or to the next power where that is more than two decades;
/// at least half a decade.
std::vector<double> logarithmic_range(double low, double high);

/// "20", "0.5": four digits at most.
std::string short_number(double value);

/// "40 µs", "117.5 µs": three digits, or four where the fourth matters (by 0.1 %), with a prefix. `plain` writes ASCII without a blank, for file names: "12.5us".
std::string time_text(double seconds, bool plain = false);

}  // namespace knap
