#pragma once
// A page with a body on it, at one moment.
#include "figures/body_raster.hpp"
#include "figures/body_view.hpp"
#include "figures/chart.hpp"
#include "figures/legend.hpp"

#include <cairo.h>

namespace knap {

inline constexpr Colour outline_colour{0.35, 0.35, 0.35};
inline constexpr double outline_width = 0.5;  // [unit]

class BodyPage {
public:
    BodyPage(const FigureOptions& options, const Frame& frame, const Box& seen, const std::string& title, Legend legend, const std::filesystem::path& file);

    Canvas& canvas() { return canvas_; }

    template <class ColourOf>
    void fill_triangles(ColourOf colour) {
        BodyRaster raster(canvas_, view_.plot());
        for (Index t = 0; t < frame_.n_triangles(); ++t) raster.triangle({corner(3 * t), corner(3 * t + 1), corner(3 * t + 2)}, colour(t));
        raster.paint(canvas_);
    }

    /// Both faces of each interface; they are one line as long as it is closed.
    void draw_interfaces(const std::vector<Index>& interfaces, const Colour& colour, double width);
    /// Those among them whose faces are seen apart get outlines like the border of the body.
    void draw_open_faces(const std::vector<Index>& interfaces);
    /// Of obstacles; half planes reach to the end of what is seen.
    void fill_obstacles();
    /// The edges that only one triangle has.
    void draw_outline();

    /// Lines of the body stay inside the plot.
    template <class Draw>
    void inside_plot(Draw draw) {
        const Area& p = view_.plot();
        cairo_save(canvas_.cairo());
        cairo_new_path(canvas_.cairo());
        cairo_rectangle(canvas_.cairo(), p.left, p.bottom, p.width, p.height);
        cairo_clip(canvas_.cairo());
        draw();
        cairo_restore(canvas_.cairo());
    }

    /// With axes, title and legend.
    DrawnFigure finished();

private:
    Vec2 corner(Index c) const { return view_.on_page(deformed(frame_, c, options_.deform)); }
    std::vector<Vec2> obstacle(Index o) const;

    const FigureOptions& options_;
    const Frame& frame_;
    std::filesystem::path file_;
    Legend legend_;
    BodyView view_;
    Canvas canvas_;
};

}  // namespace knap
