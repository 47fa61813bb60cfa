#include "figures/cairo_device.hpp"

#include "figures/marker.hpp"

#include <vtkBrush.h>
#include <vtkMatrix3x3.h>
#include <vtkObjectFactory.h>
#include <vtkPen.h>
#include <vtkRect.h>
#include <vtkStdString.h>
#include <vtkTextProperty.h>
#include <vtkUnicodeString.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace knap {

vtkStandardNewMacro(CairoDevice);

namespace {

/// The colour of a call, or else that of the pen or brush (`own`, RGBA).
void set_colour(cairo_t* cairo, const unsigned char* colour, int n_components, const unsigned char* own) {
    const unsigned char* c = colour ? colour : own;
    const double alpha = !colour || n_components > 3 ? c[3] / 255.0 : 1.0;
    cairo_set_source_rgba(cairo, c[0] / 255.0, c[1] / 255.0, c[2] / 255.0, alpha);
}

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

cairo_matrix_t as_cairo(vtkMatrix3x3* m) {
    cairo_matrix_t out;
    cairo_matrix_init(&out, m->GetElement(0, 0), m->GetElement(1, 0), m->GetElement(0, 1), m->GetElement(1, 1), m->GetElement(0, 2),
                      m->GetElement(1, 2));
    return out;
}

}  // namespace

CairoDevice::CairoDevice() { cairo_matrix_init_identity(&matrix_); }

void CairoDevice::draw_on(Canvas& canvas) {
    canvas_ = &canvas;
    Geometry[0] = static_cast<int>(page_width);
    Geometry[1] = static_cast<int>(std::lround(canvas.height()));
    ViewportSize.Set(Geometry[0], Geometry[1]);
    ViewportRect.Set(0, 0, Geometry[0], Geometry[1]);
}

// The path is transformed, the line is not: its width stays the same in both directions whatever the axes' scales.
Vec2 CairoDevice::on_page(const float* point) const {
    double x = point[0], y = point[1];
    cairo_matrix_transform_point(&matrix_, &x, &y);
    return {x, y};
}

void CairoDevice::trace(const float* points, int n) const {
    cairo_new_path(canvas_->cairo());
    for (int i = 0; i < n; ++i) {
        const Vec2 p = on_page(points + 2 * i);
        cairo_line_to(canvas_->cairo(), p.x(), p.y());
    }
}

void CairoDevice::stroke(const unsigned char* colors, int n_components) {
    cairo_t* cairo = canvas_->cairo();
    if (Pen->GetLineType() == vtkPen::NO_PEN || Pen->GetOpacity() == 0) {
        cairo_new_path(cairo);
        return;
    }
    const double width = Pen->GetWidth();
    const std::vector<double> pattern = line_pattern(Pen->GetLineType() - vtkPen::SOLID_LINE, width);
    set_colour(cairo, colors, n_components, Pen->GetColorObject().GetData());
    cairo_set_line_width(cairo, width);
    cairo_set_line_cap(cairo, CAIRO_LINE_CAP_BUTT);
    cairo_set_dash(cairo, pattern.data(), static_cast<int>(pattern.size()), 0);
    cairo_stroke(cairo);
    cairo_set_dash(cairo, nullptr, 0, 0);
}

void CairoDevice::fill(const unsigned char* colors, int n_components) {
    set_colour(canvas_->cairo(), colors, n_components, Brush->GetColorObject().GetData());
    cairo_fill(canvas_->cairo());
}

void CairoDevice::DrawPoly(float* points, int n, unsigned char* colors, int nc_comps) {
    trace(points, n);
    stroke(colors, nc_comps);
}

void CairoDevice::DrawLines(float* points, int n, unsigned char* colors, int nc_comps) {
    for (int i = 0; i + 1 < n; i += 2) {
        trace(points + 2 * i, 2);
        stroke(colors ? colors + i * nc_comps : nullptr, nc_comps);
    }
}

void CairoDevice::DrawPoints(float* points, int n, unsigned char* colors, int nc_comps) {
    cairo_t* cairo = canvas_->cairo();
    for (int i = 0; i < n; ++i) {
        const Vec2 p = on_page(points + 2 * i);
        cairo_new_path(cairo);
        cairo_arc(cairo, p.x(), p.y(), 0.5 * Pen->GetWidth(), 0, 2 * std::numbers::pi);
        set_colour(cairo, colors ? colors + i * nc_comps : nullptr, nc_comps, Pen->GetColorObject().GetData());
        cairo_fill(cairo);
    }
}

void CairoDevice::DrawPointSprites(vtkImageData*, float* points, int n, unsigned char* colors, int nc_comps) {
    DrawPoints(points, n, colors, nc_comps);
}

void CairoDevice::DrawMarkers(int, bool, float* points, int n, unsigned char* colors, int nc_comps) { DrawPoints(points, n, colors, nc_comps); }

void CairoDevice::DrawQuad(float* points, int n) { DrawColoredPolygon(points, n, nullptr, 0); }

void CairoDevice::DrawQuadStrip(float* points, int n) {
    for (int i = 0; i + 3 < n; i += 2) {
        float* p = points + 2 * i;
        float quad[] = {p[0], p[1], p[2], p[3], p[6], p[7], p[4], p[5]};
        DrawQuad(quad, 4);
    }
}

void CairoDevice::DrawColoredPolygon(float* points, int n, unsigned char* colors, int nc_comps) {
    trace(points, n);
    cairo_close_path(canvas_->cairo());
    fill(colors, nc_comps);
}

