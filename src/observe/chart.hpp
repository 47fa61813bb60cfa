#pragma once
// Curves over one axis, drawn by VTK's charts; axes even or logarithmic.
#include "observe/marker.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace knap {

struct Curve {
    std::string label;
    std::vector<double> x, y;  // SI; not finite (on a logarithmic axis: or not positive) = left out
    Colour colour;
    double width = 1.6;  // [unit]
    bool dashed = false;
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
};

/// The i-th colour of curves: M. Okabe, K. Ito, "Color universal design" (2008), told apart by the colour-blind.
Colour curve_colour(std::size_t i);

/// What has been drawn, for who wants to check it.
struct DrawnFigure {
    std::filesystem::path file;
    double height = 0;  // [unit] the page is page_width x height
    std::vector<DrawnText> texts;
};

/// Throws SimulationError when the file cannot be written.
DrawnFigure draw_chart(const Chart& chart, const std::filesystem::path& file, int pixels);

}  // namespace knap
