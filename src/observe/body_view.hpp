#pragma once
// Where a body lies on the page: equal scales in x and y, axes with round numbers, a title above and room for a colour bar below.
#include "model/loads.hpp"
#include "observe/canvas.hpp"
#include "observe/figures.hpp"
#include "observe/ticks.hpp"

#include <string>

namespace knap {

/// Deformed position [m] of a corner.
inline Vec2 deformed(const Frame& frame, Index corner, double exaggeration) {
    return frame.position[corner] + exaggeration * frame.displacement[corner];
}

class BodyView {
public:
    /// Fits the part of the body that the options ask for (all of it without a box) onto a page.
    BodyView(const Frame& frame, const FigureOptions& options);

    double page_height() const { return page_height_; }
    const Area& plot() const { return plot_; }  // of the page
    Area below() const;                         // for colour bar and key
    Vec2 on_page(const Vec2& x) const { return Vec2(plot_.left, plot_.bottom) + scale_ * (x - seen_.low); }
    bool sees(const Vec2& x) const { return seen_.contains(x); }

    void draw_axes(Canvas& canvas) const;
    /// The title on the left, what the moment is on the right.
    void draw_title(Canvas& canvas, const std::string& title, const std::string& moment) const;

private:
    Box seen_;      // [m]
    double scale_;  // [unit/m]
    DisplayUnit unit_;
    Ticks x_ticks_, y_ticks_;
    Area plot_;
    double page_height_;
};

}  // namespace knap
