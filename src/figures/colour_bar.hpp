#pragma once
// From numbers to colours, and the bar that says which is which.
#include "figures/colour_map.hpp"

#include <string>
#include <vector>

namespace knap {

struct ColourScale {
    ColourMap map;
    double low = 0, high = 1;             // SI
    bool more_below = false, more_above = false;  // there are values beyond the ends
    std::string quantity, unit;           // "opening", "m"; the prefix is found from the range
    bool about_zero = false;              // zero is the middle of the map, whatever the limits

    Colour operator()(double value) const;
};

struct ColourRange {
    double low = 0, high = 1;
};

/// Round limits round [low, high]; of signed values with zero, and symmetric about it where both signs reach far. One value alone gets a range round it.
ColourRange round_limits(double low, double high, bool is_signed);

/// A horizontal bar in the upper part of `area`, its numbers and name below it. Ends are pointed where there are values beyond.
void draw_colour_bar(Canvas& canvas, const ColourScale& scale, const Area& area);

}  // namespace knap
