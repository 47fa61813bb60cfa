#pragma once
// Lines and what they stand for.
#include "observe/marker.hpp"

#include <string>
#include <vector>

namespace knap {

struct KeyEntry {
    std::string label;
    Colour colour;
    double width;  // [unit]
    bool dashed = false;
    Marker marker = Marker::none;
};

inline constexpr double type_size = 11, title_size = 12.5;  // [unit] of all figures

/// Width [unit] that the key needs; of long labels the begin is shown.
double key_width(const Canvas& canvas, const std::vector<KeyEntry>& entries);

/// One entry below the other, the first one at the top of `area`.
void draw_key(Canvas& canvas, const std::vector<KeyEntry>& entries, const Area& area);

}  // namespace knap
