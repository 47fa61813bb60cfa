#include "figures/canvas.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/whole_file.hpp"

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <cairo.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace knap {

namespace {

// of the font, in units of its size: a capital's height and what hangs below the baseline
constexpr double cap_height = 0.73, ascent = 0.78, descent = 0.22;
constexpr double subscript_size = 0.72, subscript_drop = 0.18;

/// A piece of text of one size.
struct Run {
    std::string text;
    bool subscript;
};

/// Splits "c_{R} = 3" into "c", "R" (subscript) and " = 3".
std::vector<Run> runs(const std::string& text) {
    std::vector<Run> found;
    std::size_t at = 0;
    while (at < text.size()) {
        const std::size_t open = text.find("_{", at), close = open == std::string::npos ? open : text.find('}', open);
        if (close == std::string::npos) {
            found.push_back({text.substr(at), false});
            break;
        }
        if (open > at) found.push_back({text.substr(at, open - at), false});
        found.push_back({text.substr(open + 2, close - open - 2), true});
        at = close + 1;
    }
    return found;
}

void select_font(cairo_t* cairo, double size, bool bold) {
    cairo_select_font_face(cairo, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL, bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cairo, size);
    // the layout of a PNG and of a PDF are the same
    cairo_font_options_t* options = cairo_font_options_create();
    cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
    cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
    cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
    cairo_set_font_options(cairo, options);
    cairo_font_options_destroy(options);
}

/// Lays the runs out from the origin along +x (y down, as Cairo's text has it) and calls use(text, x, y, extents); returns the advance.
template <class Use>
double lay_out(cairo_t* cairo, const std::string& text, double size, bool bold, Use use) {
    double x = 0;
    for (const Run& run : runs(text)) {
        select_font(cairo, run.subscript ? subscript_size * size : size, bold);
        cairo_text_extents_t extents;
        cairo_text_extents(cairo, run.text.c_str(), &extents);
        use(run.text, x, run.subscript ? subscript_drop * size : 0.0, extents);
        x += extents.x_advance;
    }
    return x;
}

double shift_across(Across across, double width) {
    return across == Across::left ? 0 : across == Across::centre ? -0.5 * width : -width;
}

/// From the position down to the baseline.
double shift_along(Along along, double size) {
    switch (along) {
        case Along::middle: return 0.5 * cap_height * size;
        case Along::top: return ascent * size;
        case Along::bottom: return -descent * size;
        case Along::baseline: break;
    }
    return 0;
}

void set_colour(cairo_t* cairo, const Colour& c) { cairo_set_source_rgba(cairo, c.red, c.green, c.blue, c.alpha); }

void trace(cairo_t* cairo, const std::vector<Vec2>& points) {
    cairo_new_path(cairo);
    for (const Vec2& p : points) cairo_line_to(cairo, p.x(), p.y());
}

cairo_status_t append(void* bytes, const unsigned char* data, unsigned int n) {
    static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), n);
    return CAIRO_STATUS_SUCCESS;
}

/// A vector file goes into `bytes` as it is drawn.
cairo_surface_t* make_surface(const std::string& ending, double height, double scale, std::string& bytes) {
    if (ending == ".svg") return cairo_svg_surface_create_for_stream(append, &bytes, page_width, height);
    if (ending == ".pdf") return cairo_pdf_surface_create_for_stream(append, &bytes, page_width, height);
    return cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(std::lround(page_width * scale)),
                                      static_cast<int>(std::lround(height * scale)));
}

}  // namespace

Canvas::Canvas(std::filesystem::path file, double height, int pixels) : file_(std::move(file)), height_(height), scale_(pixels / page_width) {
    const std::string ending = file_.extension().string();
    if (ending != ".png" && ending != ".svg" && ending != ".pdf")
        throw UserError("figure-file", "`" + file_.filename().string() + "` is no file a figure can be written to", "known endings: .png, .svg, .pdf");
    surface_ = make_surface(ending, height, scale_, bytes_);
    cairo_ = cairo_create(surface_);
    if (ending == ".png") cairo_scale(cairo_, scale_, scale_);
    cairo_translate(cairo_, 0, height);
    cairo_scale(cairo_, 1, -1);
    if (ending == ".svg") cairo_svg_surface_set_document_unit(surface_, CAIRO_SVG_UNIT_PT);
    set_colour(cairo_, white);
    cairo_paint(cairo_);
    cairo_set_line_join(cairo_, CAIRO_LINE_JOIN_ROUND);
    cairo_set_line_cap(cairo_, CAIRO_LINE_CAP_ROUND);
}

Canvas::~Canvas() {
    cairo_destroy(cairo_);
    cairo_surface_destroy(surface_);
}

void Canvas::line(const std::vector<Vec2>& points, const Colour& colour, double width, const std::vector<double>& dashes) {
    trace(cairo_, points);
    set_colour(cairo_, colour);
    cairo_set_line_width(cairo_, width);
    cairo_set_line_cap(cairo_, dashes.empty() ? CAIRO_LINE_CAP_ROUND : CAIRO_LINE_CAP_BUTT);
    cairo_set_dash(cairo_, dashes.data(), static_cast<int>(dashes.size()), 0);
    cairo_stroke(cairo_);
    cairo_set_dash(cairo_, nullptr, 0, 0);
    cairo_set_line_cap(cairo_, CAIRO_LINE_CAP_ROUND);
}

