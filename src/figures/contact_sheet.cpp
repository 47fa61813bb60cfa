#include "figures/contact_sheet.hpp"

#include "figures/key.hpp"

#include <cairo.h>

#include <algorithm>
#include <memory>

namespace knap {
namespace {

using Image = std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)>;

Image image_of(const Tile& tile) { return {cairo_image_surface_create_from_png(tile.picture.string().c_str()), &cairo_surface_destroy}; }

bool is_there(const Image& image) { return cairo_surface_status(image.get()) == CAIRO_STATUS_SUCCESS; }

/// Height over width.
double shape_of(const Image& image) { return static_cast<double>(cairo_image_surface_get_height(image.get())) / cairo_image_surface_get_width(image.get()); }

/// As large as fits into `area`, at its top.
void draw_image(Canvas& canvas, const Image& image, const Area& area) {
    const double width = cairo_image_surface_get_width(image.get()), height = cairo_image_surface_get_height(image.get());
    const double scale = std::min(area.width / width, area.height / height);
    cairo_t* cairo = canvas.cairo();
    cairo_save(cairo);
    cairo_translate(cairo, area.left + 0.5 * (area.width - scale * width), area.top());
    cairo_scale(cairo, scale, -scale);  // the rows of an image go down
    cairo_set_source_surface(cairo, image.get(), 0, 0);
    cairo_pattern_set_filter(cairo_get_source(cairo), CAIRO_FILTER_GOOD);
    cairo_paint(cairo);
    cairo_restore(cairo);
}

}  // namespace

DrawnFigure draw_contact_sheet(const std::vector<Tile>& tiles, std::size_t n_columns, const std::string& title, const std::filesystem::path& file, int pixels,
                               const Legend& legend, const std::string& aside) {
    constexpr double margin = 10;  // [unit]
    const Title heading = fitted_title(title, aside, page_width - 2 * margin);
    const double head = heading.height() - 4, foot = legend_height(legend, page_width - 2 * margin);
    const std::size_t n_rows = std::max<std::size_t>(1, (tiles.size() + n_columns - 1) / n_columns);
    const double column = (page_width - margin) / static_cast<double>(n_columns), type = std::clamp(column / 20, 3.5, 9.), width = column - margin;
    double shape = 0;  // of the tallest picture
    for (const Tile& tile : tiles)
        if (const Image image = image_of(tile); is_there(image)) shape = std::max(shape, shape_of(image));
    if (shape == 0) shape = 0.5;
    std::vector<std::vector<std::string>> captions;
    std::size_t n_lines = 1;
    for (const Tile& tile : tiles) {
        captions.push_back(broken_lines(tile.caption, type, 0.99 * width, false, 4));
        n_lines = std::max(n_lines, captions.back().size());
    }
    const double row = shape * width + (0.4 + 1.2 * static_cast<double>(n_lines)) * type + margin;
    Canvas canvas(file, head + margin + static_cast<double>(n_rows) * row + foot, pixels);
    draw_title(canvas, heading, margin, page_width - margin, canvas.height() - head);
    draw_legend(canvas, legend, {margin, 0, page_width - 2 * margin, foot});
    for (std::size_t i = 0; i < tiles.size(); ++i) {
        const double left = margin + static_cast<double>(i % n_columns) * column, top = canvas.height() - head - static_cast<double>(i / n_columns) * row;
        const Area area{left, top - shape * width, width, shape * width};
        if (const Image image = image_of(tiles[i]); is_there(image)) draw_image(canvas, image, area);
        else canvas.text({left + 0.5 * width, top - 0.5 * shape * width}, "no picture", {.size = type, .across = Across::centre});
        double y = area.bottom;
        for (const std::string& line : captions[i]) canvas.text({left + 0.5 * width, y -= 1.2 * type}, line, {.size = type, .across = Across::centre});
    }
    canvas.finish();
    return {file, canvas.height(), canvas.texts()};
}

}  // namespace knap
