#pragma once
// What a scenario says about its figures, and the pictures made from it: off-screen, no display needed.
#include "figures/value_span.hpp"
#include "model/loads.hpp"
#include "output/frame.hpp"
#include "output/history_csv.hpp"

#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace knap {

struct Legend;

struct FigureOptions {
    std::string file;             // "cracks.png"; .png, .svg or .pdf; with several times the time is put into the name
    std::string show = "cracks";  // one of figure_subjects()
    std::vector<double> at;       // [s] empty = end
    std::string colour = "opening";  // cracks: one of figure_colours()
    double deform = 1;            // [-] exaggeration of the displacement
    std::optional<Box> box;       // part of the body
    std::vector<double> range;    // colour range, two values in SI; empty = from the data
    int width = 1600;             // [pixel]
    std::string title;            // empty = that of the run
    std::string over = "displacement";  // reactions: displacement or time
    double aspect = 1;            // [-] of a slender body: how much larger the short side is drawn than the long one
    bool panel = false;           // bare: no title, axes of a body or legend, to stand beside others of the same scale
};

/// What a run knows and its histories do not say.
struct FigureContext {
    std::string title;           // of the run
    double rayleigh_speed = 0;   // [m/s] c_R; 0 = not drawn
    std::vector<std::string> materials;  // names, by region
};

/// The words allowed for FigureOptions::show: "cracks", the fields, and the curves.
std::vector<std::string> figure_subjects();
/// The fields of the body among them: "displacement", "stress_xx", ...
std::vector<std::string> figure_fields();
/// The words allowed for FigureOptions::colour.
std::vector<std::string> figure_colours();
/// Whether the subject is drawn from a frame (and so once for each time in `at`), not from the histories.
bool shows_body(const std::string& subject);

/// The words allowed for FigureOptions::over.
std::vector<std::string> figure_abscissas();
/// Whether a figure is drawn from breaks.csv, by FigureOptions::show and colour.
bool needs_breaks(const std::string& show, const std::string& colour);
/// Of the values that have a colour: "m"; "" for none.
std::string_view unit_of_figure(const std::string& show, const std::string& colour);
/// Whether a figure is drawn at the end from frames that were kept: only then is known what its pictures have in common.
bool waits_for_the_end(const FigureOptions& options);

/// What the pictures of a sequence, or the panels of a sheet, have in common.
struct FigureScale {
    Box seen{Vec2::Constant(INFINITY), Vec2::Constant(-INFINITY)};  // of a body: the part of the plane [m]; of curves: both axes [SI]
    ValueSpan values;                                               // that are coloured
    bool damaged = false, precracks = false;                        // there are such interfaces, for the legend
};
/// Of both.
FigureScale joined(const FigureScale& a, const FigureScale& b);

/// What one picture alone would have. Throws as draw_figure does.
FigureScale scale_of(const FigureOptions& options, const Frame& frame, const Histories& histories, const FigureContext& context);

/// "displacements × 5" and what that does to contacts; nothing of a picture that is as it is. `obstacles`: there are some.
std::string magnification(const FigureOptions& options, bool obstacles);

/// What stands below panels instead of below each of them.
Legend panel_legend(const FigureOptions& options, const Frame& frame, const Histories& histories, const FigureContext& context, const FigureScale& scale);

/// Draws one figure into `directory` and returns its file. A body is drawn from `frame`, curves from the histories; `common`: the scale of all pictures that
/// this one belongs to. With several times in `at` the name gets the one nearest to the frame: "cracks_40us.png".
/// Throws UserError for a subject, colour or file ending that does not exist, or what the run does not have; OutputError for a file that cannot be written.
std::filesystem::path draw_figure(const FigureOptions& options, const Frame& frame, const Histories& histories, const FigureContext& context,
                                  const std::filesystem::path& directory, const FigureScale* common = nullptr);

/// Throws UserError for what cannot be drawn from these histories, saying what can.
void check_figure(const FigureOptions& options, const Histories& histories);

}  // namespace knap
