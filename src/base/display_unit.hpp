#pragma once
// Numbers with an SI prefix, as figures and messages show them.
#include <string>

namespace knap {

/// Values are shown as value * factor in `unit`: 3e6 Pa -> 3, "MPa".
struct DisplayUnit {
    double factor = 1;
    std::string unit;
};

/// The unit with the prefix that brings `largest` into 1 .. 1000. There are no km/s and no ks; units that take no
/// prefix, as m2 or kg, and values too small for any stay as they are.
DisplayUnit display_unit(double largest, const std::string& unit);

/// "12.5 mm", "30 day": with its prefix and at most so many digits; long times, which have
/// more digits in seconds, in min, h, day or year, but exact ones (more than six digits) in seconds.
std::string readable(double value, const std::string& unit, int digits = 3);

}  // namespace knap
