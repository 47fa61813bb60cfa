#include "figures/canvas.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/whole_file.hpp"
#include "figures/write_png.hpp"

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <cairo.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace knap {
namespace {

// of the font, relative to its size: height of a capital, above and below the baseline
constexpr double cap_height = 0.73, ascent = 0.78, descent = 0.22;
constexpr double subscript_size = 0.72, subscript_drop = 0.18;

/// Part of a text of one size, and where it starts [unit] from the text's position (y downwards, as in Cairo).
struct TextPart {
    std::string text;
    double x, y, size;
    cairo_text_extents_t extents;
};

void select_font(cairo_t* cairo, double size, bool bold) {
    cairo_select_font_face(cairo, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                           bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cairo, size);
    // without hinting PNG and PDF have the same layout
    cairo_font_options_t* options = cairo_font_options_create();
    cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
    cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
    cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
    cairo_set_font_options(cairo, options);
    cairo_font_options_destroy(options);
}

/// Splits "c_{R} = 3" into "c", "R" (subscript) and " = 3"; `width`: of all.
std::vector<TextPart> parts_of(cairo_t* cairo, const std::string& text, const TextStyle& style, double& width) {
    std::vector<TextPart> parts;
    width = 0;
    const auto add = [&](std::size_t from, std::size_t to, bool subscript) {
        if (from == to) return;
        TextPart part{.text = text.substr(from, to - from),
                      .x = width,
                      .y = subscript ? subscript_drop * style.size : 0,
                      .size = subscript ? subscript_size * style.size : style.size};
        select_font(cairo, part.size, style.bold);
        cairo_text_extents(cairo, part.text.c_str(), &part.extents);
        width += part.extents.x_advance;
        parts.push_back(std::move(part));
    };
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t open = text.find("_{", at), close = open == text.npos ? open : text.find('}', open);
        add(at, close == text.npos ? text.size() : open, false);
        if (close == text.npos) break;
        add(open + 2, close, true);
        at = close + 1;
    }
    return parts;
}

/// A page of one pixel on which texts are measured; unhinted, so they are as wide on every page.
cairo_t* measuring_page() {
    thread_local const Image surface(cairo_image_surface_create(CAIRO_FORMAT_A8, 1, 1), cairo_surface_destroy);
    thread_local const std::unique_ptr<cairo_t, void (*)(cairo_t*)> page(cairo_create(surface.get()), cairo_destroy);
    return page.get();
}

/// The number of bytes of the first characters that fit into `width` together with `after`, and whether that is all.
/// Texts may be long: only as many characters are measured as fit if each is a twentieth of its height wide.
std::size_t fitting_bytes(const std::string& text, const std::string& after, double size, double width, bool bold) {
    const auto max_ends = static_cast<std::size_t>(std::max(20 * width / size, 1.));
    std::vector<std::size_t> ends{0};
    for (std::size_t at = 1; at <= text.size() && ends.size() <= max_ends; ++at)
        if (at == text.size() || !continues_character(text[at])) ends.push_back(at);
    if (ends.back() == text.size() && text_width(text, size, bold) <= width) return text.size();
    return *(std::partition_point(
                 ends.begin() + 1, ends.end(),
                 [&](std::size_t end) { return text_width(text.substr(0, end) + after, size, bold) <= width; }) -
             1);
}

void set_colour(cairo_t* cairo, const Colour& c) { cairo_set_source_rgba(cairo, c.red, c.green, c.blue, c.alpha); }

void trace(cairo_t* cairo, const std::vector<Vec2>& points) {
    cairo_new_path(cairo);
    for (const Vec2& p : points) cairo_line_to(cairo, p.x(), p.y());
}

constexpr int n_fine = 3;  // fine pixels per pixel, in each direction

std::uint32_t pixel_of(const Colour& colour) {
    const auto byte = [](double part) { return static_cast<std::uint32_t>(std::lround(255 * part)); };
    return 255u << 24 | byte(colour.red) << 16 | byte(colour.green) << 8 | byte(colour.blue);
}

/// Some rows of the fine pixels of an area, transparent (0) until they are filled.
class Pixels {
public:
    explicit Pixels(int width) : width_(width) {}

    /// `n_rows` rows from `first` on.
    void begin(int first, int n_rows) {
        first_ = first, end_ = first + n_rows;
        pixels_.assign(static_cast<std::size_t>(width_) * n_rows, 0);
    }

    /// Fills the pixels whose middles lie inside: of two triangles with a common edge one has each pixel along it.
    void fill(std::array<Vec2, 3> corners, std::uint32_t colour) {
        std::ranges::sort(corners, {}, [](const Vec2& x) { return x.y(); });
        const Vec2 &a = corners[0], &b = corners[1], &c = corners[2];
        const auto from_to = [](double x, int least, int most) {
            return static_cast<int>(std::clamp(x + 0.5, static_cast<double>(least), static_cast<double>(most)));
        };
        const auto slope = [](const Vec2& from, const Vec2& to) { return (to.x() - from.x()) / (to.y() - from.y()); };
        const double long_slope = slope(a, c);
        const auto fill_rows = [&](const Vec2& from, const Vec2& to) {  // between this side and the long one
            const double side_slope = slope(from, to);
            for (int row = from_to(from.y(), first_, end_), end = from_to(to.y(), first_, end_); row < end; ++row) {
                const double y = row + 0.5, x = a.x() + (y - a.y()) * long_slope,
                             z = from.x() + (y - from.y()) * side_slope;
                std::uint32_t* const pixels = pixels_.data() + static_cast<std::size_t>(row - first_) * width_;
                std::fill(pixels + from_to(std::min(x, z), 0, width_), pixels + from_to(std::max(x, z), 0, width_),
                          colour);
            }
        };
        fill_rows(a, b), fill_rows(b, c);
    }

    /// Gives the rows of an image the mean colours of squares of n_fine pixels.
    void average(const Image& image) const {
        unsigned char* const bytes = cairo_image_surface_get_data(image.get());
        for (int y = first_ / n_fine; y < end_ / n_fine; ++y) {
            auto* const row = reinterpret_cast<std::uint32_t*>(bytes + static_cast<std::ptrdiff_t>(y) *
                                                                           cairo_image_surface_get_stride(image.get()));
            const std::uint32_t* const fine = pixels_.data() + static_cast<std::size_t>(n_fine * y - first_) * width_;
            for (int x = 0; x < width_ / n_fine; ++x)
                row[x] = are_same(fine + n_fine * x) ? fine[n_fine * x] : mean(n_fine * x, n_fine * y - first_);
        }
    }

private:
    /// Of the square of fine pixels that starts here.
    bool are_same(const std::uint32_t* fine) const {
        static_assert(n_fine == 3);
        const std::uint32_t first = *fine, *const second = fine + width_, *const third = second + width_;
        return ((fine[1] ^ first) | (fine[2] ^ first) | (second[0] ^ first) | (second[1] ^ first) |
                (second[2] ^ first) | (third[0] ^ first) | (third[1] ^ first) | (third[2] ^ first)) == 0;
    }
    std::uint32_t mean(int x, int y) const {
        constexpr std::uint32_t n = n_fine * n_fine, every_second = 0xff00ff;  // bytes, summed two at a time
        std::uint32_t even = 0, odd = 0;
        for (int i = 0; i < n_fine; ++i) {
            const std::uint32_t* const pixels = pixels_.data() + static_cast<std::size_t>(y + i) * width_ + x;
            for (int k = 0; k < n_fine; ++k) even += pixels[k] & every_second, odd += pixels[k] >> 8 & every_second;
        }
        const auto part = [](std::uint32_t sums, int shift) { return ((sums >> shift & 0xffff) + n / 2) / n << shift; };
        return part(even, 0) | part(even, 16) | (part(odd, 0) | part(odd, 16)) << 8;
    }
    int width_, first_ = 0, end_ = 0;
    std::vector<std::uint32_t> pixels_;
};

cairo_status_t append(void* bytes, const unsigned char* data, unsigned int n) {
    static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), n);
    return CAIRO_STATUS_SUCCESS;
}

