#pragma once
// What is asked of a figure, and what it is drawn from besides frames and histories.
#include "figures/ticks.hpp"
#include "model/loads.hpp"

#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace knap {

struct Page;  // figures/canvas.hpp

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
    double paper_width = 0;             // [m] of a vector file; 0: page_width points
    double font_size = 0;               // [pt] of labels; 0: that of a figure without paper_width, 8 pt on paper
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
    /// Of charts and bodies; a rose has page_width units on any paper.
    Page page() const;
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
    fluid,      // in cracks
    breaks,     // breaks.csv
    fragments,  // a run that has ended
};

/// The common ranges of the pictures of a sequence, or of the panels of a sheet.
struct FigureScale {
    Box seen{Vec2::Constant(INFINITY), Vec2::Constant(-INFINITY)};  // part of the plane [m]; of curves both axes [SI]
    ValueSpan values;                                               // that are coloured
    bool damaged = false, precracks = false;                        // whether there are such interfaces
};

}  // namespace knap
