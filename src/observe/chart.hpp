#pragma once
// Curves over one axis, drawn by VTK's charts.
#include "observe/canvas.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace knap {

struct Curve {
    std::string label;
    std::vector<double> x, y;  // SI; not finite = left out
    Colour colour;
    double width = 1.6;  // [unit]
    bool dashed = false;
};

/// A horizontal line with its name on it.
struct Level {
    std::string label;
    double y = 0;
};

struct Chart {
    std::string title;
    std::string x_quantity, x_unit;  // "time", "s"; the prefix is found from the data
    std::string y_quantity, y_unit;
    std::vector<Curve> curves;
    std::vector<Level> levels;
};

/// What has been drawn, for who wants to check it.
struct DrawnFigure {
    std::filesystem::path file;
    double height = 0;  // [unit] the page is page_width x height
    std::vector<DrawnText> texts;
};

/// Throws SimulationError when the file cannot be written.
DrawnFigure draw_chart(const Chart& chart, const std::filesystem::path& file, int pixels);

}  // namespace knap