/// A picture that Cairo has made. Throws OutputError where it has not: more than 32767 pixels in a row, or no memory.
Image made(cairo_surface_t* surface, int width, int height) {
    Image image(surface, cairo_surface_destroy);
    if (const cairo_status_t status = cairo_surface_status(surface); status != CAIRO_STATUS_SUCCESS)
        throw OutputError("cannot make a picture of " + std::to_string(width) + " x " + std::to_string(height) +
                          " pixels: " + cairo_status_to_string(status) + "; a smaller width needs less");
    return image;
}

/// A vector file is written to `bytes` while it is drawn.
cairo_surface_t* make_surface(const std::filesystem::path& file, double height, int pixels, const Page& page,
                              std::string& bytes) {
    const double width_pt = page.width * page.points, height_pt = height * page.points;
    if (file.extension() == ".svg") return cairo_svg_surface_create_for_stream(append, &bytes, width_pt, height_pt);
    if (file.extension() == ".pdf") return cairo_pdf_surface_create_for_stream(append, &bytes, width_pt, height_pt);
    if (!file.empty() && file.extension() != ".png")
        throw UserError("figure-file", "figures cannot be written as `" + file.filename().string() + "`",
                        "known endings, in small letters: .png, .svg, .pdf, of an animation .webp, .gif, .mp4");
    const int rows = static_cast<int>(std::lround(height * (pixels / page.width)));
    return cairo_surface_reference(
        made(cairo_image_surface_create(CAIRO_FORMAT_RGB24, pixels, rows), pixels, rows).get());
}

