#pragma once
// What a scenario says about its figures, and the pictures made from it: off-screen, no display needed.
#include "model/loads.hpp"
#include "observe/frame.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace knap {

struct FigureOptions {
    std::string file;             // "cracks.png"; .png, .svg or .pdf; with several times the time is put into the name
    std::string show = "cracks";  // one of figure_subjects()
    std::vector<double> at;       // [s] empty = end
    std::string colour = "opening";  // cracks: opening or beta
    double deform = 1;            // [-] exaggeration of the displacement
    std::optional<Box> box;       // part of the body
    std::vector<double> range;    // colour range, two values in SI; empty = from the data
    int width = 1600;             // [pixel]
    std::string title;            // empty = that of the run
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

/// Draws one figure into `directory` and returns the files written. A body is drawn from `frame`, curves from the histories.
/// With several times in `at` the name gets the one nearest to the frame: "cracks_40us.png".
/// Throws UserError for a subject, colour or file ending that does not exist, SimulationError for a file that cannot be written.
std::vector<std::filesystem::path> draw_figure(const FigureOptions& options, const Frame& frame, const Histories& histories,
                                               const FigureContext& context, const std::filesystem::path& directory);

}  // namespace knap
