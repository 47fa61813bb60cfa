#pragma once
// Colours of curves and of values: palette, colour maps, and the range of values that a map covers.
#include "figures/canvas.hpp"
#include "figures/ticks.hpp"

#include <cstdint>
#include <span>

namespace knap {

/// The i-th colour of curves: M. Okabe, K. Ito, "Color universal design" (2008), distinct for colour-blind readers,
/// too. After n_curve_colours they repeat with the next line pattern curve_dash(i).
Colour curve_colour(std::size_t i);
inline constexpr std::size_t n_curve_colours = 6;
inline int curve_dash(std::size_t i) { return static_cast<int>(i / n_curve_colours % n_line_patterns); }
/// Points of an experiment: crosses hide little of what they are compared with.
inline constexpr Colour measured_colour{0.02, 0.45, 0.10};
inline constexpr Marker measured_marker = Marker::cross;

/// Maps [0, 1] to colours whose lightness changes evenly; values outside have the colour of the nearer end.
struct ColourMap {
    std::span<const std::uint32_t> colours;  // 0xRRGGBB, evenly spaced, linear in between
    Colour operator()(double x) const;

    // S. van der Walt, N. Smith, viridis and plasma (2015), CC0; plasma without its yellow end, too light for lines
    static const ColourMap viridis, plasma;
    static const ColourMap fading;     // from dark purple through red to the grey of an undamaged body
    static const ColourMap diverging;  // from blue through nearly white to red
};

/// Round limits around [low, high]; signed values include 0 and get symmetric limits where the smaller side exceeds a
/// quarter of the larger one. A single value gets a range around it, no value 0 .. 1.
Limits round_limits(double low, double high, bool is_signed);

struct ColourScale {
    ColourMap map;
    double low = 0, high = 1;                     // [SI]
    bool more_below = false, more_above = false;  // there are values beyond the limits
    std::string quantity, unit;                   // "opening", "m"; the prefix follows from the limits
    bool about_zero = false;                      // the middle of the map is zero

    Colour operator()(double value) const;
};

}  // namespace knap
