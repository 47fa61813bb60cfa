#pragma once
// What the colours and lines of a figure stand for.
#include "figures/colours.hpp"

#include <optional>

namespace knap {

struct LegendEntry {
    std::string label;
    Colour colour;
    double width;  // [unit] of the line
    int dash = 0;  // see line_pattern
    Marker marker = Marker::none;
};

/// Size [unit] of entries below each other; long labels are broken into lines. `width` [unit] of the place.
double entries_width(const std::vector<LegendEntry>& entries);
double entries_height(const std::vector<LegendEntry>& entries, double width);
/// From the top of `area` on. Where there is not enough room the last line says how many entries are left.
void draw_entries(Canvas& canvas, const std::vector<LegendEntry>& entries, const Area& area);

/// A colour bar or a note with, to its right, entries in columns.
struct Legend {
    std::optional<ColourScale> bar;
    std::vector<LegendEntry> entries;
    std::string note;  // instead of a bar
};

/// The entries of both, each once.
Legend joined(Legend all, const Legend& other);

/// [unit]
double legend_height(const Legend& legend, double width);
void draw_legend(Canvas& canvas, const Legend& legend, const Area& area);

}  // namespace knap