/// A text of an SVG file, which Cairo would draw as outlines; `at` [unit] from the upper left of the page, before it is
/// turned.
std::string svg_text(const Vec2& at, const std::vector<TextPart>& parts, double y, const TextStyle& style,
                     const Page& page) {
    static constexpr const char* anchors[] = {"start", "middle", "end"};
    const auto number = [](double value) { return decimal(value, std::chars_format::general, 6); };
    std::string text =
        "<text transform=\"translate(" + number(page.points * at.x()) + " " + number(page.points * at.y()) +
        ") rotate(" + number(-style.angle) + ") scale(" + number(page.points) + ")\" y=\"" + number(y) +
        "\" text-anchor=\"" + anchors[static_cast<int>(style.across)] +
        "\" font-family=\"DejaVu Sans, Verdana, sans-serif\" font-weight=\"" + (style.bold ? "bold" : "normal") +
        "\" font-size=\"" + number(style.size) + "\" fill=\"#262626\" xml:space=\"preserve\">";
    double drop = 0;
    for (const TextPart& part : parts) {
        text += "<tspan dy=\"" + number(part.y - drop) + "\" font-size=\"" + number(part.size) + "\">";
        text += xml_text(part.text) + "</tspan>", drop = part.y;
    }
    return text + "</text>\n";
}

}  // namespace

double text_width(const std::string& text, double size, bool bold) {
    double width;
    parts_of(measuring_page(), text, {.size = size, .bold = bold}, width);
    return width;
}

std::string fitted_text(const std::string& text, double size, double width, bool bold) {
    const std::size_t n = fitting_bytes(text, "…", size, width, bold);
    return n == text.size() ? text : text.substr(0, n) + "…";
}

std::vector<std::string> broken_lines(const std::string& text, double size, double width, bool bold,
                                      std::size_t max_lines) {
    std::vector<std::string> lines;
    for (std::size_t from = 0; from < text.size() && lines.size() < max_lines;) {
        const std::string rest = text.substr(from);
        std::size_t n = std::max<std::size_t>(fitting_bytes(rest, "", size, width, bold), 1);
        if (n < rest.size() && lines.size() + 1 == max_lines) {
            lines.push_back(fitted_text(rest, size, width, bold));
            break;
        }
        if (const std::size_t blank = rest.rfind(' ', n); n < rest.size() && blank != rest.npos && blank > 0) n = blank;
        lines.push_back(rest.substr(0, n));
        for (from += n; from < text.size() && text[from] == ' ';) ++from;
    }
    return lines;
}

Marker marker(std::size_t i) { return static_cast<Marker>(1 + i % static_cast<std::size_t>(Marker::cross)); }

std::vector<double> line_pattern(int kind, double width) {
    const double dash = 4 * width, gap = 1.8 * width, dot = 1.2 * width;
    switch (kind % n_line_patterns) {
        case 1: return {dash, 2.5 * width};
        case 2: return {dot, gap};
        case 3: return {dash, gap, dot, gap};
        case 4: return {dash, gap, dot, gap, dot, gap};
        default: return {};
    }
}

Canvas::Canvas(std::filesystem::path file, double height, int pixels, const Page& page)
    : file_(std::move(file)),
      page_(page),
      height_(height),
      pixels_per_unit_(std::max(pixels / page.width, has_pixels() ? 0 : page.points * 300 / 72)),  // at least 300 dpi
      surface_(make_surface(file_, height, pixels, page, bytes_)),
      cairo_(cairo_create(surface_)) {
    const double scale = has_pixels() ? pixels_per_unit_ : page.points;
    cairo_scale(cairo_, scale, scale);
    cairo_translate(cairo_, 0, height);
    cairo_scale(cairo_, 1, -1);
    if (file_.extension() == ".svg") cairo_svg_surface_set_document_unit(surface_, CAIRO_SVG_UNIT_PT);
    set_colour(cairo_, white);
    cairo_paint(cairo_);
    cairo_set_line_join(cairo_, CAIRO_LINE_JOIN_ROUND);
}

