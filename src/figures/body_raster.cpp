#include "figures/body_raster.hpp"

#include <cairo.h>

#include <cmath>
#include <cstdint>

namespace knap {

namespace {

constexpr int n_fine = 3;  // fine pixels per pixel, each way

/// Every pixel is the mean of its n_fine x n_fine fine ones (premultiplied ARGB).
cairo_surface_t* averaged(cairo_surface_t* fine, int width, int height) {
    cairo_surface_flush(fine);
    cairo_surface_t* coarse = cairo_image_surface_create(CAIRO_FORMAT_ARGB32, width, height);
    const unsigned char* from = cairo_image_surface_get_data(fine);
    unsigned char* to = cairo_image_surface_get_data(coarse);
    const int from_stride = cairo_image_surface_get_stride(fine), to_stride = cairo_image_surface_get_stride(coarse);
    for (int y = 0; y < height; ++y) {
        for (int i = 0; i < 4 * width; ++i) {
            const unsigned char* corner = from + n_fine * y * from_stride + 4 * n_fine * (i / 4) + i % 4;
            int total = n_fine * n_fine / 2;
            for (int k = 0; k < n_fine; ++k)
                for (int j = 0; j < n_fine; ++j) total += corner[k * from_stride + 4 * j];
            to[y * to_stride + i] = static_cast<unsigned char>(total / (n_fine * n_fine));
        }
    }
    cairo_surface_mark_dirty(coarse);
    return coarse;
}

}  // namespace

BodyRaster::BodyRaster(const Canvas& canvas, const Area& area)
    : scale_(canvas.pixels_per_unit()),
      left_(static_cast<int>(std::floor(area.left * scale_))),
      top_(static_cast<int>(std::floor((canvas.height() - area.top()) * scale_))),
      width_(static_cast<int>(std::ceil(area.right() * scale_)) - left_),
      height_(static_cast<int>(std::ceil((canvas.height() - area.bottom) * scale_)) - top_),
      page_height_(canvas.height()),
      fine_(cairo_image_surface_create(CAIRO_FORMAT_ARGB32, n_fine * width_, n_fine * height_)),
      cairo_(cairo_create(fine_)) {
    cairo_set_antialias(cairo_, CAIRO_ANTIALIAS_NONE);
    cairo_scale(cairo_, n_fine, n_fine);
    cairo_translate(cairo_, -left_, -top_);
    cairo_scale(cairo_, scale_, -scale_);
    cairo_translate(cairo_, 0, -page_height_);
}

BodyRaster::~BodyRaster() {
    cairo_destroy(cairo_);
    cairo_surface_destroy(fine_);
}

void BodyRaster::triangle(const std::array<Vec2, 3>& corners, const Colour& colour) {
    cairo_new_path(cairo_);
    for (const Vec2& x : corners) cairo_line_to(cairo_, x.x(), x.y());
    cairo_set_source_rgb(cairo_, colour.red, colour.green, colour.blue);
    cairo_fill(cairo_);
}

void BodyRaster::paint(Canvas& canvas) const {
    cairo_surface_t* image = averaged(fine_, width_, height_);
    cairo_t* cairo = canvas.cairo();
    cairo_save(cairo);
    cairo_translate(cairo, left_ / scale_, page_height_ - top_ / scale_);
    cairo_scale(cairo, 1 / scale_, -1 / scale_);
    cairo_set_source_surface(cairo, image, 0, 0);
    cairo_pattern_set_filter(cairo_get_source(cairo), CAIRO_FILTER_BEST);
    cairo_paint(cairo);
    cairo_restore(cairo);
    cairo_surface_destroy(image);
}

}  // namespace knap
