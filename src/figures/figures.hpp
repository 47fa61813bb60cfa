#pragma once
// Figures of a run, drawn without a display. A figure of the body is drawn from a frame, a curve from the histories.
#include "figures/ticks.hpp"
#include "model/loads.hpp"
#include "output/frame.hpp"
#include "output/history_csv.hpp"

#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>

namespace knap {

struct DrawnFigure;  // figures/canvas.hpp
struct Legend;       // figures/legend.hpp

inline constexpr int animation_width = 800;  // [pixel] unless it is given

/// [[figure]] of a scenario.
struct FigureOptions {
    std::string file;                   // "cracks.png"; .png, .svg, .pdf; .webp, .gif, .mp4: an animation
    std::string show = "cracks";        // one of figure_subjects()
    std::vector<double> at;             // [s] empty = at the end; several: each picture has its time in its name
    std::string colour = "opening";     // cracks: one of figure_colours()
    double deform = 1;                  // [-] magnification of the displacements
    std::optional<Box> box;             // part of the body
    std::vector<double> range;          // [SI] of the colours, two values; empty = from the data
    int width = 1600;                   // [pixel]
    std::string title;                  // empty = that of the run
    std::string over = "displacement";  // reactions: one of figure_abscissas(); probes: "temperature", else time
    std::vector<double> mark;           // [SI] isolines of a temperature; of curves places of the abscissa
    std::vector<Vec2> measured;         // [SI] points of an experiment: on the undeformed body, or in units of the axes
    std::string measured_by;            // their source, as in the legend
    double aspect = 1;                  // [-] a slender body: magnification of its short side relative to the long one
    bool panel = false;                 // one of several in a sheet: no title, no legend, and no axes of a body
    double every = 0;                   // [s] of an animation, between two pictures; `at` then has all of its times
    double speed = 0;                   // [-] of an animation: simulated time over its own; 0: it takes 8 s
    std::string curves;                 // of an animation: one of growing_subjects(), below the body; empty = none

    bool is_animation() const;
};

/// What a figure needs of a run besides its frames and histories.
struct FigureContext {
    std::string title;                   // of the run
    double rayleigh_speed = 0;           // [m/s] 0 = not drawn
    std::vector<std::string> materials;  // names, by region
    bool celsius = false;                // temperatures are in degrees Celsius
    double early_end = infinity;         // [s] of a run that did not reach time.end
    struct Line {
        std::string name;
        Vec2 from, to;  // [m] a vertical without ends: y infinite
    };
    std::vector<Line> collectors = {};  // dashed on the body
};

/// What a figure needs of a scenario, or of the histories of a run.
enum class FigureNeed {
    nothing,
    heat,
    driver,  // a load with a prescribed motion, or an obstacle
    probe_of_motion,
    probe_of_place,
    probe_of_stress,
    probe_of_tip,
    specimen,
    breaks,     // breaks.csv
    fragments,  // a run that has ended
};

/// The words allowed for FigureOptions::show, colour and over.
std::vector<std::string> figure_subjects(), figure_colours(), figure_abscissas();
/// The subjects with a line each.
std::vector<std::pair<std::string, std::string>> described_subjects();
/// Curves with a point for every line of the histories, for FigureOptions::curves.
std::vector<std::string> growing_subjects();
/// Whether a subject is drawn from a frame, once for each time in `at`.
bool shows_body(const std::string& subject);
/// Whether FigureOptions::mark has a meaning.
bool takes_marks(const std::string& subject);
/// Whether FigureOptions::measured has a meaning.
bool takes_measured(const std::string& subject);
FigureNeed need_of_figure(const std::string& show, const std::string& colour);
/// Whether it has few colours, which an animation keeps without loss.
bool has_few_colours(const std::string& subject);
/// Unit of the values that are coloured: "m"; "" for none.
std::string_view unit_of_figure(const std::string& show, const std::string& colour);
/// Whether a figure is drawn from stored frames at the end of a run, when the common range of its pictures is known.
bool waits_for_the_end(const FigureOptions& options);

/// The common ranges of the pictures of a sequence, or of the panels of a sheet.
struct FigureScale {
    Box seen{Vec2::Constant(INFINITY), Vec2::Constant(-INFINITY)};  // part of the plane [m]; of curves both axes [SI]
    ValueSpan values;                                               // that are coloured
    bool damaged = false, precracks = false;                        // whether there are such interfaces
};
FigureScale joined(const FigureScale& a, const FigureScale& b);

/// The ranges of a single picture. Throws as draw_figure does.
FigureScale scale_of(const FigureOptions& options, const Frame& frame, const Histories& histories,
                     const FigureContext& context);

/// "displacements × 5", and the consequence for contacts where there are obstacles; "" for a body in true scale.
std::string magnification(const FigureOptions& options, bool obstacles);

/// The legend of panels, which stands below the sheet.
Legend panel_legend(const FigureOptions& options, const Frame& frame, const Histories& histories,
                    const FigureContext& context, const FigureScale& scale);

/// Draws one figure into `directory`. `common`: the ranges of all pictures to which this one belongs. With several
/// times in `at` the one nearest to the frame is added to the name: "cracks_40us.png". Throws UserError for an unknown
/// subject, colour or file ending and for data that the run does not have; OutputError for a file that cannot be
/// written.
DrawnFigure draw_figure(const FigureOptions& options, const Frame& frame, const Histories& histories,
                        const FigureContext& context, const std::filesystem::path& directory,
                        const FigureScale* common = nullptr);

/// The same in memory, without a file; of an animation with its curves up to the time of the frame.
DrawnFigure draw_picture(const FigureOptions& options, const Frame& frame, const Histories& histories,
                         const FigureContext& context, const FigureScale& common);

/// [pixel] About the size of a picture of a body of this extent [m], with its curves.
Vec2 picture_size(const FigureOptions& options, const Vec2& extent);
/// [pixel] The longest side that a picture of this type may have.
double longest_side(const FigureOptions& options);
/// [byte] About the memory that it needs while it is drawn.
double drawing_memory(const FigureOptions& options, const Vec2& extent);

/// Throws UserError, with what can be drawn, where these histories are not enough for a figure.
void check_figure(const FigureOptions& options, const Histories& histories);

}  // namespace knap
