#pragma once
// Where a body lies on the page: equal scales in x and y (but where the options stretch the short side), axes with round numbers, a title above and room for a
// legend below. A panel has neither axes nor title nor legend.
#include "figures/canvas.hpp"
#include "figures/figures.hpp"
#include "figures/ticks.hpp"
#include "figures/title.hpp"
#include "model/loads.hpp"

#include <string>

namespace knap {

/// Deformed position [m] of a corner.
inline Vec2 deformed(const Frame& frame, Index corner, double exaggeration) {
    return frame.position[corner] + exaggeration * frame.displacement[corner];
}

/// The part of the plane that the options ask for; without a box the deformed body, obstacles that are not far away, and a margin.
Box seen_part(const FigureOptions& options, const Frame& frame);

class BodyView {
public:
    /// Fits `seen` onto a page with `room_below` [unit] for a legend. `moment` stands beside the title.
    BodyView(const Box& seen, const FigureOptions& options, const std::string& title, const std::string& moment, double room_below);

    double page_height() const { return page_height_; }
    const Area& plot() const { return plot_; }  // of the page
    Area below() const;                         // for the legend
    Vec2 on_page(const Vec2& x) const { return Vec2(plot_.left, plot_.bottom) + scale_.cwiseProduct(x - seen_.low); }
    const Box& seen() const { return seen_; }

    void draw_frame(Canvas& canvas) const;  // axes and title

private:
    void place(double room_left);
    double widest_label() const;
    void draw_axes(Canvas& canvas) const;

    Box seen_;      // [m]
    Vec2 stretch_;  // [-] of x and y beside each other
    Vec2 scale_;    // [unit/m]
    DisplayUnit unit_;
    Ticks x_ticks_, y_ticks_;
    Area plot_;
    bool panel_;
    double room_below_, page_height_ = 0;
    Title title_;
};

}  // namespace knap