Canvas::~Canvas() {
    cairo_destroy(cairo_);
    cairo_surface_destroy(surface_);
}

void Canvas::clip(const Area& a) {
    cairo_new_path(cairo_);
    cairo_rectangle(cairo_, a.left, a.bottom, a.width, a.height);
    cairo_clip(cairo_);
}

void Canvas::unclip() { cairo_reset_clip(cairo_); }

void Canvas::line(const std::vector<Vec2>& points, const Colour& colour, double width,
                  const std::vector<double>& dashes) {
    if (width <= 0) return;
    trace(cairo_, points);
    set_colour(cairo_, colour);
    cairo_set_line_width(cairo_, width);
    cairo_set_line_cap(cairo_, dashes.empty() ? CAIRO_LINE_CAP_ROUND : CAIRO_LINE_CAP_BUTT);
    cairo_set_dash(cairo_, dashes.data(), static_cast<int>(dashes.size()), 0);
    cairo_stroke(cairo_);
}

void Canvas::segments(const std::vector<Vec2>& points, const Colour& colour, double width) {
    cairo_new_path(cairo_);
    for (std::size_t i = 0; i + 1 < points.size(); i += 2) {
        cairo_move_to(cairo_, points[i].x(), points[i].y());
        cairo_line_to(cairo_, points[i + 1].x(), points[i + 1].y());
    }
    set_colour(cairo_, colour);
    cairo_set_line_width(cairo_, width);
    cairo_set_line_cap(cairo_, CAIRO_LINE_CAP_ROUND);
    cairo_set_dash(cairo_, nullptr, 0, 0);
    cairo_stroke(cairo_);
}

void Canvas::fill(const std::vector<Vec2>& outline, const Colour& colour) {
    trace(cairo_, outline);
    set_colour(cairo_, colour);
    cairo_fill(cairo_);
}

void Canvas::marker(Marker marker, const Vec2& at, const Colour& colour) {
    constexpr double radius = 3.2;  // [unit] of the circle; the others have about its area
    if (marker == Marker::none) return;
    if (marker == Marker::cross) {
        const Vec2 a(radius, radius), b(radius, -radius);
        return segments({at - a, at + a, at - b, at + b}, colour, 1.4);
    }
    struct Polygon {
        int n;
        double radius, first_angle;
    };
    static constexpr std::array<Polygon, 4> polygons{{{32, radius, 0},
                                                      {4, 1.25 * radius, 45 * degree},
                                                      {3, 1.4 * radius, 90 * degree},
                                                      {4, 1.4 * radius, 90 * degree}}};
    const Polygon& shape = polygons[static_cast<std::size_t>(marker) - 1];
    std::vector<Vec2> outline;
    for (int i = 0; i < shape.n; ++i) {
        const double angle = shape.first_angle + 2 * std::numbers::pi * i / shape.n;
        outline.push_back(at + shape.radius * Vec2(std::cos(angle), std::sin(angle)));
    }
    fill(outline, colour);
}

void Canvas::triangles(const std::vector<Vec2>& corners, const std::vector<Colour>& colours, const Area& area) {
    const double scale = pixels_per_unit_;
    // [pixel] from the upper left of the page
    const int left = static_cast<int>(std::floor(area.left * scale)),
              top = static_cast<int>(std::floor((height_ - area.top()) * scale)),
              width = static_cast<int>(std::ceil(area.right() * scale)) - left,
              height = static_cast<int>(std::ceil((height_ - area.bottom) * scale)) - top;
    const auto in_pixels = [&](const Vec2& x) {
        return Vec2(n_fine * (x.x() * scale - left), n_fine * ((height_ - x.y()) * scale - top));
    };
    const Image drawn = made(cairo_image_surface_create(CAIRO_FORMAT_ARGB32, width, height), width, height);
    constexpr int max_fine = 1 << 18;  // at once: 1 MB, which the cache holds
    const int n_rows = std::max(1, max_fine / (n_fine * n_fine * width));
    const auto strip_of = [&](double y) {  // the strip of rows that has this height
        return static_cast<std::size_t>(std::clamp(y, 0., n_fine * height - 1.)) / (n_fine * n_rows);
    };
    std::vector<std::vector<std::size_t>> in_strip(strip_of(INFINITY) + 1);  // triangles
    std::vector<std::array<Vec2, 3>> places(colours.size());
    for (std::size_t t = 0; t < colours.size(); ++t) {
        for (std::size_t k = 0; k < 3; ++k) places[t][k] = in_pixels(corners[3 * t + k]);
        const auto& [a, b, c] = places[t];
        if (!(a + b + c).allFinite()) continue;
        for (std::size_t s = strip_of(std::min({a.y(), b.y(), c.y()})),
                         last = strip_of(std::max({a.y(), b.y(), c.y()}));
             s <= last; ++s)
            in_strip[s].push_back(t);
    }
    Pixels fine(n_fine * width);
    for (std::size_t s = 0; s < in_strip.size(); ++s) {
        const int row = static_cast<int>(s) * n_rows;
        fine.begin(n_fine * row, n_fine * std::min(n_rows, height - row));
        for (const std::size_t t : in_strip[s]) fine.fill(places[t], pixel_of(colours[t]));
        fine.average(drawn);
    }
    cairo_surface_mark_dirty(drawn.get());
    image(drawn, {left / scale, height_ - (top + height) / scale, width / scale, height / scale});
}

