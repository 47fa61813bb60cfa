#pragma once
// Pictures that tests draw, and what is on them.
#include "figures/canvas.hpp"
#include "figures/figures.hpp"

#include <cairo.h>
#include <doctest/doctest.h>

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>

namespace knap::tests {

/// A directory of its own for a group of tests.
inline std::filesystem::path picture_directory(const std::string& name) {
    const std::filesystem::path directory = std::filesystem::path(KNAP_BINARY_DIR) / name;
    std::filesystem::create_directories(directory);
    return directory;
}

/// A figure as `file`.
inline DrawnFigure draw(FigureOptions options, const Frame& frame, const FigureContext& context,
                        const std::filesystem::path& file, const FigureScale* common = nullptr) {
    options.file = file.filename().string();
    return draw_figure(options, frame, {}, context, file.parent_path(), common);
}

class Pixels {
public:
    explicit Pixels(const std::filesystem::path& file)
        : image_(cairo_image_surface_create_from_png(file.string().c_str())) {
        REQUIRE(cairo_surface_status(image_) == CAIRO_STATUS_SUCCESS);
    }
    ~Pixels() { cairo_surface_destroy(image_); }
    Pixels(const Pixels&) = delete;
    Pixels& operator=(const Pixels&) = delete;

    int width() const { return cairo_image_surface_get_width(image_); }
    int height() const { return cairo_image_surface_get_height(image_); }
    /// 0xRRGGBB; rows go down.
    std::uint32_t at(int x, int y) const {
        return reinterpret_cast<const std::uint32_t*>(cairo_image_surface_get_data(image_) +
                                                      y * cairo_image_surface_get_stride(image_))[x] &
               0xFFFFFF;
    }
    /// At a place of the page [unit], from below.
    std::uint32_t on_page(double x, double y) const {
        const double scale = width() / page_width;
        return at(static_cast<int>(scale * x), height() - 1 - static_cast<int>(scale * y));
    }
    std::set<std::uint32_t> colours() const {
        std::set<std::uint32_t> found;
        for (int y = 0; y < height(); ++y)
            for (int x = 0; x < width(); ++x) found.insert(at(x, y));
        return found;
    }
    /// Part of the pixels that are not white.
    double inked() const {
        double n = 0;
        for (int y = 0; y < height(); ++y)
            for (int x = 0; x < width(); ++x) n += at(x, y) != 0xFFFFFF;
        return n / (static_cast<double>(width()) * height());
    }

private:
    cairo_surface_t* image_;
};

}  // namespace knap::tests
