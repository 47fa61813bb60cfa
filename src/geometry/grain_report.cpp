#include "geometry/grain_report.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace knap {
namespace {

/// Grains whose triangles all have neighbours within the region of the grains.
std::vector<char> whole_grains(const Mesh& mesh, Index n_grains) {
    std::vector<char> whole(n_grains, 1);
    for (const BoundaryEdge& edge : mesh.boundary_edges)
        if (mesh.grain[edge.triangle] >= 0) whole[mesh.grain[edge.triangle]] = 0;
    for (const InteriorEdge& edge : mesh.interior_edges) {
        const Index a = mesh.grain[edge.triangle[0]], b = mesh.grain[edge.triangle[1]];
        if (a < 0 && b >= 0) whole[b] = 0;
        if (b < 0 && a >= 0) whole[a] = 0;
    }
    return whole;
}

/// Area, first and second moments of area.
struct Moments {
    double area = 0;
    Vec2 first = Vec2::Zero();
    Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
    Index n_triangles = 0;
};

std::vector<Moments> moments_of_grains(const Mesh& mesh) {
    std::vector<Moments> moments;
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        const Index g = mesh.grain[t];
        if (g < 0) continue;
        if (g >= static_cast<Index>(moments.size())) moments.resize(g + 1);
        const double area = mesh.area(t);
        const Vec2 a = mesh.corner(t, 0), b = mesh.corner(t, 1), c = mesh.corner(t, 2), sum = a + b + c;
        moments[g].area += area;
        moments[g].first += area / 3 * sum;
        moments[g].second += area / 12 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose());
        ++moments[g].n_triangles;
    }
    return moments;
}

}  // namespace

std::vector<double> grain_areas(const Mesh& mesh) {
    std::vector<double> areas;
    for (const Moments& m : moments_of_grains(mesh)) areas.push_back(m.area);
    return areas;
}

GrainReport judge_grains(const Mesh& mesh) {
    GrainReport report;
    const std::vector<Moments> moments = moments_of_grains(mesh);
    report.n_grains = static_cast<Index>(moments.size());
    const std::vector<char> whole = whole_grains(mesh, report.n_grains);
    double sum = 0, squares = 0;
    Eigen::Matrix2d shape = Eigen::Matrix2d::Zero();
    for (Index g = 0; g < report.n_grains; ++g) {
        const Moments& m = moments[g];
        if (!whole[g] || m.n_triangles == 0) continue;
        const double diameter = std::sqrt(4 * m.area / std::numbers::pi);
        sum += diameter;
        squares += diameter * diameter;
        const Vec2 centroid = m.first / m.area;
        shape += (m.second - m.area * centroid * centroid.transpose()) / (m.area * m.area);
        report.least_triangles = report.n_whole == 0 ? m.n_triangles : std::min(report.least_triangles, m.n_triangles);
        ++report.n_whole;
    }
    if (report.n_whole > 0) {
        report.mean_diameter = sum / report.n_whole;
        report.spread = std::sqrt(std::max(0.0, squares / report.n_whole - report.mean_diameter * report.mean_diameter)) / report.mean_diameter;
        const double mean = 0.5 * shape.trace(), half = 0.5 * (shape(0, 0) - shape(1, 1)), radius = std::hypot(half, shape(0, 1));
        report.elongation = std::sqrt((mean + radius) / (mean - radius));
        report.direction = 0.5 * std::atan2(shape(0, 1), half);
    }
    for (const InteriorEdge& edge : mesh.interior_edges)
        if (mesh.grain[edge.triangle[0]] != mesh.grain[edge.triangle[1]])
            report.border_length += (mesh.corner(edge.triangle[0], edge.side[0]) - mesh.corner(edge.triangle[0], (edge.side[0] + 1) % 3)).norm();
    return report;
}

}  // namespace knap
