#pragma once
// Curves over one axis, drawn by VTK's charts; axes even or logarithmic.
#include "figures/key.hpp"

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace knap {

struct Curve {
    std::string label;
    std::vector<double> x, y;  // SI; not finite (on a logarithmic axis: or not positive) = left out
    Colour colour;
    double width = 1.6;  // [unit]
    int dash = 0;        // of line_pattern
    Marker marker = Marker::none;     // at every point
    std::vector<double> low, high;    // SI; a bar from one to the other at every point, or empty
};

/// A horizontal line with its name on it.
struct Level {
    std::string label;
    double y = 0;
    bool name_right = false;
};

struct Chart {
    std::string title;
    std::string x_quantity, x_unit;  // "time", "s"; the prefix is found from the data
    std::string y_quantity, y_unit;
    std::vector<Curve> curves;
    std::vector<Level> levels;
    bool x_logarithmic = false, y_logarithmic = false;
    std::optional<std::array<double, 2>> x_within;  // SI; what lies beyond does not widen the axis, and is cut off
};

/// The i-th colour of curves: M. Okabe, K. Ito, "Color universal design" (2008), told apart by the colour-blind. Curves of one colour have the pattern
/// curve_dash(i) each, up to n_curve_colours x n_line_patterns of them.
Colour curve_colour(std::size_t i);
inline constexpr std::size_t n_curve_colours = 6;
inline int curve_dash(std::size_t i) { return static_cast<int>(i / n_curve_colours % n_line_patterns); }

/// Limits of both axes [SI].
struct AxisRanges {
    std::array<double, 2> x, y;
};
/// Of all that a chart shows; [INFINITY, -INFINITY] where it has nothing.
AxisRanges axis_ranges(const Chart& chart);

struct ChartPlace {
    std::optional<AxisRanges> axes;  // at least; none: those of the chart
    bool panel = false;              // one of several: larger type, no title, no key
};

/// Lines and names of its curves.
std::vector<KeyEntry> key_of(const Chart& chart);

/// What has been drawn, for who wants to check it.
struct DrawnFigure {
    std::filesystem::path file;
    double height = 0;  // [unit] the page is page_width x height
    std::vector<DrawnText> texts;
};

/// Throws OutputError when the file cannot be written.
DrawnFigure draw_chart(const Chart& chart, const std::filesystem::path& file, int pixels, const ChartPlace& place = {});

}  // namespace knap
