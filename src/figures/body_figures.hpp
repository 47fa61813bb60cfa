#pragma once
// Figures of the body at one moment: its cracks, its materials, or a field on it, with the obstacles around it. A new
// field is a row of body_fields(), a new colour of cracks a row of crack_colours() (both in body_quantities.cpp), a new
// kind a row of body_kinds (body_figures.cpp).
#include "figures/figure_options.hpp"
#include "figures/legend.hpp"
#include "figures/plot.hpp"
#include "output/frame.hpp"
#include "output/history_csv.hpp"

namespace knap {

/// A field of the body: one number per triangle.
struct BodyField {
    std::string name;      // as in FigureOptions::show
    std::string quantity;  // as at the colour bar
    std::string unit;
    bool is_signed;  // zero is the middle of the colours
    double (*value)(const Frame&, Index triangle);
    double (*at_corner)(const Frame&, Index corner) = nullptr;  // null: constant in a triangle; else drawn linearly
    FigureNeed needs = FigureNeed::nothing;
};
const std::vector<BodyField>& body_fields();
/// Null for another subject.
const BodyField* body_field(const std::string& show);

struct BodyDrawing;
struct BodyKind {
    std::string show;  // "": each of body_fields()
    std::string doc;
    bool by_colour = false, few_colours = false;  // FigureOptions::colour has a meaning; has_few_colours()
    BodyDrawing (*drawing)(const FigureOptions&, const Frame&, const Histories&, const FigureScale&);
    void (*add_scale)(const FigureOptions&, const Frame&, const Histories&, FigureScale&);
    void (*add_legend)(const FigureOptions&, const Frame&, const FigureContext&, const FigureScale&, Legend&);
    std::string_view unit = "";  // of its values, but of cracks and fields
};
/// Null for a figure that is drawn from histories.
const BodyKind* body_kind(const std::string& show);
std::vector<std::string> body_subjects();
/// A line about one of them.
std::string doc_of_body(const std::string& show);

/// Status of an interface as it is drawn: initially open contact with a support is no crack.
InterfaceStatus drawn_status(const Frame& frame, Index interface);

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

/// The way of the centre of a piece or of a free obstacle.
struct PiecePath {
    std::vector<Vec2> at;       // [m]
    std::vector<double> speed;  // [m/s]
};
/// Up to a time [s].
std::vector<PiecePath> piece_paths(const Histories& histories, double until);

/// Scales of colours for values of a field, of cracks and of paths; the colour of a grain (-1: none) of a material,
/// light enough for black cracks, in one of four shades.
ColourScale field_scale(const FigureOptions& options, const Frame& frame, const ValueSpan& values);
ColourScale crack_scale(const FigureOptions& options, const ValueSpan& values);
ColourScale path_scale(const FigureOptions& options, const ValueSpan& values);
Colour material_colour(std::int32_t region, std::int32_t grain);

/// The axes of a figure of the part `seen` of the plane with `below` [unit] for a legend: equal scales in x and y, but
/// for FigureOptions::aspect. A slender part is widened so that its axis has room for labels.
Plot body_plot(Box seen, const FigureOptions& options, double below);

/// "displacements × 5", and the consequence for contacts where there are obstacles; "" for a body in true scale.
std::string magnification(const FigureOptions& options, bool obstacles);

FigureScale body_scale(const FigureOptions& options, const Frame& frame, const Histories& histories);
Legend body_legend(const FigureOptions& options, const Frame& frame, const FigureContext& context,
                   const FigureScale& scale);
DrawnFigure draw_body(const FigureOptions& options, const Frame& frame, const Histories& histories,
                      const FigureContext& context, const std::filesystem::path& file, const FigureScale& scale);

}  // namespace knap
