#pragma once
// Pictures of the body at one moment: its cracks, or a field on it.
#include "observe/chart.hpp"
#include "observe/figures.hpp"

namespace knap {

/// Broken interfaces as thin lines coloured by opening or cohesion, damaged ones paler, pre-cracks black, over the deformed body.
DrawnFigure draw_cracks(const FigureOptions& options, const Frame& frame, const std::string& title, const std::filesystem::path& file);

/// Triangles coloured by a field, broken interfaces as thin black lines.
DrawnFigure draw_field(const FigureOptions& options, const Frame& frame, const std::string& title, const std::filesystem::path& file);

/// Triangles coloured by material, those of a grain in a shade of their own, broken interfaces black.
DrawnFigure draw_materials(const FigureOptions& options, const Frame& frame, const std::vector<std::string>& materials, const std::string& title,
                           const std::filesystem::path& file);

/// A field that can be shown: one number per triangle.
struct BodyField {
    std::string name;      // as in FigureOptions::show
    std::string quantity;  // as beside the colour bar
    std::string unit;
    bool is_signed;        // shown about zero
    double (*value)(const Frame&, Index triangle);
};
const std::vector<BodyField>& body_fields();

}  // namespace knap
