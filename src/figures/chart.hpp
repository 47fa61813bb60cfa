#pragma once
// Curves over one axis, linear or logarithmic.
#include "figures/legend.hpp"
#include "mesh/polygon.hpp"

#include <limits>

namespace knap {

struct Curve {
    std::string label;
    std::vector<double> x, y;  // [SI] values that are not finite (on a logarithmic axis: not positive) are left out
    Colour colour;
    double width = 1.6;             // [unit] 0 = no line
    int dash = 0;                   // see line_pattern
    Marker marker = Marker::none;   // at every point
    std::vector<double> low, high;  // [SI] ends of an error bar at every point; may be empty
};

/// A horizontal line with its name.
struct Level {
    std::string label;
    double y = 0;             // [SI]
    bool name_right = false;  // preferred side of the name
};

struct Chart {
    std::string title;
    std::string x_quantity, x_unit;  // "time", "s"; the prefix follows from the data
    std::string y_quantity, y_unit;
    std::vector<Curve> curves;
    std::vector<Level> levels;
    std::vector<double> marks = {};  // [SI] vertical lines
    bool x_logarithmic = false, y_logarithmic = false;
    bool x_with_zero = true, y_with_zero = true;  // of a linear axis
    std::optional<Limits> x_within = {};          // [SI] values beyond do not widen the axes; curves are cut off there
};

/// The range of both axes [SI]: of all values, on a linear axis with 0 unless the chart is without. Infinite,
/// low > high, where there is no value.
Box axis_ranges(const Chart& chart);

struct ChartPlace {
    std::optional<Box> axes;  // the axes span this range at least
    bool panel = false;       // one of several in a sheet: larger type, no title, no legend
    Page page = {};
    // of an animation: number of points of each curve that are drawn, of those that have more than one
    std::size_t n_points = std::numeric_limits<std::size_t>::max();
};

/// One entry per curve with a label; none for a single curve.
std::vector<LegendEntry> entries_of(const Chart& chart);

/// Throws OutputError when the file cannot be written.
DrawnFigure draw_chart(const Chart& chart, const std::filesystem::path& file, int pixels, const ChartPlace& place = {});

}  // namespace knap
