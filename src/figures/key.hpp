#pragma once
// Lines and what they stand for.
#include "figures/marker.hpp"
#include "figures/title.hpp"

#include <string>
#include <vector>

namespace knap {

struct KeyEntry {
    std::string label;
    Colour colour;
    double width;  // [unit]
    int dash = 0;  // of line_pattern
    Marker marker = Marker::none;
};

inline constexpr double type_size = 11;                // [unit] of all figures
inline constexpr double key_leading = 15.0 / type_size;  // distance of entries over the size of the type

/// Width [unit] that the key needs; long labels are broken into lines.
double key_width(const std::vector<KeyEntry>& entries, double size = type_size);

/// Height [unit] that it needs where it is `width` wide.
double key_height(const std::vector<KeyEntry>& entries, double width, double size = type_size);

/// One entry below the other, the first one at the top of `area`; where there is no room for all, the last line says how many more there are.
void draw_key(Canvas& canvas, const std::vector<KeyEntry>& entries, const Area& area, double size = type_size);

}  // namespace knap
