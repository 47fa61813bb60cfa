#pragma once
// A rectangle of the page with two axes, and the title above it.
#include "figures/canvas.hpp"
#include "figures/ticks.hpp"

namespace knap {

/// As many round ticks, `max_ticks` at most, as have room next to each other on `length` [unit] of the page; `upright`:
/// along a vertical axis.
Ticks fitting_ticks(double low, double high, double length, int max_ticks, bool upright = false,
                    double size = type_size);

struct Axis {
    std::string title;  // with the unit
    DisplayUnit unit;
    bool logarithmic = false;
    double low = 0, high = 1;  // in the display unit; of a logarithmic axis the decimal exponent
    Ticks ticks = {};

    double shown(double value) const;                                                    // NaN: has no place
    double fraction(double value) const { return (shown(value) - low) / (high - low); }  // of the length
};

/// The axis of values [SI] between `low` and `high`. A linear axis ends at round numbers (`round`), or where the values
/// do.
Axis fitted_axis(const std::string& quantity, const std::string& unit, bool logarithmic, Limits values, bool round);

struct Plot {
    Area area = {};
    Axis x, y;
    double size = type_size;  // of its labels

    Vec2 on_page(const Vec2& value) const;
    void fit_ticks(int max_x, int max_y);
    double y_label_width() const;  // [unit] of the widest label
    /// The labelled axes, and a light grid, or the frame that closes the rectangle.
    void draw_axes(Canvas& canvas, bool grid) const;
};

inline constexpr double title_size = 12.5;  // [unit]

/// A title is shown on one line, smaller, or on several lines; only after eight lines it is cut.
struct Title {
    std::vector<std::string> lines;
    std::string aside;         // at the right, as the time
    bool aside_below = false;  // on a line of its own
    double size = title_size;

    double height() const;  // [unit] needed above a plot
};

/// `width` [unit] of the place.
Title fitted_title(const std::string& text, const std::string& aside, double width);

/// Above `bottom`, between `left` and `right` [unit].
void draw_title(Canvas& canvas, const Title& title, double left, double right, double bottom);

}  // namespace knap