void Canvas::image(const Image& image, const Area& area) {
    cairo_save(cairo_);
    cairo_translate(cairo_, area.left, area.top());
    cairo_scale(cairo_, area.width / cairo_image_surface_get_width(image.get()),
                -area.height / cairo_image_surface_get_height(image.get()));  // the rows of an image run downwards
    cairo_set_source_surface(cairo_, image.get(), 0, 0);
    cairo_pattern_set_filter(cairo_get_source(cairo_), CAIRO_FILTER_GOOD);
    cairo_paint(cairo_);
    cairo_restore(cairo_);
}

void Canvas::text(const Vec2& at, const std::string& text, const TextStyle& style) {
    if (text.empty()) return;
    cairo_save(cairo_);
    cairo_new_path(cairo_);
    cairo_translate(cairo_, at.x(), at.y());
    cairo_scale(cairo_, 1, -1);
    cairo_rotate(cairo_, -style.angle * degree);
    double width;
    const std::vector<TextPart> parts = parts_of(cairo_, text, style, width);
    const double x0 = style.across == Across::left ? 0 : style.across == Across::centre ? -0.5 * width : -width;
    const double to_baseline = style.along == Along::middle   ? 0.5 * cap_height
                               : style.along == Along::top    ? ascent
                               : style.along == Along::bottom ? -descent
                                                              : 0;
    set_colour(cairo_, ink);
    Eigen::AlignedBox2d box;  // of the ink on the page
    for (const TextPart& part : parts) {
        const double x = x0 + part.x, y = to_baseline * style.size + part.y;
        select_font(cairo_, part.size, style.bold);
        cairo_move_to(cairo_, x, y);
        if (file_.extension() != ".svg") cairo_show_text(cairo_, part.text.c_str());
        const Vec2 corner(x + part.extents.x_bearing, -y - part.extents.y_bearing);
        for (const double dx : {0., part.extents.width})
            for (const double dy : {0., part.extents.height})
                box.extend(at + Eigen::Rotation2Dd(style.angle * degree) * Vec2(corner + Vec2(dx, -dy)));
    }
    cairo_restore(cairo_);
    if (file_.extension() == ".svg")
        svg_texts_ += svg_text({at.x(), height_ - at.y()}, parts, to_baseline * style.size, style, page_);
    texts_.push_back({text, {box.min().x(), box.min().y(), box.sizes().x(), box.sizes().y()}});
}

DrawnFigure Canvas::finish() {
    cairo_show_page(cairo_);
    cairo_status_t status = cairo_status(cairo_);
    if (status == CAIRO_STATUS_SUCCESS && !file_.empty() && has_pixels())
        if (bytes_ = png_of(surface_); bytes_.empty()) status = CAIRO_STATUS_NO_MEMORY;
    if (!file_.empty()) cairo_surface_finish(surface_);
    if (status == CAIRO_STATUS_SUCCESS) status = cairo_surface_status(surface_);
    if (status != CAIRO_STATUS_SUCCESS)
        throw OutputError("cannot write " + file_.string() + ": " + cairo_status_to_string(status));
    if (!svg_texts_.empty()) bytes_.insert(bytes_.rfind("</svg>"), svg_texts_);
    if (file_.empty())
        return {"", height_, std::move(texts_), Image(cairo_surface_reference(surface_), cairo_surface_destroy)};
    write_whole_file(file_, bytes_);
    return {file_, height_, std::move(texts_)};
}

}  // namespace knap
