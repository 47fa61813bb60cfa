#pragma once
// A page to draw on, in units that do not depend on the resolution: the page is `page_width` units wide, x to the right, y up, and
// becomes a PNG, SVG or PDF by the file's ending (Cairo; no display). In vector files a unit is a point.
// Text knows subscripts: "c_{R}". Every text is recorded with its ink box, so that a test can see what leaves the page or collides.
#include "base/vec.hpp"

#include <filesystem>
#include <string>
#include <vector>

typedef struct _cairo cairo_t;
typedef struct _cairo_surface cairo_surface_t;

namespace knap {

inline constexpr double page_width = 560;  // [unit]

struct Colour {
    double red = 0, green = 0, blue = 0, alpha = 1;
};

inline constexpr Colour black{0, 0, 0}, white{1, 1, 1}, ink{0.15, 0.15, 0.15};

/// A rectangle in units of the page.
struct Area {
    double left = 0, bottom = 0, width = 0, height = 0;
    double right() const { return left + width; }
    double top() const { return bottom + height; }
};

enum class Across { left, centre, right };          // which part of the text stands at its position
enum class Along { baseline, middle, top, bottom };  // likewise, upwards

struct TextStyle {
    double size = 12;  // [unit]
    Colour colour = ink;
    Across across = Across::left;
    Along along = Along::baseline;
    double angle = 0;  // [degree] counterclockwise
    bool bold = false;
};

/// Width [unit] of a text, and how much of it fits into a width: without a page, to find out how large that must be.
double text_width(const std::string& text, double size, bool bold = false);
/// In bytes, whole characters.
std::size_t fitting_bytes(const std::string& text, double size, double width, bool bold = false);
/// The text, or as much of it as fits into `width` units, with an ellipsis.
std::string fitted_text(const std::string& text, double size, double width, bool bold = false);

struct DrawnText {
    std::string text;
    Area box;  // what is inked
};

class Canvas {
public:
    /// `height` in units; `pixels` is the width of a PNG. Throws UserError for an ending that is not .png, .svg or .pdf.
    Canvas(std::filesystem::path file, double height, int pixels);
    ~Canvas();
    Canvas(const Canvas&) = delete;
    Canvas& operator=(const Canvas&) = delete;

    double height() const { return height_; }
    double pixels_per_unit() const { return scale_; }  // of an image on the page
    cairo_t* cairo() const { return cairo_; }

    void line(const std::vector<Vec2>& points, const Colour& colour, double width, const std::vector<double>& dashes = {});
    /// Separate lines from points[2i] to points[2i+1] as one stroke: where they meet or overlap nothing gets darker.
    void segments(const std::vector<Vec2>& points, const Colour& colour, double width);
    void fill(const std::vector<Vec2>& points, const Colour& colour);
    void rectangle(const Area& area, const Colour& colour, double width);

    void text(const Vec2& at, const std::string& text, const TextStyle& style);
    const std::vector<DrawnText>& texts() const { return texts_; }

    /// Writes the file. Throws OutputError naming it; an older one stays then.
    void finish();

private:
    std::filesystem::path file_;
    std::string bytes_;  // of the file
    double height_, scale_;
    cairo_surface_t* surface_ = nullptr;
    cairo_t* cairo_ = nullptr;
    std::vector<DrawnText> texts_;
};

}  // namespace knap
