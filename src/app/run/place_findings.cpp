// Probes, regions and boxes that lie outside the body.
#include "app/run/model_findings.hpp"

#include "app/run/run.hpp"
#include "mesh/polygon.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace knap {
namespace {

/// Round a mesh.
struct Extent {
    Vec2 low = Vec2::Constant(std::numeric_limits<double>::infinity()), high = -low;

    bool meets(const Vec2& a, const Vec2& b) const { return (a.array() <= high.array()).all() && (b.array() >= low.array()).all(); }
    std::string text() const { return "from " + place_text(low) + " to " + place_text(high); }
};

Extent extent_of(const Mesh& mesh) {
    Extent extent;
    for (const Vec2& x : mesh.vertices) extent.low = extent.low.cwiseMin(x), extent.high = extent.high.cwiseMax(x);
    return extent;
}

bool in_triangle(const Mesh& mesh, Index t, const Vec2& x) {
    for (Index k = 0; k < 3; ++k) {
        const Vec2 a = mesh.corner(t, k), b = mesh.corner(t, (k + 1) % 3);
        if (cross(b - a, x - a) < -1e-9 * (b - a).squaredNorm()) return false;
    }
    return true;
}

bool in_mesh(const Mesh& mesh, const Vec2& x) {
    for (Index t = 0; t < mesh.n_triangles(); ++t)
        if (in_triangle(mesh, t, x)) return true;
    return false;
}

/// The border of the body nearest to a place.
struct Nearest {
    double distance = std::numeric_limits<double>::infinity(), edge = 0;  // [m]
};

Nearest nearest_border(const Mesh& mesh, const Vec2& x) {
    Nearest nearest;
    for (const BoundaryEdge& edge : mesh.boundary_edges) {
        const Vec2 a = mesh.corner(edge.triangle, edge.side), b = mesh.corner(edge.triangle, (edge.side + 1) % 3);
        const double distance = distance_to_segment(a, b, x);
        if (distance < nearest.distance) nearest = {distance, (b - a).norm()};
    }
    return nearest;
}

void check_probes(const ReadResult& read, const Mesh& mesh, std::vector<Diagnostic>& found) {
    for (std::size_t i = 0; i < read.scenario.probes.size(); ++i) {
        const ProbeOptions& probe = read.scenario.probes[i];
        if (in_mesh(mesh, probe.at)) continue;
        const Nearest border = nearest_border(mesh, probe.at);
        if (border.distance <= 0.1 * border.edge) continue;  // on a curve that the mesh follows by straight edges
        found.push_back(warning_at(read, item("probe", i) + ".at", "outside",
                                   "probe `" + probe.name + "` at " + place_text(probe.at) + " lies outside the body, " + with_unit(border.distance, "m") +
                                       " from its border: the nearest " + (probe.interface ? "interface" : "vertex") + " is watched",
                                   "the body reaches " + extent_of(mesh).text()));
    }
}

void check_regions(const ReadResult& read, const Mesh& mesh, std::vector<Diagnostic>& found) {
    const std::size_t n = std::min(read.values.count("domain.region"), read.scenario.shape.regions.size());
    for (std::size_t i = 0; i < n; ++i) {
        const std::vector<Vec2>& points = read.scenario.shape.regions[i].points;
        Vec2 low = points.front(), high = low;
        for (const Vec2& x : points) low = low.cwiseMin(x), high = high.cwiseMax(x);
        const Box box{low, high};
        bool covers = false;
        for (Index t = 0; t < mesh.n_triangles() && !covers; ++t) {
            const Vec2 middle = mesh.centroid(t);
            covers = box.contains(middle) && contains(points, middle);
        }
        const std::string path = item("domain.region", i);
        if (!covers)
            found.push_back(warning_at(read, path, "outside", "`" + path + "` covers no triangle of the body: it lies from " + place_text(box.low) + " to " + place_text(box.high),
                                       "the body reaches " + extent_of(mesh).text() + "; a region is at least as large as a triangle"));
    }
}

void check_box(const ReadResult& read, const Mesh& mesh, const std::string& key, std::vector<Diagnostic>& found) {
    const auto box = read.values.get<Box>(key);
    if (!box) return;
    const Extent extent = extent_of(mesh);
    const auto inside = [&](const Vec2& x) { return box->contains(x); };
    if (extent.meets(box->low, box->high) &&
        (std::any_of(mesh.vertices.begin(), mesh.vertices.end(), inside) || in_mesh(mesh, 0.5 * (box->low + box->high)) || in_mesh(mesh, box->low) || in_mesh(mesh, box->high)))
        return;
    found.push_back(warning_at(read, key, "outside", "`" + key + "` lies outside the body: from " + place_text(box->low) + " to " + place_text(box->high),
                               "the body reaches " + extent.text() + "; coordinates without a unit are metres"));
}

}  // namespace

std::vector<Diagnostic> findings_of_places(const ReadResult& read, const Model& model) {
    std::vector<Diagnostic> found;
    const Mesh& mesh = model.mesh;
    check_probes(read, mesh, found);
    check_regions(read, mesh, found);
    for (std::size_t i = 0; i < read.values.count("mesh.refine"); ++i) check_box(read, mesh, item("mesh.refine", i) + ".inside", found);
    for (std::size_t i = 0; i < read.values.count("map"); ++i) check_box(read, mesh, item("map", i) + ".box", found);
    for (std::size_t i = 0; i < read.values.count("figure"); ++i) check_box(read, mesh, item("figure", i) + ".box", found);
    return found;
}

Diagnostic warning_at(const ReadResult& read, const std::string& key, const std::string& code, const std::string& message, const std::string& note) {
    Diagnostic d = read.at(key, {});
    d.severity = Diagnostic::Severity::warning;
    d.code = code;
    d.message = message;
    d.note = note;
    return d;
}

std::string with_unit(double value, const char* unit) {
    char text[48];
    std::snprintf(text, sizeof text, "%.6g %s", value, unit);
    return text;
}

std::string place_text(const Vec2& x) {
    char text[64];
    std::snprintf(text, sizeof text, "(%.6g, %.6g) m", x.x(), x.y());
    return text;
}

}  // namespace knap
