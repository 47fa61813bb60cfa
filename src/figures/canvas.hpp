#pragma once
// A page to draw on with Cairo; no display is needed. The page is `Page::width` units wide, x to the right, y upwards,
// and is written as PNG, SVG or PDF according to the ending of the file, or kept in memory where there is no file.
// Units do not depend on the resolution. Texts may have subscripts: "c_{R}"; in SVG and PDF files they are texts, not
// outlines. Every text is recorded with the box of its ink, so that tests find texts that overlap or leave the page.
#include "base/vec.hpp"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

typedef struct _cairo cairo_t;
typedef struct _cairo_surface cairo_surface_t;

namespace knap {

inline constexpr double page_width = 560, type_size = 11;  // [unit] type_size: of labels in all figures

/// A narrower page has larger type.
struct Page {
    double width = page_width;  // [unit]
    double points = 1;          // [pt] of a unit, in vector files
};

struct Colour {
    double red = 0, green = 0, blue = 0, alpha = 1;
};
inline constexpr Colour black{0, 0, 0}, white{1, 1, 1}, ink{0.15, 0.15, 0.15};

/// A rectangle on the page [unit].
struct Area {
    double left = 0, bottom = 0, width = 0, height = 0;
    double right() const { return left + width; }
    double top() const { return bottom + height; }
    bool overlaps(const Area& other) const {
        return left < other.right() && other.left < right() && bottom < other.top() && other.bottom < top();
    }
};

enum class Across { left, centre, right };           // horizontal part of a text that lies at its position
enum class Along { baseline, middle, top, bottom };  // the vertical part

struct TextStyle {
    double size = type_size;  // [unit]
    Across across = Across::left;
    Along along = Along::baseline;
    double angle = 0;  // [degree] counterclockwise
    bool bold = false;
};

/// Width [unit] of a text on any page.
double text_width(const std::string& text, double size = type_size, bool bold = false);
/// The text, or as many of its first characters as fit into `width` [unit] with an ellipsis.
std::string fitted_text(const std::string& text, double size, double width, bool bold = false);
/// The text in at most `max_lines` lines of at most `width` [unit], broken at blanks, within longer words anywhere; the
/// last line ends with an ellipsis where text is left.
std::vector<std::string> broken_lines(const std::string& text, double size, double width, bool bold,
                                      std::size_t max_lines);

enum class Marker { none, circle, square, triangle, diamond, cross };
/// The i-th shape other than none; they repeat.
Marker marker(std::size_t i);

/// Lengths [unit] of dashes and gaps of a line of this width: 0 solid, 1 dashed, 2 dotted, 3 dash-dotted, 4 dash and
/// two dots; they repeat.
std::vector<double> line_pattern(int kind, double width);
inline constexpr int n_line_patterns = 5;

/// An image in memory; see cairo_image_surface_create.
using Image = std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)>;

struct DrawnText {
    std::string text;
    Area box;  // of the ink
};

/// A figure that has been drawn; its height and texts are for tests.
struct DrawnFigure {
    std::filesystem::path file;
    double height = 0;  // [unit] of the page
    std::vector<DrawnText> texts;
    Image image{nullptr, nullptr};  // of a page without a file
};

class Canvas {
public:
    /// `height` [unit]; `pixels`: width of a PNG or of an image in memory, for which `file` is empty. Throws UserError
    /// for an ending other than .png, .svg and .pdf.
    Canvas(std::filesystem::path file, double height, int pixels, const Page& page = {});
    ~Canvas();
    Canvas(const Canvas&) = delete;
    Canvas& operator=(const Canvas&) = delete;

    double height() const { return height_; }

    /// Until unclip() nothing is drawn outside of `area`.
    void clip(const Area& area);
    void unclip();

    void line(const std::vector<Vec2>& points, const Colour& colour, double width,
              const std::vector<double>& dashes = {});
    /// Lines from points[2i] to points[2i+1] in one stroke: a transparent colour is not darker where they meet.
    void segments(const std::vector<Vec2>& points, const Colour& colour, double width);
    void fill(const std::vector<Vec2>& outline, const Colour& colour);
    void marker(Marker marker, const Vec2& at, const Colour& colour);
    /// Fills the triangles corners[3t .. 3t+2] inside `area` with opaque colours as an image without seams: filled
    /// without antialiasing at three times the resolution, then averaged. It is an image in vector files, too: viewers
    /// are slow with 37 000 paths.
    void triangles(const std::vector<Vec2>& corners, const std::vector<Colour>& colours, const Area& area);
    /// Stretches an image to `area`.
    void image(const Image& image, const Area& area);
    void text(const Vec2& at, const std::string& text, const TextStyle& style);

    /// Writes the file. Throws OutputError with its name; an older file then stays.
    DrawnFigure finish();

private:
    bool has_pixels() const { return file_.empty() || file_.extension() == ".png"; }

    std::filesystem::path file_;
    std::string bytes_;      // of the file
    std::string svg_texts_;  // elements of an SVG file
    Page page_;
    double height_, pixels_per_unit_;
    cairo_surface_t* surface_;
    cairo_t* cairo_;
    std::vector<DrawnText> texts_;
};

}  // namespace knap
