#pragma once
// Figures of a run, drawn without a display. A figure of the body is drawn from a frame, a curve from the histories.
#include "figures/figure_options.hpp"
#include "output/frame.hpp"
#include "output/history_csv.hpp"

#include <filesystem>
#include <string_view>
#include <utility>

namespace knap {

struct DrawnFigure;  // figures/canvas.hpp
struct Legend;       // figures/legend.hpp

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

/// The common scale of two pictures.
FigureScale joined(const FigureScale& a, const FigureScale& b);

/// The ranges of a single picture. Throws as draw_figure does.
FigureScale scale_of(const FigureOptions& options, const Frame& frame, const Histories& histories,
                     const FigureContext& context);

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

/// A key of a figure that has no effect on its subject or its format.
struct IdleKey {
    std::string key, owner, cure;  // `owner`: what the key belongs to
    bool is_usual;                 // it has the value that it has where it is not given
};
std::vector<IdleKey> idle_keys(const FigureOptions& options);

/// What it shows, in words: "Cracks, coloured by opening".
std::string words_of(const FigureOptions& options);
/// The same with its time, "Cracks, coloured by opening, t = 40 us"; "" where `file` is none of its pictures.
std::string caption_of(const FigureOptions& options, const std::filesystem::path& file, double end);

/// Throws UserError where paper_width and font_size do not fit each other.
void check_type(const FigureOptions& options);

/// Throws UserError, with what can be drawn, where these histories are not enough for a figure.
void check_figure(const FigureOptions& options, const Histories& histories);

}  // namespace knap
