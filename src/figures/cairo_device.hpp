#pragma once
// VTK's two-dimensional drawing device on a Canvas. VTK's own devices need OpenGL and a display; this one needs neither.
// VTK draws in pixels from the lower left, which here are the canvas's units, so fonts and lines scale with the resolution.
#include "figures/canvas.hpp"

#include <cairo.h>
#include <vtkContextDevice2D.h>

#include <vector>

namespace knap {

class CairoDevice : public vtkContextDevice2D {
public:
    vtkTypeMacro(CairoDevice, vtkContextDevice2D);
    static CairoDevice* New();
    /// Before anything is drawn.
    void draw_on(Canvas& canvas);

    void DrawPoly(float* points, int n, unsigned char* colors, int nc_comps) override;
    void DrawLines(float* points, int n, unsigned char* colors, int nc_comps) override;
    void DrawPoints(float* points, int n, unsigned char* colors, int nc_comps) override;
    void DrawPointSprites(vtkImageData* sprite, float* points, int n, unsigned char* colors, int nc_comps) override;
    void DrawMarkers(int shape, bool highlight, float* points, int n, unsigned char* colors, int nc_comps) override;
    void DrawQuad(float* points, int n) override;
    void DrawQuadStrip(float* points, int n) override;
    void DrawColoredPolygon(float* points, int n, unsigned char* colors, int nc_comps) override;
    void DrawEllipseWedge(float x, float y, float outer_x, float outer_y, float inner_x, float inner_y, float start, float stop) override;
    void DrawEllipticArc(float x, float y, float radius_x, float radius_y, float start, float stop) override;

    void DrawString(float* point, const vtkStdString& string) override;
    void DrawString(float* point, const vtkUnicodeString& string) override;
    void ComputeStringBounds(const vtkStdString& string, float bounds[4]) override;
    void ComputeStringBounds(const vtkUnicodeString& string, float bounds[4]) override;
    void ComputeJustifiedStringBounds(const char* string, float bounds[4]) override;
    void DrawMathTextString(float* point, const vtkStdString& string) override;

    // images and textures do not occur in charts
    void DrawImage(float p[2], float scale, vtkImageData* image) override;
    void DrawImage(const vtkRectf& area, vtkImageData* image) override;
    void SetTexture(vtkImageData* image, int properties) override;

    // VTK sets these through ApplyPen, which keeps the pen
    void SetColor4(unsigned char color[4]) override;
    void SetPointSize(float size) override;
    void SetLineWidth(float width) override;
    void SetLineType(int type) override;

    void SetMatrix(vtkMatrix3x3* matrix) override;
    void GetMatrix(vtkMatrix3x3* matrix) override;
    void MultiplyMatrix(vtkMatrix3x3* matrix) override;
    void PushMatrix() override;
    void PopMatrix() override;
    void SetClipping(int* area) override;
    void EnableClipping(bool enable) override;

protected:
    CairoDevice();

private:
    Vec2 on_page(const float* point) const;
    void trace(const float* points, int n) const;
    void stroke(const unsigned char* colors, int n_components);
    void fill(const unsigned char* colors, int n_components);
    TextStyle text_style() const;
    void clip();

    Canvas* canvas_ = nullptr;
    cairo_matrix_t matrix_;
    std::vector<cairo_matrix_t> stack_;
    Area clip_area_;
    bool clips_ = false;
};

}  // namespace knap