void CairoDevice::DrawEllipseWedge(float x, float y, float outer_x, float outer_y, float inner_x, float inner_y, float start, float stop) {
    cairo_t* cairo = canvas_->cairo();
    const float centre[] = {x, y};
    const Vec2 c = on_page(centre);
    const auto arc = [&](double radius_x, double radius_y, bool back) {
        cairo_save(cairo);
        cairo_translate(cairo, c.x(), c.y());
        cairo_scale(cairo, std::max(radius_x, 1e-6), std::max(radius_y, 1e-6));
        if (back) cairo_arc_negative(cairo, 0, 0, 1, radians(stop), radians(start));
        else cairo_arc(cairo, 0, 0, 1, radians(start), radians(stop));
        cairo_restore(cairo);
    };
    cairo_new_path(cairo);
    arc(outer_x, outer_y, false);
    if (inner_x > 0 && inner_y > 0) arc(inner_x, inner_y, true);
    cairo_close_path(cairo);
    fill(nullptr, 0);
}

void CairoDevice::DrawEllipticArc(float x, float y, float radius_x, float radius_y, float start, float stop) {
    constexpr int n = 60;
    std::vector<float> points;
    for (int i = 0; i <= n; ++i) {
        const double angle = radians(start + (stop - start) * i / n);
        points.push_back(x + radius_x * static_cast<float>(std::cos(angle)));
        points.push_back(y + radius_y * static_cast<float>(std::sin(angle)));
    }
    DrawPoly(points.data(), n + 1, nullptr, 0);
}

TextStyle CairoDevice::text_style() const {
    double rgb[3];
    TextProp->GetColor(rgb);
    TextStyle style;
    style.size = TextProp->GetFontSize();
    style.colour = {rgb[0], rgb[1], rgb[2], TextProp->GetOpacity()};
    style.angle = TextProp->GetOrientation();
    style.bold = TextProp->GetBold() != 0;
    const int across = TextProp->GetJustification(), along = TextProp->GetVerticalJustification();
    style.across = across == VTK_TEXT_LEFT ? Across::left : across == VTK_TEXT_RIGHT ? Across::right : Across::centre;
    style.along = along == VTK_TEXT_BOTTOM ? Along::bottom : along == VTK_TEXT_TOP ? Along::top : Along::middle;
    return style;
}

void CairoDevice::DrawString(float* point, const vtkStdString& string) { canvas_->text(on_page(point), string, text_style()); }
void CairoDevice::DrawMathTextString(float* point, const vtkStdString& string) { DrawString(point, string); }

// The text's width and one line's height; swapped for upright text, which VTK's header does not say and its axes count on.
void CairoDevice::ComputeStringBounds(const vtkStdString& string, float bounds[4]) {
    const TextStyle style = text_style();
    bounds[0] = bounds[1] = 0;
    bounds[2] = static_cast<float>(knap::text_width(string, style.size, style.bold));
    bounds[3] = string.empty() ? 0 : static_cast<float>(style.size);
    if (std::abs(std::remainder(style.angle, 180)) > 45) std::swap(bounds[2], bounds[3]);
}

void CairoDevice::ComputeJustifiedStringBounds(const char* string, float bounds[4]) {
    ComputeStringBounds(vtkStdString(string), bounds);
    const TextStyle style = text_style();
    if (style.across != Across::left) bounds[0] = -bounds[2] * (style.across == Across::centre ? 0.5f : 1.0f);
    if (style.along != Along::bottom) bounds[1] = -bounds[3] * (style.along == Along::middle ? 0.5f : 1.0f);
}

void CairoDevice::DrawString(float* point, const vtkUnicodeString& string) { DrawString(point, vtkStdString(string.utf8_str())); }
void CairoDevice::ComputeStringBounds(const vtkUnicodeString& string, float bounds[4]) {
    ComputeStringBounds(vtkStdString(string.utf8_str()), bounds);
}

void CairoDevice::DrawImage(float*, float, vtkImageData*) {}
void CairoDevice::DrawImage(const vtkRectf&, vtkImageData*) {}
void CairoDevice::SetTexture(vtkImageData*, int) {}
void CairoDevice::SetColor4(unsigned char*) {}
void CairoDevice::SetPointSize(float) {}
void CairoDevice::SetLineWidth(float) {}
void CairoDevice::SetLineType(int) {}

void CairoDevice::SetMatrix(vtkMatrix3x3* matrix) { matrix_ = as_cairo(matrix); }

void CairoDevice::GetMatrix(vtkMatrix3x3* matrix) {
    const double rows[] = {matrix_.xx, matrix_.xy, matrix_.x0, matrix_.yx, matrix_.yy, matrix_.y0, 0, 0, 1};
    matrix->DeepCopy(rows);
}

void CairoDevice::MultiplyMatrix(vtkMatrix3x3* matrix) {
    const cairo_matrix_t first = as_cairo(matrix), then = matrix_;
    cairo_matrix_multiply(&matrix_, &first, &then);
}

void CairoDevice::PushMatrix() { stack_.push_back(matrix_); }

void CairoDevice::PopMatrix() {
    matrix_ = stack_.back();
    stack_.pop_back();
}

void CairoDevice::SetClipping(int* area) {
    clip_area_ = {double(area[0]), double(area[1]), double(area[2]), double(area[3])};
    clip();
}

void CairoDevice::EnableClipping(bool enable) {
    clips_ = enable;
    clip();
}

void CairoDevice::clip() {
    cairo_t* cairo = canvas_->cairo();
    cairo_reset_clip(cairo);
    if (!clips_) return;
    // half a line more, so that a curve along the border keeps its width
    cairo_new_path(cairo);
    cairo_rectangle(cairo, clip_area_.left - 1, clip_area_.bottom - 1, clip_area_.width + 2, clip_area_.height + 2);
    cairo_clip(cairo);
}

}  // namespace knap
