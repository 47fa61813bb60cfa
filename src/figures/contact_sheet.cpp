#include "figures/contact_sheet.hpp"

#include "figures/plot.hpp"

#include <cairo.h>

#include <algorithm>

namespace knap {
namespace {

/// Height over width of an image; 0 of one that could not be read.
double shape_of(const Image& image) {
    if (cairo_surface_status(image.get()) != CAIRO_STATUS_SUCCESS) return 0;
    return static_cast<double>(cairo_image_surface_get_height(image.get())) /
           cairo_image_surface_get_width(image.get());
}

}  // namespace

DrawnFigure draw_contact_sheet(const std::vector<Tile>& tiles, std::size_t n_columns, const std::string& title,
                               const std::filesystem::path& file, int pixels, const Legend& legend,
                               const std::string& aside) {
    constexpr double margin = 10;  // [unit]
    const double column = (page_width - margin) / static_cast<double>(n_columns), width = column - margin,
                 size = std::clamp(column / 20, 3.5, 9.);  // of captions
    const auto image_of = [](const Tile& tile) {
        return Image(cairo_image_surface_create_from_png(tile.picture.string().c_str()), cairo_surface_destroy);
    };
    double shape = 0;  // of the tallest picture
    std::vector<std::vector<std::string>> captions;
    std::size_t n_lines = 1;
    for (const Tile& tile : tiles) {
        shape = std::max(shape, shape_of(image_of(tile)));
        captions.push_back(broken_lines(tile.caption, size, 0.99 * width, false, 4));
        n_lines = std::max(n_lines, captions.back().size());
    }
    if (shape == 0) shape = 0.5;
    const std::size_t n_rows = std::max<std::size_t>(1, (tiles.size() + n_columns - 1) / n_columns);
    const double row = shape * width + (0.4 + 1.2 * static_cast<double>(n_lines)) * size + margin;

    const Title heading = fitted_title(title, aside, page_width - 2 * margin);
    const double head = heading.height() - 4, foot = legend_height(legend, page_width - 2 * margin);
    Canvas canvas(file, head + margin + static_cast<double>(n_rows) * row + foot, pixels);
    draw_title(canvas, heading, margin, page_width - margin, canvas.height() - head);
    draw_legend(canvas, legend, {margin, 0, page_width - 2 * margin, foot});
    for (std::size_t i = 0; i < tiles.size(); ++i) {
        const std::size_t row_number = i / n_columns;
        const double middle = margin + static_cast<double>(i % n_columns) * column + 0.5 * width,
                     top = canvas.height() - head - static_cast<double>(row_number) * row;
        const Image image = image_of(tiles[i]);
        if (const double own = shape_of(image); own > 0) {  // as large as fits, at the top
            const double own_width = width * std::min(1., shape / own);
            canvas.image(image, {middle - 0.5 * own_width, top - own * own_width, own_width, own * own_width});
        } else {
            canvas.text({middle, top - 0.5 * shape * width}, "no picture", {.size = size, .across = Across::centre});
        }
        double y = top - shape * width;
        for (const std::string& line : captions[i])
            canvas.text({middle, y -= 1.2 * size}, line, {.size = size, .across = Across::centre});
    }
    return canvas.finish();
}

}  // namespace knap
