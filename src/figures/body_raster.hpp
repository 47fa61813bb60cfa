#pragma once
// Many small triangles as one image without seams: filled without antialiasing at three times the resolution, then averaged.
// In vector files the triangles are an image too (37 000 of them as paths make a file that no viewer likes); lines and type stay vectors.
#include "figures/canvas.hpp"

#include <array>

namespace knap {

class BodyRaster {
public:
    /// `area` of the page.
    BodyRaster(const Canvas& canvas, const Area& area);
    ~BodyRaster();
    BodyRaster(const BodyRaster&) = delete;
    BodyRaster& operator=(const BodyRaster&) = delete;

    void triangle(const std::array<Vec2, 3>& on_page, const Colour& colour);
    void paint(Canvas& canvas) const;

private:
    double scale_;           // [pixel/unit] of the image on the page
    int left_, top_;         // [pixel] from the upper left of the page
    int width_, height_;     // [pixel] of the image on the page
    double page_height_;     // [unit]
    cairo_surface_t* fine_;
    cairo_t* cairo_;
};

}  // namespace knap
