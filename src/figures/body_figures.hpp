#pragma once
// Pictures of the body at one moment: its cracks, or a field on it. Obstacles are in all of them.
#include "figures/chart.hpp"
#include "figures/figures.hpp"
#include "figures/legend.hpp"

namespace knap {

struct BodyExtras {
    const FigureScale* scale = nullptr;  // of all pictures that this one belongs to; none: its own
    const History* breaks = nullptr;     // for colours that need it
};

/// Broken interfaces as thin lines coloured by opening, slip, cohesion, mode or time of breaking, damaged ones paler, pre-cracks black, over the deformed body.
DrawnFigure draw_cracks(const FigureOptions& options, const Frame& frame, const std::string& title, const std::filesystem::path& file, const BodyExtras& extras = {});

/// Triangles coloured by a field, broken interfaces as thin black lines.
DrawnFigure draw_field(const FigureOptions& options, const Frame& frame, const std::string& title, const std::filesystem::path& file, const BodyExtras& extras = {});

/// Triangles coloured by material, those of a grain in a shade of their own, broken interfaces black.
DrawnFigure draw_materials(const FigureOptions& options, const Frame& frame, const std::vector<std::string>& materials, const std::string& title,
                           const std::filesystem::path& file, const BodyExtras& extras = {});

/// The part of the plane and the values of one picture of any of these kinds.
FigureScale body_scale(const FigureOptions& options, const Frame& frame, const History* breaks);
/// What stands below it, for panels that have none.
Legend body_legend(const FigureOptions& options, const Frame& frame, const std::vector<std::string>& materials, const FigureScale& scale);

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