void Canvas::segments(const std::vector<Vec2>& points, const Colour& colour, double width) {
    cairo_new_path(cairo_);
    for (std::size_t i = 0; i + 1 < points.size(); i += 2) {
        cairo_move_to(cairo_, points[i].x(), points[i].y());
        cairo_line_to(cairo_, points[i + 1].x(), points[i + 1].y());
    }
    set_colour(cairo_, colour);
    cairo_set_line_width(cairo_, width);
    cairo_stroke(cairo_);
}

void Canvas::fill(const std::vector<Vec2>& points, const Colour& colour) {
    trace(cairo_, points);
    cairo_close_path(cairo_);
    set_colour(cairo_, colour);
    cairo_fill(cairo_);
}

void Canvas::rectangle(const Area& a, const Colour& colour, double width) {
    cairo_new_path(cairo_);
    cairo_rectangle(cairo_, a.left, a.bottom, a.width, a.height);
    set_colour(cairo_, colour);
    cairo_set_line_width(cairo_, width);
    cairo_stroke(cairo_);
}

void Canvas::text(const Vec2& at, const std::string& text, const TextStyle& style) {
    if (text.empty()) return;
    cairo_save(cairo_);
    cairo_new_path(cairo_);
    cairo_translate(cairo_, at.x(), at.y());
    cairo_scale(cairo_, 1, -1);
    cairo_rotate(cairo_, -style.angle * std::numbers::pi / 180);
    const double x0 = shift_across(style.across, text_width(text, style.size, style.bold)), y0 = shift_along(style.along, style.size);
    set_colour(cairo_, style.colour);
    double left = 1e30, low = 1e30, right = -1e30, high = -1e30;  // of the ink, in text directions
    lay_out(cairo_, text, style.size, style.bold, [&](const std::string& run, double x, double y, const cairo_text_extents_t& extents) {
        cairo_move_to(cairo_, x0 + x, y0 + y);
        cairo_show_text(cairo_, run.c_str());
        left = std::min(left, x0 + x + extents.x_bearing);
        right = std::max(right, x0 + x + extents.x_bearing + extents.width);
        low = std::min(low, y0 + y + extents.y_bearing);
        high = std::max(high, y0 + y + extents.y_bearing + extents.height);
    });
    cairo_restore(cairo_);
    const Eigen::Rotation2Dd turn(style.angle * std::numbers::pi / 180);
    Vec2 box_low(1e30, 1e30), box_high(-1e30, -1e30);
    for (const double x : {left, right}) {
        for (const double y : {low, high}) {
            const Vec2 p = at + turn * Vec2(x, -y);
            box_low = box_low.cwiseMin(p);
            box_high = box_high.cwiseMax(p);
        }
    }
    texts_.push_back({text, {box_low.x(), box_low.y(), box_high.x() - box_low.x(), box_high.y() - box_low.y()}});
}

namespace {

/// A page of one pixel to measure texts on; metrics are not hinted, so they are those of every page.
cairo_t* measuring_page() {
    struct Page {
        cairo_surface_t* surface = cairo_image_surface_create(CAIRO_FORMAT_A8, 1, 1);
        cairo_t* cairo = cairo_create(surface);
        ~Page() {
            cairo_destroy(cairo);
            cairo_surface_destroy(surface);
        }
    };
    thread_local const Page page;
    return page.cairo;
}

/// Ends of the characters that can be needed to fill `width`, which in UTF-8 go on with bytes 10xxxxxx. A text may have millions: no more are looked at than
/// would fit if they were a twentieth of their height wide.
std::vector<std::size_t> character_ends(const std::string& text, double size, double width) {
    const auto most = static_cast<std::size_t>(std::max(20 * width / size, 1.));
    std::vector<std::size_t> ends{0};
    for (std::size_t at = 1; at <= text.size() && ends.size() <= most; ++at)
        if (at == text.size() || !continues_character(text[at])) ends.push_back(at);
    return ends;
}

/// The end of the last of them up to which text and `after` fit.
std::size_t last_fitting(const std::vector<std::size_t>& ends, const std::string& text, const std::string& after, double size, double width, bool bold) {
    const auto beyond = std::partition_point(ends.begin() + 1, ends.end(), [&](std::size_t end) { return text_width(text.substr(0, end) + after, size, bold) <= width; });
    return *(beyond - 1);
}

}  // namespace

double text_width(const std::string& text, double size, bool bold) {
    return lay_out(measuring_page(), text, size, bold, [](const std::string&, double, double, const cairo_text_extents_t&) {});
}

std::size_t fitting_bytes(const std::string& text, double size, double width, bool bold) {
    return last_fitting(character_ends(text, size, width), text, "", size, width, bold);
}

std::string fitted_text(const std::string& text, double size, double width, bool bold) {
    const std::vector<std::size_t> ends = character_ends(text, size, width);
    if (ends.back() == text.size() && text_width(text, size, bold) <= width) return text;
    return text.substr(0, last_fitting(ends, text, "…", size, width, bold)) + "…";
}

void Canvas::finish() {
    cairo_show_page(cairo_);
    cairo_status_t status = cairo_status(cairo_);
    if (status == CAIRO_STATUS_SUCCESS && file_.extension() == ".png") status = cairo_surface_write_to_png_stream(surface_, append, &bytes_);
    cairo_surface_finish(surface_);
    if (status == CAIRO_STATUS_SUCCESS) status = cairo_surface_status(surface_);
    if (status != CAIRO_STATUS_SUCCESS) throw OutputError("cannot write " + file_.string() + ": " + cairo_status_to_string(status));
    write_whole_file(file_, bytes_);
}

}  // namespace knap
