#pragma once
// Figures of the body at one moment: its cracks, its materials, or a field on it, with the obstacles around it. A new
// field is a row of body_fields(), a new colour of cracks a row of crack_colours() (both in body_quantities.cpp).
#include "figures/figures.hpp"
#include "figures/legend.hpp"
#include "figures/plot.hpp"

namespace knap {

/// A field of the body: one number per triangle.
struct BodyField {
    std::string name;      // as in FigureOptions::show
    std::string quantity;  // as at the colour bar
    std::string unit;
    bool is_signed;  // zero is the middle of the colours
    double (*value)(const Frame&, Index triangle);
    double (*at_corner)(const Frame&, Index corner) = nullptr;  // null: constant in a triangle; else drawn linearly
};
const std::vector<BodyField>& body_fields();

/// Status of an interface of a frame (of second order: of half an interface).
enum class InterfaceKind { intact, damaged, broken, precrack };
InterfaceKind kind_of(const Frame& frame, Index interface);

/// A quantity that colours cracks.
struct CrackColour {
    std::string name;      // as in FigureOptions::colour
    std::string quantity;  // as at the colour bar
    std::string unit;
    double (*value)(const Frame&, Index interface) = nullptr;
    std::string column = {};                  // of breaks.csv, which then has the values instead
    bool damaged = false, precracks = false;  // these are coloured, too, not only broken interfaces
    bool smallest_last = false;               // drawn over the others; otherwise the largest
    std::optional<Limits> range = {};         // whatever the values
    ColourMap map = ColourMap::plasma;
};
const std::vector<CrackColour>& crack_colours();
/// Throws UserError for an unknown name.
const CrackColour& crack_colour(const std::string& name);

/// Value per interface; NaN without one. An interface that is not in `breaks` (breaks.csv) has no value of it.
std::vector<double> crack_values(const CrackColour& colour, const Frame& frame, const History& breaks);

/// The axes of a figure of the part `seen` of the plane with `below` [unit] for a legend: equal scales in x and y, but
/// for FigureOptions::aspect. A slender part is widened so that its axis has room for labels.
Plot body_plot(Box seen, const FigureOptions& options, double below);

FigureScale body_scale(const FigureOptions& options, const Frame& frame, const History& breaks);
Legend body_legend(const FigureOptions& options, const Frame& frame, const FigureContext& context,
                   const FigureScale& scale);
DrawnFigure draw_body(const FigureOptions& options, const Frame& frame, const History& breaks,
                      const FigureContext& context, const std::filesystem::path& file, const FigureScale& scale);

}  // namespace knap
